#include "sim/field/field.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "sim/core/error.h"
#include "sim/field/dashpot.h"
#include "sim/field/kernel.h"
#include "sim/field/lean.h"

namespace slipbench {
namespace {

constexpr std::size_t alignment = 64;

// From so many elements on a field looks for those that take part.
constexpr std::size_t least_sparse = 64;

// The columns that outlive a step. What a step calls "before" is filled from them.
constexpr std::array kept{kernel::contact_x, kernel::contact_y, kernel::contact_z, kernel::gap,      kernel::press,
                          kernel::limit,     kernel::mode,      kernel::anchor_x,  kernel::anchor_y, kernel::anchor_z,
                          kernel::force_x,   kernel::force_y,   kernel::force_z,   kernel::path};
constexpr std::array kept_of_faces{kernel::faces, kernel::spent};  // and these, unless all meet the one face of a plane

void check(const PadLayout& layout, const Friction& friction, const FieldEffects& effects) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("field: " + what); };
  if (layout.elements.empty()) refuse("a pad needs at least one element");
  if (layout.elements.size() > Field::max_elements) {
    refuse("a pad of " + std::to_string(layout.elements.size()) + " elements; allowed are up to " +
           std::to_string(Field::max_elements));
  }
  for (std::size_t i = 0; i < layout.elements.size(); ++i) {
    const Element& element = layout.elements[i];
    const std::string name = "element " + std::to_string(i) + ": ";
    const auto positive = [](double k) { return k > 0.0 && std::isfinite(k); };
    const auto not_negative = [](double c) { return c >= 0.0 && std::isfinite(c); };
    if (!positive(element.k_normal) || !positive(element.k_tangential)) refuse(name + "stiffness must be positive and finite");
    if (!not_negative(element.c_normal) || !not_negative(element.c_tangential)) refuse(name + "a dashpot must not be negative");
    if (!(std::abs(element.axis.norm() - 1.0) < 1e-9)) refuse(name + "the axis must be a unit vector");
    if (!element.tip.allFinite()) refuse(name + "the tip must be finite");
  }
  std::size_t next = 0;
  for (const UnitRange& unit : layout.units) {
    if (unit.first != next || unit.count == 0) refuse("units must tile the elements in order");
    next += unit.count;
  }
  if (next != layout.elements.size()) refuse("units must tile the elements in order");
  if (effects.cone && effects.lean) refuse("columns do not lean on an effect's cone");
  if (!(friction.mu_kinetic >= 0.0) || !(friction.mu_static >= friction.mu_kinetic) || std::isinf(friction.mu_static)) {
    refuse("friction must satisfy 0 <= mu_kinetic <= mu_static");
  }
}

// Where inside a step a quantity that changes linearly from `before` to `now` passes through zero.
double zero_crossing(double before, double now) {
  const double fraction = before / (before - now);
  return fraction >= 0.0 && fraction <= 1.0 ? fraction : 0.0;
}

}  // namespace

void Field::Free::operator()(double* block) const { std::free(block); }

// Calls visit(memory) for every effect that has one.
template <class Visit>
void Field::for_each_memory(Visit&& visit) {
  const auto visit_all = [&](auto& effects) {
    for (const auto& effect : effects) {
      if (const std::span<double> memory = effect->memory(); !memory.empty()) visit(memory);
    }
  };
  visit_all(effects_.surface);
  visit_all(effects_.friction);
  visit_all(effects_.rheology);
  const auto visit_one = [&](const auto& effect) {
    if (!effect) return;
    if (const std::span<double> memory = effect->memory(); !memory.empty()) visit(memory);
  };
  visit_one(effects_.rate);
  visit_one(effects_.cone);
  visit_one(effects_.tip);
  visit_all(effects_.ringing);
}

Field::Field(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects effects)
    : layout_(layout),
      surface_(surface),
      friction_(friction),
      effects_(std::move(effects)),
      count_(layout.elements.size()),
      padded_((count_ + kernel::lanes - 1) / kernel::lanes * kernel::lanes) {
  check(layout, friction, effects_);
  if (auto dashpots = make_dashpots(layout_)) effects_.rheology.push_back(std::move(dashpots));
  if (effects_.tip && (!on_plane() || effects_.cone || effects_.rate || effects_.lean || has_memory())) {
    throw std::invalid_argument(
        "field: tips with mass need a plane and stand alone: no other cone, rate law, lean, rheology or dashpot");
  }
  extended_ =
      !effects_.surface.empty() || !effects_.friction.empty() || effects_.rate || effects_.lean || has_memory() || effects_.tip;
  const std::size_t columns = extended_ ? all_columns : plain_columns;
  // A stride of whole pages would put the same row of all columns into one set of the L1 cache.
  const std::size_t stride = padded_ + (padded_ % 512 == 0 ? kernel::lanes : 0);
  const std::size_t bytes = columns * stride * sizeof(double);
  block_.reset(static_cast<double*>(std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)));
  if (!block_) throw std::bad_alloc();
  std::memset(block_.get(), 0, bytes);
  for (std::size_t c = 0; c < columns; ++c) columns_[c] = block_.get() + c * stride;

  for (std::size_t i = 0; i < count_; ++i) {
    const Element& element = layout_.elements[i];
    for (int k = 0; k < 3; ++k) {
      columns_[tip_x + static_cast<std::size_t>(k)][i] = element.tip[k];
      columns_[axis_x + static_cast<std::size_t>(k)][i] = element.axis[k];
    }
    columns_[k_normal][i] = element.k_normal;
    columns_[k_tangential][i] = element.k_tangential;
    columns_[compliance][i] = 1.0 / element.k_tangential;
    columns_[mu_static][i] = friction.mu_static;
    columns_[mu_kinetic][i] = friction.mu_kinetic;
  }
  if (extended_) {
    std::copy_n(columns_[k_normal], count_, columns_[k_normal_spring]);
    std::copy_n(columns_[k_tangential], count_, columns_[k_tangential_spring]);
    std::copy_n(columns_[mu_static], count_, columns_[mu_static_surface]);
    std::copy_n(columns_[mu_kinetic], count_, columns_[mu_kinetic_surface]);
  }
  if (effects_.tip) felt_ = felt_x;
  std::fill(columns_[normal_z], columns_[normal_z] + padded_, 1.0);
  flat_pad_ = std::all_of(layout_.elements.begin(), layout_.elements.end(),
                          [&](const Element& e) { return e.axis == layout_.elements.front().axis; });
  state_size_ = 1 + (kept.size() + (on_plane() ? 0 : kept_of_faces.size())) * count_;
  for_each_memory([this](std::span<double> memory) { state_size_ += memory.size(); });
  plain_ = on_plane() && flat_pad_ && !extended_ && !effects_.cone;
  sparse_ = count_ >= least_sparse && !on_plane() && !extended_ && !effects_.cone;
  if (sparse_) begin_sparsely();
}

void Field::save_state(std::span<double> state) {
  if (sparse_) look_at_sleeping();
  state[0] = placed_ ? 1.0 : 0.0;
  auto out = state.begin() + 1;
  const auto save = [&](Column column) { out = std::copy_n(columns_[column], count_, out); };
  std::for_each(kept.begin(), kept.end(), save);
  if (!on_plane()) std::for_each(kept_of_faces.begin(), kept_of_faces.end(), save);
  for_each_memory([&](std::span<double> memory) { out = std::copy(memory.begin(), memory.end(), out); });
}

void Field::load_state(std::span<const double> state) {
  placed_ = state[0] != 0.0;
  auto in = state.begin() + 1;
  const auto load = [&](Column column) {
    std::copy_n(in, count_, columns_[column]);
    in += static_cast<std::ptrdiff_t>(count_);
  };
  std::for_each(kept.begin(), kept.end(), load);
  if (!on_plane()) std::for_each(kept_of_faces.begin(), kept_of_faces.end(), load);
  for_each_memory([&](std::span<double> memory) {
    std::copy_n(in, memory.size(), memory.begin());
    in += static_cast<std::ptrdiff_t>(memory.size());
  });
  count_states();
  unsettled_ = 2;
  std::ranges::fill(near_at_, -std::numeric_limits<double>::infinity());
}

void Field::step(const Pose& pad_in_surface, double dt, const Twist* motion) {
  pose_ = pad_in_surface;
  events_.clear();
  for (const std::size_t k : {0U, 1U, 2U}) {
    std::swap(columns_[contact_x + k], columns_[contact_before_x + k]);
    std::swap(columns_[force_x + k], columns_[force_before_x + k]);
  }
  keep_as_before(press, press_before);
  keep_as_before(gap, gap_before);
  keep_as_before(limit, limit_before);
  keep_as_before(mode, mode_before);

  if (plain_ && touching_ == count_ && looks_at_plane()) {
    kernel::slide_on_plane(columns_, pose_, padded_);
  } else if (sparse_) {
    step_sparsely();
    placed_ = true;
    return;
  } else {
    step_in_stages(placed_ ? dt : 0.0, motion);
  }
  if (std::memcmp(columns_[mode], columns_[mode_before], count_ * sizeof(double)) != 0) resolve_events();
  placed_ = true;
}

void Field::step_in_stages(double dt, const Twist* motion) {
  find_contact_points();
  if (extended_) place_tips();
  for (const auto& effect : effects_.surface) {
    effect->displace(count_, columns_[place_x], columns_[place_y], columns_[normal_z], columns_[gap]);
  }
  if (!on_plane()) keep_energy();
  if (has_memory()) prepare_rheology(dt);
  if (!effects_.friction.empty() || effects_.rate) rate_friction(dt, motion);
  if (effects_.tip) {
    move_tips(dt);
    return;
  }
  if (touching_ < count_ && kernel::any_touches(columns_, has_memory(), padded_)) anchor_touched();
  step_ = dt;
  if (effects_.lean) {
    for (std::size_t i = 0; i < count_; ++i) map_leaning(i);
    return;
  }
  if (effects_.rate && dt > 0.0) {
    kernel::find_trials(columns_, on_plane(), padded_);
    if (!effects_.cone) {
      effects_.rate->strengthen(0, count_, dt, columns_[trial], columns_[k_tangential], columns_[slide], columns_[mu_kinetic]);
    }
  }
  if (effects_.cone) {
    for (std::size_t i = 0; i < count_; ++i) map_to_effect_cone(i);
  } else {
    kernel::map(columns_, on_plane(), extended_, padded_);
  }
  if (has_memory()) commit_rheology(dt);
}

// Where the tips meet effects. One that has come to another face will be anchored there anew, under its root (keep_energy).
void Field::place_tips() {
  kernel::place_tips(columns_, padded_);
  if (on_plane() || kernel::all_keep_faces(columns_, padded_)) return;
  for (std::size_t i = 0; i < count_; ++i) {
    if (share_face(i)) continue;
    for (const std::size_t k : {0U, 1U, 2U}) columns_[place_x + k][i] = columns_[contact_x + k][i];
  }
}

// Whether a face that element i meets is one that it met before.
bool Field::share_face(std::size_t i) const {
  return (static_cast<unsigned>(columns_[faces][i]) & static_cast<unsigned>(columns_[faces_before][i])) != 0;
}

// The s of field.h. k_n delta^2/2 is a function of the tip's position as long as an element meets one face with one s, and does not
// grow when either changes: a frictionless field gives no work, whatever the way.
void Field::keep_energy() {
  if (kernel::all_keep_faces(columns_, padded_)) return;
  for (std::size_t i = 0; i < count_; ++i) keep_energy(i);
}

void Field::keep_energy(std::size_t i) {
  const kernel::Columns& c = columns_;
  double& s = c[kernel::spent][i];
  const double depth = -c[kernel::gap][i], now = c[kernel::faces][i], before = c[kernel::faces_before][i];
  if (s == 0.0 && (!(depth > 0.0) || now == before)) return;
  if (!placed_) {
    s = 0.0;
  } else if (!(depth > 0.0) || share_face(i)) {
    s = std::min(s, std::max(0.0, depth));
  } else {
    s = std::max(0.0, depth - std::max(0.0, -c[kernel::gap_before][i]));
    for (const std::size_t k : {0U, 1U, 2U}) c[kernel::anchor_x + k][i] = c[kernel::contact_x + k][i];
  }
  c[kernel::gap][i] += s;
}

void Field::prepare_rheology(double dt) {
  std::copy_n(columns_[k_normal_spring], count_, columns_[k_normal]);
  std::copy_n(columns_[k_tangential_spring], count_, columns_[k_tangential]);
  for (const Column c : {h_normal, h_x, h_y, h_z}) std::fill_n(columns_[c], count_, 0.0);
  const AffineForce force{columns_[k_normal], columns_[h_normal], columns_[k_tangential],
                          columns_[h_x],      columns_[h_y],      columns_[h_z]};
  for (const auto& effect : effects_.rheology) effect->prepare(view(dt), force);
  for (std::size_t i = 0; i < count_; ++i) columns_[compliance][i] = 1.0 / columns_[k_tangential][i];
}

void Field::commit_rheology(double dt) {
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d u = stretch(i);
    columns_[depth][i] = penetration(i);
    if (effects_.lean) columns_[depth][i] = std::max(0.0, columns_[depth][i] - effects_.lean->drop(u.norm()));
    columns_[stretch_x][i] = u.x();
    columns_[stretch_y][i] = u.y();
    columns_[stretch_z][i] = u.z();
  }
  for (const auto& effect : effects_.rheology) {
    effect->commit(view(dt), columns_[stretch_x], columns_[stretch_y], columns_[stretch_z]);
  }
}

double Field::raw_press(std::size_t i) const {
  return kernel::raw_press(columns_[gap][i], columns_[k_normal][i], has_memory() ? columns_[h_normal][i] : 0.0);
}

void Field::rate_friction(double dt, const Twist* motion) {
  std::copy_n(columns_[mu_static_surface], count_, columns_[mu_static]);
  std::copy_n(columns_[mu_kinetic_surface], count_, columns_[mu_kinetic]);
  if (effects_.friction.empty()) return;
  kernel::rate(columns_, pose_, motion, dt, has_memory(), padded_);
  if (effects_.lean) {
    for (std::size_t i = 0; i < count_; ++i) {
      const double drop = effects_.lean->drop((vector(contact_x, i) - vector(place_x, i)).norm());
      columns_[depth][i] = std::max(0.0, columns_[depth][i] - drop);
      columns_[load][i] = std::max(0.0, columns_[load][i] - columns_[k_normal][i] * drop);
    }
  }
  for (const auto& effect : effects_.friction) effect->scale(view(dt), columns_[mu_static], columns_[mu_kinetic]);
}

// Where inside the step an element touches: where its gap closes, or, if a dashpot had let go of it inside the surface, where it
// pushes again.
double Field::touch_fraction(std::size_t i) const {
  return columns_[gap_before][i] > 0.0 ? zero_crossing(columns_[gap_before][i], columns_[gap][i])
                                       : zero_crossing(columns_[press_before][i], raw_press(i));
}

// What touches now and did not before is anchored where it touched, inside the step.
void Field::anchor_touched() {
  for (std::size_t i = 0; i < count_; ++i) {
    if (columns_[mode_before][i] == 0.0 && raw_press(i) > 0.0) anchor_touched(i);
  }
}

void Field::anchor_touched(std::size_t i) {
  const double fraction = touch_fraction(i);
  for (const std::size_t k : {0U, 1U, 2U}) {
    const double before = columns_[contact_before_x + k][i], now = columns_[contact_x + k][i];
    columns_[anchor_x + k][i] = placed_ ? before + fraction * (now - before) : now;
  }
}

// What an element is that does not touch; `raw`: its raw normal force.
void Field::detach(std::size_t i, double raw) {
  columns_[press][i] = raw;
  for (const std::size_t c : {0U, 1U, 2U}) {
    columns_[slip_x + c][i] = columns_[force_x + c][i] = 0.0;
    columns_[anchor_x + c][i] = columns_[contact_x + c][i];
  }
  columns_[limit][i] = columns_[mode][i] = 0.0;
}

// What an element is that touches: its stretch u before a slip [m], forces and slip.
void Field::settle(std::size_t i, const Eigen::Vector3d& u, const Eigen::Vector3d& force, const Eigen::Vector3d& slip,
                   bool slides) {
  const bool stays = !slides && on_plane();  // c - (c - a) is a up to rounding only
  const Eigen::Vector3d anchor = stays ? vector(anchor_x, i) : Eigen::Vector3d(vector(contact_x, i) - (u - slip));
  for (int c = 0; c < 3; ++c) {
    const auto at = static_cast<std::size_t>(c);
    columns_[slip_x + at][i] = slip[c];
    columns_[anchor_x + at][i] = anchor[c];
    columns_[force_x + at][i] = force[c];
  }
  columns_[limit][i] = columns_[mu_static][i] * std::max(0.0, columns_[press][i]);
  columns_[path][i] += slip.norm();
  columns_[mode][i] = slides ? 2.0 : 1.0;
}

// The part of v along the surface where element i meets it.
Eigen::Vector3d Field::tangential(std::size_t i, const Eigen::Vector3d& v) const {
  const Eigen::Vector3d n = vector(normal_x, i);
  return v - n * n.dot(v);
}

// The same mapping as the kernel's for a leaning column.
void Field::map_leaning(std::size_t i) {
  const double upright = raw_press(i);
  if (!(upright > 0.0)) {
    detach(i, upright);
    return;
  }
  const Lean& lean = *effects_.lean;
  const double k = columns_[k_tangential][i];
  const LeaningElement element{.stretch = tangential(i, vector(contact_x, i) - vector(anchor_x, i)),
                               .history = has_memory() ? tangential(i, vector(h_x, i)) : Eigen::Vector3d(0.0, 0.0, 0.0),
                               .k = k,
                               .k_normal = columns_[k_normal][i],
                               .depth = -columns_[gap][i],
                               .history_normal = has_memory() ? columns_[h_normal][i] : 0.0,
                               .mu_slide = columns_[mu_kinetic][i]};
  LeaningForce force = leaning_force(lean, element, element.stretch);
  const double size = force.tangential.norm();
  columns_[trial][i] = size;
  columns_[slide][i] = columns_[mu_static][i] * force.normal;
  const bool slid = columns_[mode_before][i] == 2.0;
  const double cone = (slid ? columns_[mu_kinetic][i] : columns_[mu_static][i]) * force.normal;
  double slip = 0.0;
  Eigen::Vector3d along(0.0, 0.0, 0.0);
  if (size > cone + k * kernel::shortest_slip) {
    along = force.tangential / size;
    const double trailed = element.stretch.norm() - (vector(contact_x, i) - vector(place_x, i)).norm();
    slip = leaning_slip(lean, element, along, trailed, step_, effects_.rate.get());
  }
  const bool slides = slip > kernel::shortest_slip;
  if (slides) {
    force.normal = leaning_force(lean, element, element.stretch - slip * along).normal;
    const double grown = effects_.rate && step_ > 0.0 ? effects_.rate->factor(slip / step_) : 1.0;
    force.tangential = element.mu_slide * force.normal * grown * along;
  } else {
    slip = 0.0;
  }
  if (force.normal > (k + lean.stop_stiffness) * lean.length) {
    throw SceneValueError("effects", "lean: element " + std::to_string(i) + " carries " + std::to_string(force.normal) +
                                         " N, and its stop holds a column up to (k_t + stop stiffness) length = " +
                                         std::to_string((k + lean.stop_stiffness) * lean.length) +
                                         " N; press less, or give the column a stiffer stop");
  }
  columns_[press][i] = force.normal;
  settle(i, element.stretch, force.tangential, slip * along, slides);
}

// The same mapping as the kernel's, with the projection left to the effect.
void Field::map_to_effect_cone(std::size_t i) {
  const double raw = raw_press(i), f_n = std::max(0.0, raw);
  if (f_n == 0.0) {
    detach(i, raw);
    return;
  }
  columns_[press][i] = raw;
  const Eigen::Vector3d n = vector(normal_x, i);
  const Eigen::Vector3d u = tangential(i, vector(contact_x, i) - vector(anchor_x, i));
  const double k = columns_[k_tangential][i];
  // The history was made in an earlier tangent plane.
  const Eigen::Vector3d history = has_memory() ? tangential(i, vector(h_x, i)) : Eigen::Vector3d(0.0, 0.0, 0.0);
  const Eigen::Vector3d tried = k * u + history;
  const double limit_stick = columns_[mu_static][i] * f_n;
  const double limit_slide = effects_.rate && step_ > 0.0 ? strengthened(i, tried, n) : columns_[mu_kinetic][i] * f_n;
  const bool slid = columns_[mode_before][i] == 2.0;
  const double cone = slid ? limit_slide : std::max(limit_stick, limit_slide);
  const auto mapped = effects_.cone->project(tried.data(), n.data(), cone + k * kernel::shortest_slip, limit_slide);
  const Eigen::Vector3d force(mapped.fx, mapped.fy, mapped.fz);
  Eigen::Vector3d slip(0.0, 0.0, 0.0);
  if (mapped.slides) slip = (tried - force) * columns_[compliance][i];
  settle(i, u, force, slip, mapped.slides);
}

// L g(w) [N] of the rate law for a trial force t that slides by associated flow on the effect's cone of that size: the slip s(L) is the
// distance over k of t from the cone of L, a convex function of the slope -h/k with h = f.e/L, e the direction of the slip. So each L from
// the tangent at the one before is too small, and they converge from below, quadratically.
double Field::strengthened(std::size_t i, const Eigen::Vector3d& t, const Eigen::Vector3d& n) {
  const double at_rest = columns_[slide][i], k = columns_[k_tangential][i];
  double sliding = at_rest;
  if (!(at_rest > 0.0) || !(cone_gauge(t, n, at_rest) > 1.0)) return sliding;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto on_cone = effects_.cone->project(t.data(), n.data(), 0.0, sliding);
    const Eigen::Vector3d f(on_cone.fx, on_cone.fy, on_cone.fz);
    const double left = (t - f).norm();
    const double h = f.dot(t - f) / (left * sliding);
    if (!(left > 0.0) || !(h > 0.0)) break;
    const double along = sliding + left / h, softer = k / h;
    double factor = 1.0;
    effects_.rate->strengthen(i, 1, step_, &along, &softer, &at_rest, &factor);
    const double next = at_rest * factor;
    const bool done = !(std::abs(next - sliding) > 1e-14 * next);
    sliding = next;
    if (done) break;
  }
  return sliding;
}

// Where inside the step the trial force leaves the stick cone. Force and limit are linear in the step, so their difference is
// convex and crosses zero once.
double Field::onset_fraction(std::size_t i) const {
  const Eigen::Vector3d start = vector(force_before_x, i);
  Eigen::Vector3d end = vector(force_x, i) + columns_[k_tangential][i] * vector(slip_x, i);
  const Eigen::Vector3d n = vector(normal_x, i);
  const double limit_start = columns_[limit_before][i];
  double limit_end = columns_[limit][i];
  if (effects_.lean) {  // a slip changes its normal force too
    end = columns_[trial][i] * vector(slip_x, i).normalized();
    limit_end = columns_[slide][i];
  }
  const auto inside = [&](double fraction) {
    const Eigen::Vector3d t = start + fraction * (end - start);
    const double limit = limit_start + fraction * (limit_end - limit_start);
    return cone_gauge(t, n, limit) < 1.0;
  };
  double low = 0.0, high = 1.0;
  for (int bit = 0; bit < 52; ++bit) {
    const double middle = 0.5 * (low + high);
    (inside(middle) ? low : high) = middle;
  }
  return high;
}

void Field::move_tips(double dt) {
  kernel::press_tips(columns_, padded_);
  const kernel::Columns& c = columns_;
  const TipColumns tips{
      count_,      padded_,         dt,        c[contact_x],    c[contact_y],  c[contact_before_x], c[contact_before_y],
      c[press],    c[press_before], c[limit],  c[limit_before], c[mu_kinetic], c[mode_before],      c[anchor_x],
      c[anchor_y], c[slip_x],       c[slip_y], c[path],         c[force_x],    c[force_y],          c[felt_x],
      c[felt_y],   c[mode]};
  effects_.tip->move(tips, events_);
  for (const auto& effect : effects_.ringing) effect->ring(tips);
}

double Field::sliding_share(std::size_t i) const {
  if (!effects_.rate || state(i) != ElementState::slip || !(step_ > 0.0)) return 0.0;
  const double resists = tangential_force(i).norm() * effects_.rate->growth(slip_step(i).norm() / step_) / step_;
  return resists / (columns_[k_tangential][i] + resists);
}

void Field::count_states() {
  touching_ = slipping_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    touching_ += state(i) != ElementState::detached ? 1 : 0;
    slipping_ += state(i) == ElementState::slip ? 1 : 0;
  }
}

void Field::resolve_events() {
  count_states();
  if (effects_.tip) return;  // which has told them
  for (std::size_t i = 0; i < count_; ++i) {
    if (state_before(i) != state(i)) resolve_event(i);
  }
}

void Field::resolve_event(std::size_t i) {
  const ElementState from = state_before(i), to = state(i);
  double fraction = 0.0;  // slip that ends has ended with the step before
  if (!placed_) {
    fraction = 1.0;
  } else if (from == ElementState::detached) {
    fraction = touch_fraction(i);
  } else if (to == ElementState::detached) {
    fraction = zero_crossing(columns_[press_before][i], columns_[press][i]);
  } else if (to == ElementState::slip) {
    fraction = onset_fraction(i);
  }
  events_.push_back({fraction, static_cast<std::uint32_t>(i), from, to});
}

ElementColumns Field::view(double dt) const {
  return {count_,
          dt,
          columns_[place_x],
          columns_[place_y],
          columns_[place_z],
          columns_[normal_x],
          columns_[normal_y],
          columns_[normal_z],
          columns_[depth],
          columns_[load],
          columns_[velocity_x],
          columns_[velocity_y],
          columns_[velocity_z],
          columns_[mode_before]};
}

void Field::view_from_pad() {
  sparse_ ? view_sparsely() : kernel::view_from_pad(columns_, pose_.rotation.transpose(), felt_, padded_);
}

Wrench Field::wrench_on_surface() const {
  Wrench total{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d force = vector(force_x, i) - vector(normal_x, i) * normal_force(i);
    total.force += force;
    total.torque += vector(contact_x, i).cross(force);
  }
  return total;
}

Wrench Field::wrench_on_pad() const {
  Wrench total{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d force = vector(normal_x, i) * normal_force(i) - vector(felt_, i);
    total.force += force;
    total.torque += (vector(contact_x, i) - pose_.position).cross(force);
  }
  return {pose_.rotation.transpose() * total.force, pose_.rotation.transpose() * total.torque};
}

Wrench Field::damped_wrench_on_pad(const Twist& motion, double tau) const {
  if (touching_ == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  return kernel::damped_wrench_on_pad(columns_, pose_.position, motion, tau, effects_.cone.get(), busy());
}

}  // namespace slipbench
