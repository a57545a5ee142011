#include "sim/field/several_surfaces.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace slipbench {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

// Faces that differ by less lie in one place [m]: the rounding of coordinates.
constexpr double same_place = 1e-9;

// Of `count` surfaces the one whose face an element passed first, behind its tip by way(k) [m]; none where may_meet(k) holds for no k.
template <class MayMeet, class Way>
std::size_t first_surface(std::size_t count, const MayMeet& may_meet, const Way& way) {
  std::size_t first = none;
  for (std::size_t k = 0; k < count; ++k) {
    if (may_meet(k) && (first == none || way(k) > way(first))) first = k;
  }
  return first;
}

// The surface that element i touches by state(field), or none.
template <class State>
std::size_t holder_of(std::span<const Field> fields, const State& state) {
  const auto touched = std::ranges::find_if(fields, [&](const Field& field) { return state(field) != ElementState::detached; });
  return touched == fields.end() ? none : static_cast<std::size_t>(touched - fields.begin());
}

// After approach() of all fields.
void share_elements(std::span<Field> fields, std::span<const Pose> pads) {
  std::vector<std::vector<std::uint32_t>> excluded(fields.size());
  for (std::size_t i = 0; i < fields.front().size(); ++i) {
    const auto is_inside = [&](std::size_t k) { return fields[k].is_inside(i); };
    const std::size_t holder = holder_of(fields, [i](const Field& field) { return field.state_before(i); });
    const auto way = [&](std::size_t k) { return fields[k].way_inside(i); };
    // An element that touches goes on to a face that has just come to lie before its own.
    const bool held = holder != none && is_inside(holder);
    const double own = held ? way(holder) : 0.0, ahead = held ? fields[holder].travel(i) + same_place : 0.0;
    const auto may_meet = [&](std::size_t k) {
      return is_inside(k) && (!held || k == holder || (way(k) > own + same_place && way(k) <= own + same_place + ahead));
    };
    std::size_t owner = first_surface(fields.size(), may_meet, way);
    if (owner == none) owner = holder;  // which may touch a bump of its surface (SurfaceEffect)
    if (owner == none && fields.front().has_bumps()) {
      owner = first_surface(
          fields.size(), [&](std::size_t k) { return fields[k].looks_in(i); }, way);
    }
    if (owner == none) continue;
    if (holder != none && holder != owner) fields[holder].hand_over(i, fields[owner], pads[owner] * pads[holder].inverse());
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (k != owner) excluded[k].push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].exclude(excluded[k]);
}

// A load that counts twice would be a wrong result without a word.
void refuse_two_contacts(std::span<const Field> fields) {
  if (fields.front().has_skin()) return;  // which may bulge against a second surface
  for (std::size_t i = 0; i < fields.front().size(); ++i) {
    const auto touches = [i](const Field& field) { return field.state(i) != ElementState::detached; };
    if (std::ranges::count_if(fields, touches) > 1) {
      throw std::logic_error("field: element " + std::to_string(i) + " touches two surfaces");
    }
  }
}

}  // namespace

void step_on_surfaces(std::span<Field> fields, std::span<const Pose> pads, double dt, std::span<const Twist> motions) {
  const auto motion_on = [&](std::size_t k) { return motions.empty() ? nullptr : &motions[k]; };
  if (fields.size() == 1) return fields.front().step(pads.front(), dt, motion_on(0));
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].approach(pads[k], dt);
  const bool shared = std::ranges::count_if(fields, &Field::is_near) > 1;
  if (shared) {
    share_elements(fields, pads);
  } else {
    for (Field& field : fields) field.exclude({});
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].finish(motion_on(k));
  if (shared) refuse_two_contacts(fields);
}

void exclude_all_but_first(std::span<Field> fields, std::span<const Pose> pads) {
  std::vector<std::vector<std::uint32_t>> excluded(fields.size());
  std::vector<SurfacePoint> met(fields.size());
  std::vector<double> along(fields.size());
  for (std::size_t i = 0; fields.size() > 1 && i < fields.front().size(); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      met[k] = fields[k].meet(i, pads[k]);
      along[k] = Eigen::Vector3d(met[k].nx, met[k].ny, met[k].nz).dot(pads[k].rotation * fields[k].layout().elements[i].axis);
    }
    const std::size_t holder = holder_of(fields, [i](const Field& field) { return field.state(i); });
    const bool held = holder != none && met[holder].gap < 0.0;
    const std::size_t owner = held ? holder
                                   : first_surface(
                                         fields.size(), [&](std::size_t k) { return along[k] < 0.0; },
                                         [&](std::size_t k) { return met[k].gap / along[k]; });
    for (std::size_t k = 0; owner != none && k < fields.size(); ++k) {
      if (k != owner) excluded[k].push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].exclude(excluded[k]);
}

}  // namespace slipbench
