// Field: of many elements on a body's side few touch, and most are far from touching. What springs, friction and labels make of it is worked out
// for groups of elements (kernel::lanes) of which one touches, or has touched in the two steps before, so that both columns of each pair now/before
// have been written by what touches nothing. Of all others every column is, to the sign of a zero, what the dense passes would leave.
//
// Where an element meets the surface is worked out while it may touch. The distance from a surface changes by no more than a tip moves: a group
// whose tips are all outside by more than the pad has travelled since touches nothing and sleeps. When it may touch it is looked at where the pad was
// in the step before, since a touch is located by that, and so nothing depends on how long it has slept.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "sim/field/field.h"

namespace slipbench {
namespace {

constexpr double awake = -std::numeric_limits<double>::infinity();

// What distances and sums of ways are short by [m]: far more than they are rounded by, far less than what it costs to look too early.
constexpr double slack = 1e-9;

// A group that would be looked at again within so many steps goes on being near.
constexpr double least_sleep = 8.0;

bool is_outside(const Plane& /*shape*/, const Eigen::Vector3d& p) { return p.z() > 0.0; }
bool is_outside(const Sphere& shape, const Eigen::Vector3d& p) { return p.norm() > shape.radius; }
bool is_outside(const Box& shape, const Eigen::Vector3d& p) { return (p.cwiseAbs() - shape.half).maxCoeff() > 0.0; }
bool is_outside(const Cylinder& shape, const Eigen::Vector3d& p) {
  return std::hypot(p.x(), p.y()) > shape.radius || std::abs(p.z()) > shape.half_length;
}
bool is_outside(const Capsule& shape, const Eigen::Vector3d& p) {
  return (p - Eigen::Vector3d(0.0, 0.0, std::clamp(p.z(), -shape.half_length, shape.half_length))).norm() > shape.radius;
}
bool is_outside(const Ellipsoid& shape, const Eigen::Vector3d& p) { return p.cwiseQuotient(shape.half).norm() > 1.0; }
// Between its nodes a grid's distances may change by a little more than the way.
bool is_outside(const DistanceGrid& /*shape*/, const Eigen::Vector3d& /*p*/) { return false; }

// How far a point within `reach` [m] of the pad's origin may have come from one pose to the other [m].
double farthest_way(const Pose& from, const Pose& to, double reach) {
  return (to.position - from.position).norm() + (to.rotation - from.rotation).norm() * reach;
}

}  // namespace

void Field::begin_sparsely() {
  const std::size_t groups = padded_ / kernel::lanes;
  for (GroupList* list : {&near_, &busy_, &quiet_, &shown_, &woken_}) list->first.resize(groups);
  lit_.assign(groups, 1);
  near_at_.assign(groups, awake);
  for (const Element& element : layout_.elements) reach_ = std::max(reach_, element.tip.norm());
}

// How far the tips of a group must come at least before one touches [m]; `first`: its first element. 0 where that is not known.
double Field::room_of(std::size_t first) const {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t end = std::min(count_, first + kernel::lanes);
  for (std::size_t i = first; i < end; ++i) {
    if (columns_[spent][i] != 0.0) return 0.0;
    least = std::min(least, columns_[gap][i]);
  }
  return least - slack;
}

void Field::list_near() {
  near_.count = 0;
  next_near_ = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < near_at_.size(); ++g) {
    if (sleeps(g)) {
      next_near_ = std::min(next_near_, near_at_[g]);
    } else {
      near_.add(g * kernel::lanes);
    }
  }
}

// Wakes what may touch after a step in which tips have come as far as `way` [m].
void Field::wake(double way) {
  const double before = travelled_;
  // Of many small ways that are added to a long one each loses what the sum is rounded by.
  travelled_ += way + std::numeric_limits<double>::epsilon() * travelled_;
  if (travelled_ < next_near_) return;
  woken_.count = 0;
  for (std::size_t g = 0; g < near_at_.size(); ++g) {
    if (sleeps(g) && near_at_[g] <= travelled_) woken_.add(g * kernel::lanes);
  }
  // The columns of "before" tell of the step before; rest() makes those of "now" the same, and of what wakes they are written in this step.
  kernel::Columns then = columns_;
  for (const std::size_t k : {0U, 1U, 2U}) std::swap(then[contact_x + k], then[contact_before_x + k]);
  std::swap(then[gap], then[gap_before]);
  std::swap(then[faces], then[faces_before]);
  std::swap(then[press], then[press_before]);
  find_contact_points(then, met_at_, woken_.groups());
  kernel::rest(then, woken_.groups());
  for (std::size_t k = 0; k < woken_.count; ++k) {
    const std::size_t first = woken_.first[k];
    const double* const gaps = columns_[gap_before] + first;
    const double near_at = before + *std::min_element(gaps, gaps + std::min(kernel::lanes, count_ - first)) - slack;
    near_at_[first / kernel::lanes] = near_at > travelled_ ? near_at : awake;
  }
  list_near();
}

// Lets sleep what touches nothing and is far from it.
void Field::let_sleep(double way) {
  woken_.count = 0;
  for (std::size_t k = 0; k < quiet_.count; ++k) {
    const std::size_t first = quiet_.first[k], end = std::min(count_, first + kernel::lanes);
    const double room = room_of(first);
    if (!(room > least_sleep * way + slack)) continue;
    bool outside = true;
    for (std::size_t i = first; i < end && outside; ++i) {
      const Eigen::Vector3d tip = pose_ * vector(tip_x, i);
      outside = std::visit([&](const auto& shape) { return is_outside(shape, tip); }, surface_);
    }
    if (!outside) continue;
    near_at_[first / kernel::lanes] = travelled_ + room;
    woken_.add(first);
  }
  if (woken_.count == 0) return;
  kernel::rest(columns_, woken_.groups());
  list_near();
}

void Field::step_sparsely() {
  const double way = farthest_way(met_at_, pose_, reach_);
  keep_as_before(faces, faces_before);
  if (unsettled_ > 0) {
    list_near();
  } else {
    wake(way);
  }
  find_contact_points(columns_, pose_, near_.groups());
  const auto for_each = [this](const GroupList& groups, auto&& visit) {
    for (std::size_t k = 0; k < groups.count; ++k) {
      const std::size_t first = groups.first[k], end = std::min(count_, first + kernel::lanes);
      for (std::size_t i = first; i < end; ++i) visit(i);
    }
  };
  if (!kernel::all_keep_faces(columns_, near_.groups())) for_each(near_, [this](std::size_t i) { keep_energy(i); });
  bool touches;
  if (unsettled_ > 0) {
    --unsettled_;
    busy_ = near_;  // all
    quiet_.count = 0;
    touches = kernel::any_touches(columns_, false, padded_);
  } else {
    const kernel::Sorted sorted = kernel::sort_groups(columns_, near_.groups(), busy_.first.data(), quiet_.first.data());
    busy_.count = sorted.busy;
    quiet_.count = sorted.quiet;
    touches = sorted.touches;
  }
  for (std::size_t k = 0; k < busy_.count; ++k) lit_[busy_.first[k] / kernel::lanes] = 1;
  if (touches) {
    for_each(busy_, [this](std::size_t i) {
      if (columns_[mode_before][i] == 0.0 && raw_press(i) > 0.0) anchor_touched(i);
    });
  }
  kernel::map_active(columns_, busy_.groups());
  if (kernel::any_changes(columns_, busy_.groups())) {
    touching_ = slipping_ = 0;
    for_each(busy_, [this](std::size_t i) {
      touching_ += state(i) != ElementState::detached ? 1 : 0;
      slipping_ += state(i) == ElementState::slip ? 1 : 0;
      if (state_before(i) != state(i)) resolve_event(i);
    });
  }
  if (quiet_.count > 0) let_sleep(way);
  met_at_ = pose_;
}

// Brings up to date where all elements that sleep meet the surface.
void Field::look_at_sleeping() {
  woken_.count = 0;
  for (std::size_t g = 0; g < near_at_.size(); ++g) {
    if (sleeps(g)) woken_.add(g * kernel::lanes);
  }
  look_at_woken();
}

void Field::look_at(std::size_t i) {
  woken_.count = 0;
  if (sparse_ && sleeps(i / kernel::lanes)) woken_.add(i / kernel::lanes * kernel::lanes);
  look_at_woken();
}

void Field::look_at_woken() {
  if (woken_.count == 0) return;
  find_contact_points(columns_, pose_, woken_.groups());
  kernel::rest(columns_, woken_.groups());
}

void Field::view_sparsely() {
  shown_.count = woken_.count = 0;
  for (std::size_t g = 0; g < lit_.size(); ++g) {
    if (lit_[g] == 0) continue;
    shown_.add(g * kernel::lanes);
    if (sleeps(g)) woken_.add(g * kernel::lanes);
  }
  look_at_woken();
  kernel::view_active(columns_, pose_.rotation.transpose(), shown_.groups());
}

void Field::labels_have_read() {
  for (std::size_t k = 0; k < shown_.count; ++k) {
    const double* const states = columns_[mode] + shown_.first[k];
    lit_[shown_.first[k] / kernel::lanes] =
        std::any_of(states, states + kernel::lanes, [](double m) { return m != 0.0; }) ? 1 : 0;
  }
}

}  // namespace slipbench
