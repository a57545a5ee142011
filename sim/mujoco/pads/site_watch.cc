#include "sim/mujoco/pads/site_watch.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

constexpr double inside_by = 1e-5;  // m

std::string named(ModelView model, int type, const char* noun, int id) {
  const char* name = model.name_of(type, id);
  return name != nullptr && *name != '\0' ? fmt::format("{} {}", noun, quote(name))
                                          : fmt::format("{} {} (without a name)", noun, id);
}

bool excluded(ModelView model, int a, int b) {
  for (int e = 0; e < static_cast<int>(model.nexclude()); ++e) {
    const int signature = model.exclude_signature()[e];
    if (signature == (a << 16) + b || signature == (b << 16) + a) return true;
  }
  return false;
}

bool paired(ModelView model, int a, int b) {
  for (int p = 0; p < static_cast<int>(model.npair()); ++p) {
    if (std::minmax(model.pair_geom1()[p], model.pair_geom2()[p]) == std::minmax(a, b)) return true;
  }
  return false;
}

// True if MuJoCo treats the two as parent and child, which do not collide.
bool related(ModelView model, int body_a, int body_b) {
  if ((model.opt_disableflags() & mj::disable_filterparent) != 0) return false;
  const int a = model.body_weldid()[body_a], b = model.body_weldid()[body_b];
  if (a == 0 || b == 0) return false;
  return a == model.body_weldid()[model.body_parentid()[b]] || b == model.body_weldid()[model.body_parentid()[a]];
}

bool may_collide(ModelView model, int a, int b) {
  if (paired(model, a, b)) return true;
  const int body_a = model.geom_bodyid()[a], body_b = model.geom_bodyid()[b];
  if (model.body_weldid()[body_a] == model.body_weldid()[body_b]) return false;
  const bool matching = (model.geom_contype()[a] & model.geom_conaffinity()[b]) != 0 ||
                        (model.geom_contype()[b] & model.geom_conaffinity()[a]) != 0;
  return matching && !excluded(model, body_a, body_b) && !related(model, body_a, body_b);
}

double gap_of(const Surface& surface, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) {
  return std::visit([&](const auto& shape) { return shape.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()).gap; },
                    surface);
}

}  // namespace

std::string possible_contact(ModelView model, const PadConfig& config) {
  constexpr int none = mj::disable_contact | mj::disable_constraint;
  if ((model.opt_disableflags() & none) != 0) return {};
  const int pad_body = model.site_bodyid()[config.site];
  if (pad_body == 0) return {};  // otherwise all fixed geoms would be the pad's
  const bool fixed = model.body_weldid()[pad_body] == 0;
  std::string first;
  std::set<std::pair<int, int>> bodies;
  for (int a = 0; a < static_cast<int>(model.ngeom()); ++a) {
    const int body = model.geom_bodyid()[a];
    if (fixed ? body != pad_body : model.body_weldid()[body] != model.body_weldid()[pad_body]) continue;
    for (const int b : config.geoms) {
      if (!may_collide(model, a, b)) continue;
      if (first.empty()) {
        first = fmt::format("{}, which moves with the pad, and the touched {}", named(model, mj::geom, "geom", a),
                            named(model, mj::geom, "geom", b));
      }
      bodies.insert({body, model.geom_bodyid()[b]});
    }
  }
  if (bodies.empty()) return {};
  constexpr std::size_t most_shown = 3;
  std::string excludes;
  std::size_t shown = 0;
  for (const auto& [a, b] : bodies) {
    const auto name = [&](int body) {
      const char* text = model.name_of(mj::body, body);
      return text != nullptr && *text != '\0' ? std::string(text) : fmt::format("(number {}, give it a name)", body);
    };
    // Without the world's contacts a body falls through the floor.
    if (a == 0 || b == 0) continue;
    if (++shown > most_shown) break;
    excludes += fmt::format("<exclude body1=\"{}\" body2=\"{}\"/>", name(a), name(b));
  }
  if (shown > most_shown) excludes += fmt::format(" and {} more", bodies.size() - most_shown);
  if (!excludes.empty()) excludes += " in <contact>, or ";
  return fmt::format(
      "MuJoCo's own contact between {} would take the pad's load or count it twice; disable it by {}contype and conaffinity that do not match",
      first, excludes);
}

SiteWatch::SiteWatch(const PadLayout& layout) {
  constexpr std::size_t most = 16;
  const Element* farthest = &layout.elements.front();
  for (const Element& element : layout.elements) {
    if (element.tip.squaredNorm() > farthest->tip.squaredNorm()) farthest = &element;
  }
  radius_ = farthest->tip.norm();
  const std::size_t stride = layout.elements.size() / most + 1;
  for (std::size_t i = 0; i < layout.elements.size(); i += stride) tips_.push_back(layout.elements[i]);
  tips_.push_back(*farthest);
  deepest_start_ = std::min(layout.unit_height, radius_ > 0.0 ? radius_ : std::numeric_limits<double>::infinity());
}

// A gap is valid only for an element that points at the surface; inside, one of the two directions
// does. A grid's gap may be rounded at either end.
double SiteWatch::clearance(const Surface& shape, const Pose& pad) const {
  const auto* const grid = std::get_if<DistanceGrid>(&shape);
  const double rounded_by = grid != nullptr ? grid->cell() : 0.0;
  const Eigen::Vector3d ahead = -pad.rotation.col(2), back = pad.rotation.col(2);
  return std::min(gap_of(shape, pad.position, ahead), gap_of(shape, pad.position, back)) - radius_ - inside_by - rounded_by;
}

bool SiteWatch::points_outwards(const Surface& shape, const Pose& pad, std::size_t touching) {
  sure_ = sure_ || touching > 0;
  if (sure_ || (pad.position - clear_at_).norm() < clear_) return false;
  const double clear = clearance(shape, pad);
  if (clear > 0.0) {
    clear_at_ = pad.position;
    clear_ = clear;
    return false;
  }
  clear_ = -1.0;
  return std::ranges::any_of(tips_, [&](const Element& element) {
    const Eigen::Vector3d tip = pad * element.tip, axis = pad.rotation * element.axis;
    return gap_of(shape, tip, axis) >= 0.0 && gap_of(shape, tip, -axis) < -inside_by;
  });
}

}  // namespace slipbench
