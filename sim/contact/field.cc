#include "sim/contact/field.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>
#include <stdexcept>
#include <string>

#include "sim/contact/dashpot.h"
#include "sim/contact/effect_cone.h"
#include "sim/contact/return_mapping.h"
#include "sim/core/error.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

constexpr std::size_t alignment = 64;

const PadLayout& checked(const PadLayout& layout, const Friction& friction) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("field: " + what); };
  if (layout.elements.empty()) refuse("a pad needs at least one element");
  if (layout.elements.size() > Field::max_elements) {
    refuse("a pad of " + std::to_string(layout.elements.size()) + " elements; allowed: up to " +
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
  if (!(friction.mu_kinetic >= 0.0) || !(friction.mu_static >= friction.mu_kinetic) || std::isinf(friction.mu_static)) {
    refuse("friction must satisfy 0 <= mu_kinetic <= mu_static");
  }
  return layout;
}

// Returns the fraction of the step at which a quantity that changes linearly from `before` to `now`
// is zero.
double zero_crossing(double before, double now) {
  const double fraction = before / (before - now);
  return fraction >= 0.0 && fraction <= 1.0 ? fraction : 0.0;
}

}  // namespace

Field::Field(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects effects)
    : FieldResults(checked(layout, friction), surface, friction, std::move(effects)) {
  if (auto dashpots = make_dashpots(layout_)) effects_.rheology.push_back(std::move(dashpots));
  if (effects_.tip && (!on_plane() || effects_.cone || effects_.rate || has_memory())) {
    throw std::invalid_argument(
        "field: tips with mass need a plane and cannot be combined with another cone, rate law, rheology or dashpot");
  }
  if (effects_.skin && (effects_.tip || effects_.cone || effects_.rate || has_memory())) {
    throw std::invalid_argument(
        "field: an elastic skin cannot be combined with tips with mass, another cone, rate law, rheology or dashpot");
  }
  extended_ =
      !effects_.surface.empty() || !effects_.friction.empty() || effects_.rate || has_memory() || effects_.tip || effects_.skin;
  const std::size_t columns = extended_ ? kernel::all_columns : kernel::plain_columns;
  // A stride of whole pages would put the same row of all columns into one set of the L1 cache.
  const std::size_t stride = padded_ + (padded_ % 512 == 0 ? kernel::lanes : 0);
  const std::size_t bytes = columns * stride * sizeof(double);
  block_.reset(static_cast<double*>(std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)));
  if (!block_) throw std::bad_alloc();
  std::memset(block_.get(), 0, bytes);
  std::array<double*, kernel::all_columns> all{};
  for (std::size_t c = 0; c < columns; ++c) all[c] = block_.get() + c * stride;
  columns_ = std::bit_cast<kernel::Columns>(all);
  if (!has_memory()) columns_.history.tangential.x = nullptr;

  for (std::size_t i = 0; i < count_; ++i) {
    const Element& element = layout_.elements[i];
    columns_.tip.set(i, element.tip);
    columns_.axis.set(i, element.axis);
    columns_.k_normal[i] = element.k_normal;
    columns_.k_tangential[i] = element.k_tangential;
    columns_.compliance[i] = 1.0 / element.k_tangential;
    columns_.mu_static[i] = friction.mu_static;
    columns_.mu_kinetic[i] = friction.mu_kinetic;
  }
  if (extended_) {
    std::copy_n(columns_.k_normal, count_, columns_.spring.k_normal);
    std::copy_n(columns_.k_tangential, count_, columns_.spring.k_tangential);
    std::copy_n(columns_.mu_static, count_, columns_.surface.mu_static);
    std::copy_n(columns_.mu_kinetic, count_, columns_.surface.mu_kinetic);
  } else {
    columns_.spring.k_normal = columns_.k_normal;
    columns_.spring.k_tangential = columns_.k_tangential;
  }
  may_update_separated_ = extended_ && !on_plane() && !effects_.cone && !effects_.tip && !effects_.skin && !has_memory() &&
                          effects_.surface.empty() &&
                          std::ranges::all_of(effects_.friction, [](const auto& effect) { return effect->memory().empty(); });
  if (effects_.skin) skin_.emplace(*effects_.skin, layout_, columns_);
  std::fill(columns_.normal.z, columns_.normal.z + padded_, 1.0);
  for_each_kept([this](std::span<const double> part) { state_size_ += part.size(); });
  const bool springs_alone = !extended_ && !effects_.cone;
  plain_ = springs_alone && on_plane() && contacts_.flat_pad();
  if (springs_alone && !on_plane() && !contacts_.is_thin() && count_ >= ActiveSet::least_elements) active_set_.emplace(layout_);
}

// Calls visit() for each part of the state, in order.
template <class Visit>
void Field::for_each_kept(Visit&& visit) {
  const kernel::Columns& c = columns_;
  const auto visit_all = [&](std::initializer_list<double*> all) {
    for (double* const column : all) visit(std::span(column, count_));
  };
  visit_all({c.contact.x, c.contact.y, c.contact.z, c.gap, c.f_normal, c.limit, c.mode, c.anchor.x, c.anchor.y, c.anchor.z,
             c.force.x, c.force.y, c.force.z, c.path});
  if (!on_plane()) visit_all({c.faces, c.depth_offset});  // a plane has a single face
  if (skin_) {                                            // at rest it does not recompute these
    visit_all({c.depth});
    if (!on_plane()) visit_all({c.normal.x, c.normal.y, c.normal.z});
    visit(skin_->pose());
  }
  // of any shape, since models are compiled before the grids of their meshes exist
  if (!on_plane()) visit(std::span(pose_before_));
  effects_.for_each([&](Effect& effect) { visit(effect.memory()); });
}

void Field::save_state(std::span<double> state) {
  if (active_set_) active_set_->update_all(contacts_, columns_);
  state[0] = placed_ ? 1.0 : 0.0;
  auto out = state.begin() + 1;
  for_each_kept([&out](std::span<const double> part) { out = std::ranges::copy(part, out).out; });
}

void Field::load_state(std::span<const double> state) {
  placed_ = state[0] != 0.0;
  auto in = state.begin() + 1;
  for_each_kept([&in](std::span<double> part) { in = std::ranges::copy_n(in, std::ssize(part), part.begin()).in; });
  count_states(all());
  if (active_set_) active_set_->reset();
}

SLIPBENCH_INLINE void Field::begin_step(const Pose& pad_in_surface, double dt) {
  // separate: assigning the whole pose would wait for the position to be written
  pose_.rotation = pad_in_surface.rotation;
  pose_.position = pad_in_surface.position;
  step_ = placed_ ? dt : 0.0;
  events_.clear();
  lost_.reset();
  columns_.swap_before();
}

void Field::find_contacts() {
  if (skin_) return find_contacts_of_skin();
  if (!on_plane()) std::swap(columns_.faces, columns_.faces_before);
  candidates_ = active_set_ ? active_set_->begin_step(contacts_, columns_, pose_) : all();
  if (!active_set_) contacts_.find(columns_, pose_, candidates_);
  if (contacts_.knows_crossings()) keep_faces_of_grid();
}

Pose Field::pose_before() const {
  return {Eigen::Map<const Eigen::Matrix3d>(pose_before_.data()), Eigen::Map<const Eigen::Vector3d>(pose_before_.data() + 9)};
}

// A grid does not tell its faces apart. An element that meets the face that it entered instead of the
// nearest one keeps its bits if its gap has changed by no more than its tip has moved, and gets a
// new one otherwise. Offsets and bumps are not in these gaps.
void Field::keep_faces_of_grid() {
  if (!placed_) return;
  const Pose before = pose_before();
  for_each_element(candidates_, [&](std::size_t i) {
    const auto here = static_cast<unsigned>(columns_.faces[i]), last = static_cast<unsigned>(columns_.faces_before[i]);
    if (!(columns_.gap[i] < 0.0) || last == 0 || here == 0 || (here == SurfacePoint::only_face && (here & last) != 0)) return;
    const Eigen::Vector3d &place = layout_.elements[i].tip, tip_before = before * place;
    const bool was_inside = last != SurfacePoint::only_face || columns_.before.gap[i] < 0.0;
    const double gap_then = (was_inside ? -1.0 : 1.0) * (tip_before - columns_.before.contact.at(i)).norm();
    const bool continuous = std::abs(columns_.gap[i] - gap_then) <= (pose_ * place - tip_before).norm() + same_place;
    constexpr unsigned other = 2 * DistanceGrid::entered;
    if (here == SurfacePoint::only_face) {
      if (continuous) columns_.faces[i] = here | last;
    } else if (continuous) {
      columns_.faces[i] = last;
    } else {
      columns_.faces[i] = (last & DistanceGrid::entered) != 0 ? other : DistanceGrid::entered;
    }
  });
}

void Field::find_forces(const Twist* motion) { skin_ ? step_on_skin(motion) : step_in_stages(motion); }

void Field::find_contacts_of_skin() {
  candidates_ = all();
  if (skin_->rests(pose_, placed_ && effects_.friction.empty())) return skin_->keep_state(columns_);
  skin_->place_tips(columns_, pose_);
  contacts_.find(columns_, pose_, all());
  for (const auto& effect : effects_.surface) {
    effect->displace(count_, columns_.contact.x, columns_.contact.y, columns_.normal.z, columns_.gap);
  }
}

void Field::step_on_skin(const Twist* motion) {
  if (skin_->rests()) return;
  open_excluded();
  skin_->press(columns_, pose_, on_plane());
  if (!effects_.friction.empty()) rate_friction(step_, motion);
  skin_->shear(columns_, pose_, placed_);
}

SLIPBENCH_INLINE void Field::end_step() {
  if (kernel::any_changes(columns_, active())) resolve_events();
  if (contacts_.knows_crossings()) {
    if (placed_ && !effects_.skin) note_passed();
    Eigen::Map<Eigen::Matrix3d>(pose_before_.data()) = pose_.rotation;
    Eigen::Map<Eigen::Vector3d>(pose_before_.data() + 9) = pose_.position;
  }
  if (active_set_) active_set_->end_step(contacts_, columns_);
  placed_ = true;
}

void Field::step(const Pose& pad_in_surface, double dt, const Twist* motion) {
  begin_step(pad_in_surface, dt);
  if (plain_ && touching_ == count_ && excluded_.empty() && contacts_.faces_plane(pose_)) {
    kernel::slide_on_plane(columns_, pose_, padded_);
  } else {
    find_contacts();
    find_forces(motion);
  }
  end_step();
}

void Field::approach(const Pose& pad_in_surface, double dt) {
  begin_step(pad_in_surface, dt);
  find_contacts();
}

void Field::finish(const Twist* motion) {
  find_forces(motion);
  end_step();
}

void Field::step_in_stages(const Twist* motion) {
  if (may_update_separated_ && touching_ == 0 && kernel::update_if_separated(columns_, padded_)) return;
  if (extended_) place_tips();
  for (const auto& effect : effects_.surface) {
    effect->displace(count_, columns_.place.x, columns_.place.y, columns_.normal.z, columns_.gap);
  }
  open_excluded();
  if (!on_plane() && !kernel::all_keep_faces(columns_, candidates_)) {
    for_each_element(candidates_, [this](std::size_t i) { keep_energy(i); });
  }
  if (has_memory()) prepare_rheology(step_);
  if (!effects_.friction.empty() || effects_.rate) rate_friction(step_, motion);
  if (effects_.tip) {
    move_tips(step_);
    return;
  }
  const bool touches =
      active_set_ ? active_set_->sort(columns_) : touching_ < count_ && kernel::any_touches(columns_, has_memory(), padded_);
  if (touches) {  // anchor new contacts where they touched, inside the step
    for_each_element(active(), [this](std::size_t i) {
      if (columns_.before.mode[i] == 0.0 && raw_normal_force(i) > 0.0) anchor_touched(i);
    });
  }
  map_to_cone();
  if (has_memory()) commit_rheology(step_);
}

// Moves elements that touch another surface out of this one, by their depth.
void Field::open_excluded() {
  for (const std::uint32_t i : excluded_) {
    if (columns_.gap[i] >= 0.0) continue;
    columns_.gap[i] = -columns_.gap[i];
    if (!on_plane()) columns_.faces[i] = 0.0;
  }
}

bool Field::is_near() const {
  // a tip in a grid may point out of it near a seam
  if (touching_ > 0 || has_bumps() || on_grid()) return true;
  for (std::size_t k = 0; k < candidates_.count; ++k) {
    const double* const gaps = columns_.gap + candidates_[k];
    if (std::any_of(gaps, gaps + kernel::lanes, [](double each) { return each < 0.0; })) return true;
  }
  return false;
}

double Field::way_inside(std::size_t i) const {
  const Eigen::Vector3d axis = pose_.rotation * layout_.elements[i].axis;
  return columns_.gap[i] / normal(i).dot(axis);
}

bool Field::keeps_face(std::size_t i) const { return is_inside(i) && (on_plane() || share_face(i)); }

std::optional<ContactPoints::Entry> Field::entry(std::size_t i, double from) const {
  if (active_set_ && !active_set_->is_awake(i)) return std::nullopt;
  return contacts_.entry(pose_ * layout_.elements[i].tip, pose_.rotation * layout_.elements[i].axis, from);
}

void Field::meet_face(std::size_t i, const ContactPoints::Entry& entry) {
  if (is_inside(i) && (on_plane() || static_cast<unsigned>(columns_.faces[i]) == entry.faces)) return;
  const Eigen::Vector3d tip = pose_ * layout_.elements[i].tip, axis = pose_.rotation * layout_.elements[i].axis;
  const double deep = -entry.way * entry.n.dot(axis);
  const Eigen::Vector3d contact = tip + deep * entry.n;
  columns_.gap[i] = -deep;
  columns_.faces[i] = entry.faces;
  columns_.normal.set(i, entry.n);
  columns_.contact.set(i, contact);
}

double Field::travel(std::size_t i) const {
  const double offset = on_plane() ? 0.0 : columns_.depth_offset[i];
  return (columns_.contact.at(i) - columns_.before.contact.at(i)).norm() +
         std::abs(columns_.gap[i] + offset - columns_.before.gap[i]);
}

// The element's columns of "before" are set as if it had always touched `next`. Its tip comes from
// the surface held here, taken as a plane, so both depths are known at one position: the excess in
// `next` is the offset s of field.h.
void Field::hand_over(std::size_t i, Field& next, const Pose& here_in_next) {
  const kernel::Columns &from = columns_, &to = next.columns_;
  const auto in_plane = [](const Eigen::Vector3d& v, const Eigen::Vector3d& n) { return Eigen::Vector3d(v - v.dot(n) * n); };
  if (effects_.skin) return;
  const Eigen::Vector3d axis = pose_.rotation * layout_.elements[i].axis, tip = pose_ * layout_.elements[i].tip;
  const Eigen::Vector3d contact = columns_.before.contact.at(i), anchor = columns_.anchor.at(i);
  const Eigen::Vector3d n =
      contacts_.normal_at(contact, axis, on_plane() ? SurfacePoint::only_face : static_cast<unsigned>(from.faces_before[i]));
  const Eigen::Vector3d there = next.normal(i);
  const double offset = on_plane() ? 0.0 : from.depth_offset[i], beyond = (tip - contact).dot(n);
  const Eigen::Vector3d root = tip - beyond * n;  // contact point on the surface held here
  const Eigen::Vector3d stretch = in_plane(here_in_next.rotation * (root - anchor), there);
  const Eigen::Vector3d way = in_plane(here_in_next.rotation * (root - contact), there);
  to.anchor.set(i, to.contact.at(i) - stretch);
  to.before.contact.set(i, to.contact.at(i) - way);
  to.before.force.set(i, in_plane(here_in_next.rotation * from.before.force.at(i), there));
  to.before.gap[i] = from.before.gap[i];
  to.before.f_normal[i] = from.before.f_normal[i];
  to.before.limit[i] = from.before.limit[i];
  to.before.mode[i] = from.before.mode[i];
  if (!next.on_plane()) {
    to.faces_before[i] = to.faces[i];
    // A bend of the surface is passed at one position along the axis, although the depths along the
    // two normals differ. Only a distance between the faces along the axis is a jump.
    const double jump = -to.gap[i] - std::max(0.0, -beyond);
    const double along_there = there.dot(here_in_next.rotation * axis), along = n.dot(axis);
    const double ahead = to.gap[i] / along_there - beyond / along;
    const double travelled = (root - contact).norm() + std::abs(-beyond - offset + from.before.gap[i]);
    to.depth_offset[i] = std::max(0.0, offset + (std::abs(ahead) > travelled + same_place ? jump : 0.0));
  }
  const auto pass_on = [&](const auto& mine, const auto& others) {
    for (std::size_t k = 0; k < mine.size(); ++k) mine[k]->pass_on(i, *others[k], here_in_next.rotation);
  };
  pass_on(effects_.friction, next.effects_.friction);
  pass_on(effects_.rheology, next.effects_.rheology);
  if (effects_.rate) effects_.rate->pass_on(i, *next.effects_.rate, here_in_next.rotation);
  --touching_;
  ++next.touching_;
  if (state_before(i) == ElementState::slip) {
    --slipping_;
    ++next.slipping_;
  }
  from.before.force.set(i, Eigen::Vector3d::Zero());
  from.before.gap[i] = std::abs(from.before.gap[i]);
  from.before.f_normal[i] = -std::abs(from.before.f_normal[i]);
  from.before.limit[i] = from.before.mode[i] = 0.0;
  if (!on_plane()) from.depth_offset[i] = 0.0;
  // of two steps ago: keeps the group of a sparse field active in this step (ActiveSet)
  from.mode[i] = 1.0;
  ++changes_;
  ++next.changes_;
}

void Field::map_to_cone() {
  RateEffect* const rate = step_ > 0.0 ? effects_.rate.get() : nullptr;
  if (effects_.cone) {
    kernel::return_map_each(columns_, on_plane(), extended_, count_, [&](std::size_t i, const kernel::Trial& trial) {
      return project_onto_cone(*effects_.cone, rate, step_, columns_, i, trial);
    });
  } else {
    if (rate != nullptr) {
      kernel::find_trials(columns_, on_plane(), padded_);
      rate->strengthen(0, count_, step_, columns_.trial, columns_.k_tangential, columns_.slide, columns_.mu_kinetic);
    }
    kernel::return_map(columns_, on_plane(), extended_, active());
  }
}

// Positions at which the tips read effects. A tip that has come to another face is placed under its
// root, where keep_energy() re-anchors it.
void Field::place_tips() {
  kernel::place_tips(columns_, padded_);
  if (on_plane() || kernel::all_keep_faces(columns_, all())) return;
  for (std::size_t i = 0; i < count_; ++i) {
    if (share_face(i)) continue;
    columns_.place.set(i, columns_.contact.at(i));
  }
}

// True if element i meets a face that it met before.
bool Field::share_face(std::size_t i) const {
  return (static_cast<unsigned>(columns_.faces[i]) & static_cast<unsigned>(columns_.faces_before[i])) != 0;
}

// Updates the offset s of field.h. k_n delta^2/2 is a function of the tip's position while an
// element meets one face with one s, and does not grow when either changes: a frictionless field
// delivers no work on any path.
void Field::keep_energy(std::size_t i) {
  const kernel::Columns& c = columns_;
  double& s = c.depth_offset[i];
  const double depth = -c.gap[i], now = c.faces[i], before = c.faces_before[i];
  if (s == 0.0 && (!(depth > 0.0) || now == before)) return;
  if (!placed_) {
    s = 0.0;
  } else if (!(depth > 0.0) || share_face(i)) {
    s = std::min(s, std::max(0.0, depth));
  } else {
    s = std::max(0.0, depth - std::max(0.0, -c.before.gap[i]));
    c.anchor.set(i, c.contact.at(i));
  }
  c.gap[i] += s;
}

void Field::prepare_rheology(double dt) {
  std::copy_n(columns_.spring.k_normal, count_, columns_.k_normal);
  std::copy_n(columns_.spring.k_tangential, count_, columns_.k_tangential);
  const auto& history = columns_.history;
  for (double* const column : {history.normal, history.tangential.x, history.tangential.y, history.tangential.z}) {
    std::fill_n(column, count_, 0.0);
  }
  const AffineForce force{columns_.k_normal,
                          columns_.history.normal,
                          columns_.k_tangential,
                          columns_.history.tangential.x,
                          columns_.history.tangential.y,
                          columns_.history.tangential.z};
  for (const auto& effect : effects_.rheology) effect->prepare(view(dt), force);
  for (std::size_t i = 0; i < count_; ++i) columns_.compliance[i] = 1.0 / columns_.k_tangential[i];
}

void Field::commit_rheology(double dt) {
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d u = stretch(i);
    columns_.depth[i] = penetration(i);
    columns_.stretch.set(i, u);
  }
  for (const auto& effect : effects_.rheology) {
    effect->commit(view(dt), columns_.stretch.x, columns_.stretch.y, columns_.stretch.z);
  }
}

double Field::raw_normal_force(std::size_t i) const {
  return kernel::raw_normal_force(columns_.gap[i], columns_.k_normal[i], has_memory() ? columns_.history.normal[i] : 0.0);
}

void Field::rate_friction(double dt, const Twist* motion) {
  std::copy_n(columns_.surface.mu_static, count_, columns_.mu_static);
  std::copy_n(columns_.surface.mu_kinetic, count_, columns_.mu_kinetic);
  if (effects_.friction.empty()) return;
  const bool speeds = std::ranges::any_of(effects_.friction, [](const auto& effect) { return effect->by_speed(); });
  kernel::rate(columns_, pose_, motion, dt, has_memory(), speeds, padded_);
  if (effects_.skin) {
    for (std::size_t i = 0; i < count_; ++i) columns_.load[i] = normal_force(i);
  }
  for (const auto& effect : effects_.friction) effect->scale(view(dt), columns_.mu_static, columns_.mu_kinetic);
}

// Returns the fraction of the step at which an element touches: where its gap closes or, if a
// dashpot had released it inside the surface, where it pushes again.
double Field::touch_fraction(std::size_t i) const {
  return columns_.before.gap[i] > 0.0 ? zero_crossing(columns_.before.gap[i], columns_.gap[i])
                                      : zero_crossing(columns_.before.f_normal[i], raw_normal_force(i));
}

void Field::anchor_touched(std::size_t i) {
  const double fraction = touch_fraction(i);
  const Eigen::Vector3d before = columns_.before.contact.at(i), now = columns_.contact.at(i);
  columns_.anchor.set(i, placed_ ? Eigen::Vector3d(before + fraction * (now - before)) : now);
}

// Returns the fraction of the step at which the trial force leaves the stick cone. Force and limit
// are linear in the step, so their difference is convex and crosses zero once.
double Field::onset_fraction(std::size_t i) const {
  const Eigen::Vector3d start = columns_.before.force.at(i);
  const Eigen::Vector3d end = columns_.force.at(i) + columns_.k_tangential[i] * columns_.slip.at(i);
  const Eigen::Vector3d n = columns_.normal.at(i);
  const double limit_start = columns_.before.limit[i], limit_end = columns_.limit[i];
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
  kernel::load_tips(columns_, padded_);
  const kernel::Columns& c = columns_;
  const TipColumns tips{.count = count_,
                        .padded = padded_,
                        .dt = dt,
                        .x = c.contact.x,
                        .y = c.contact.y,
                        .x_before = c.before.contact.x,
                        .y_before = c.before.contact.y,
                        .f_normal = c.f_normal,
                        .f_normal_before = c.before.f_normal,
                        .limit = c.limit,
                        .limit_before = c.before.limit,
                        .mu_kinetic = c.mu_kinetic,
                        .mode_before = c.before.mode,
                        .tip_x = c.anchor.x,
                        .tip_y = c.anchor.y,
                        .slip_x = c.slip.x,
                        .slip_y = c.slip.y,
                        .path = c.path,
                        .friction_x = c.force.x,
                        .friction_y = c.force.y,
                        .transmitted_x = c.transmitted.x,
                        .transmitted_y = c.transmitted.y,
                        .mode = c.mode};
  effects_.tip->move(tips, events_);
  for (const auto& effect : effects_.ringing) effect->ring(tips);
  kernel::clear_ended_slip(columns_, padded_);
}

void Field::count_states(const kernel::Groups& groups) {
  ++changes_;
  touching_ = slipping_ = 0;
  for_each_element(groups, [this](std::size_t i) {
    touching_ += state(i) != ElementState::detached ? 1 : 0;
    slipping_ += state(i) == ElementState::slip ? 1 : 0;
  });
}

void Field::resolve_events() {
  count_states(active());
  if (effects_.tip) return;  // the effect has reported them
  for_each_element(active(), [this](std::size_t i) {
    if (state_before(i) != state(i)) resolve_event(i);
  });
}

void Field::resolve_event(std::size_t i) {
  const ElementState from = state_before(i), to = state(i);
  double fraction = 0.0;  // a slip that ends has ended at the end of the last step
  if (!placed_) {
    fraction = 1.0;
  } else if (from == ElementState::detached) {
    fraction = touch_fraction(i);
  } else if (to == ElementState::detached) {
    fraction = zero_crossing(columns_.before.f_normal[i], columns_.f_normal[i]);
  } else if (to == ElementState::slip) {
    fraction = onset_fraction(i);
  }
  events_.push_back({fraction, static_cast<std::uint32_t>(i), from, to});
  if (to == ElementState::detached && !on_plane() && placed_) note_lost(i);
}

void Field::note_lost(std::size_t i) {
  constexpr double least_depth = 1e-5;  // m: below the accuracy of body positions
  const double depth = -columns_.before.gap[i];
  // An element with an offset separates when it is no deeper than the offset (keep_energy).
  // Crossings tell walls of any thickness, but not for the tips of a skin, which do not move straight.
  const bool by_crossings = contacts_.knows_crossings() && !effects_.skin;
  if ((depth < least_depth && !by_crossings) || columns_.depth_offset[i] > 0.0) return;
  const Eigen::Vector3d tip = pose_ * layout_.elements[i].tip, axis = pose_.rotation * layout_.elements[i].axis;
  if (by_crossings) {
    const Eigen::Vector3d before = pose_before() * layout_.elements[i].tip, to_face = columns_.before.contact.at(i) - before;
    if (to_face.norm() > same_place && contacts_.has_left_grid(before, tip, axis, to_face.normalized())) lost_ = Lost{i, depth};
    return;
  }
  if (contacts_.has_come_through(tip, axis, static_cast<unsigned>(columns_.faces_before[i]), depth, contacts_.at(tip, axis)))
    lost_ = Lost{i, depth};
}

// An element that touched neither before nor now may have passed a whole wall in one step.
void Field::note_passed() {
  const Pose pose_then = pose_before();
  const double shift = (pose_.position - pose_then.position).norm(), turn = (pose_.rotation - pose_then.rotation).norm();
  for_each_element(candidates_, [&](std::size_t i) {
    if (state_before(i) != ElementState::detached || state(i) != ElementState::detached) return;
    const Eigen::Vector3d& place = layout_.elements[i].tip;
    if (columns_.gap[i] > shift + turn * place.norm() || std::ranges::find(excluded_, i) != excluded_.end()) return;
    const Eigen::Vector3d axis = pose_.rotation * layout_.elements[i].axis;
    if (contacts_.has_left_grid(pose_then * place, pose_ * place, axis, Eigen::Vector3d::Zero())) lost_ = Lost{i, 0.0};
  });
}

std::optional<std::size_t> Field::overcompressed() const {
  const double height = layout_.unit_height;
  if (!std::isfinite(height) || touching() == 0 || !kernel::any_deeper(columns_, height, active())) return std::nullopt;
  for (std::size_t i = 0; i < count_; ++i) {
    if (penetration(i) > height) return i;
  }
  return std::nullopt;
}

ElementColumns Field::view(double dt) const {
  const kernel::Columns& c = columns_;
  return {.count = count_,
          .dt = dt,
          .x = c.place.x,
          .y = c.place.y,
          .z = c.place.z,
          .nx = c.normal.x,
          .ny = c.normal.y,
          .nz = c.normal.z,
          .penetration = c.depth,
          .normal_force = c.load,
          .vx = c.velocity.x,
          .vy = c.velocity.y,
          .vz = c.velocity.z,
          .mode = c.before.mode};
}

}  // namespace slipbench
