#include "sim/contact/active_set.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slipbench {
namespace {

using kernel::lanes;

// Amount by which distances and sums of travel are reduced [m]: far more than their rounding error,
// far less than what an early wake-up would cost.
constexpr double slack = 1e-9;

// A group that would wake within this many steps is not put to sleep.
constexpr double least_sleep = 8.0;

// Returns an upper bound of the travel between two poses of any point within `reach` [m] of the
// pad's origin [m].
double farthest_way(const Pose& from, const Pose& to, double reach) {
  return (to.position - from.position).norm() + (to.rotation - from.rotation).norm() * reach;
}

}  // namespace

ActiveSet::ActiveSet(const PadLayout& layout) : count_(layout.elements.size()) {
  const std::size_t groups = (count_ + lanes - 1) / lanes;
  for (List* list : {&candidates_, &active_, &idle_, &listed_, &selected_}) list->first.resize(groups);
  last_active_.assign(groups, 0);
  wakes_at_.assign(groups, awake);
  for (const Element& element : layout.elements) reach_ = std::max(reach_, element.tip.norm());
}

void ActiveSet::reset() {
  all_active_ = 2;
  std::ranges::fill(wakes_at_, awake);
}

kernel::Groups ActiveSet::begin_step(const ContactPoints& contacts, const kernel::Columns& columns, const Pose& pose) {
  ++steps_;
  step_travel_ = farthest_way(pose_, pose, reach_);
  if (all_active_ > 0) {
    list_candidates();
  } else {
    wake(contacts, columns);
  }
  pose_ = pose;
  contacts.find(columns, pose_, candidates_.groups());
  return candidates_.groups();
}

bool ActiveSet::sort(const kernel::Columns& columns) {
  bool touches;
  if (all_active_ > 0) {
    --all_active_;
    active_ = candidates_;
    idle_.count = 0;
    touches = kernel::any_touches(columns, false, active_.count * lanes);
  } else {
    const kernel::Sorted sorted = kernel::sort_groups(columns, candidates_.groups(), active_.first.data(), idle_.first.data());
    active_.count = sorted.active;
    idle_.count = sorted.idle;
    touches = sorted.touches;
  }
  for (std::size_t k = 0; k < active_.count; ++k) last_active_[active_.first[k] / lanes] = steps_;
  return touches;
}

void ActiveSet::end_step(const ContactPoints& contacts, const kernel::Columns& columns) {
  selected_.count = 0;
  for (std::size_t k = 0; k < idle_.count; ++k) {
    const std::size_t first = idle_.first[k], end = std::min(count_, first + lanes);
    const double room = clearance(columns, first);
    if (!(room > least_sleep * step_travel_ + slack)) continue;
    bool outside = true;
    for (std::size_t i = first; i < end && outside; ++i) {
      outside = contacts.is_outside(pose_ * columns.tip.at(i));
    }
    if (!outside) continue;
    wakes_at_[first / lanes] = travel_ + room;
    selected_.add(first);
  }
  if (selected_.count == 0) return;
  kernel::reset_idle(columns, selected_.groups());
  list_candidates();
}

kernel::Groups ActiveSet::active_since(std::uint64_t since, const ContactPoints& contacts, const kernel::Columns& columns) {
  listed_.count = selected_.count = 0;
  for (std::size_t g = 0; g < last_active_.size(); ++g) {
    if (last_active_[g] <= since) continue;
    listed_.add(g * lanes);
    if (sleeps(g)) selected_.add(g * lanes);
  }
  update(contacts, columns);
  return listed_.groups();
}

void ActiveSet::update_all(const ContactPoints& contacts, const kernel::Columns& columns) {
  selected_.count = 0;
  for (std::size_t g = 0; g < wakes_at_.size(); ++g) {
    if (sleeps(g)) selected_.add(g * lanes);
  }
  update(contacts, columns);
}

void ActiveSet::update_element(std::size_t i, const ContactPoints& contacts, const kernel::Columns& columns) {
  selected_.count = 0;
  if (sleeps(i / lanes)) selected_.add(i / lanes * lanes);
  update(contacts, columns);
}

// Computes contact points and gaps in the last step for the selected groups, which sleep.
void ActiveSet::update(const ContactPoints& contacts, const kernel::Columns& columns) {
  if (selected_.count == 0) return;
  contacts.find(columns, pose_, selected_.groups());
  kernel::reset_idle(columns, selected_.groups());
}

void ActiveSet::list_candidates() {
  candidates_.count = 0;
  next_wake_ = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < wakes_at_.size(); ++g) {
    if (sleeps(g)) {
      next_wake_ = std::min(next_wake_, wakes_at_[g]);
    } else {
      candidates_.add(g * lanes);
    }
  }
}

// Wakes groups that may touch after the travel of this step. `pose_` is still that of the last
// step.
void ActiveSet::wake(const ContactPoints& contacts, const kernel::Columns& columns) {
  const double before = travel_;
  // A small step loses the rounding error of the sum when it is added to a long travel.
  travel_ += step_travel_ + std::numeric_limits<double>::epsilon() * travel_;
  if (travel_ < next_wake_) return;
  selected_.count = 0;
  for (std::size_t g = 0; g < wakes_at_.size(); ++g) {
    if (sleeps(g) && wakes_at_[g] <= travel_) selected_.add(g * lanes);
  }
  // The last step is written to the columns of "before". reset_idle() makes those of "now" equal,
  // and this step overwrites them.
  kernel::Columns then = columns;
  then.swap_before();
  std::swap(then.faces, then.faces_before);
  update(contacts, then);
  for (std::size_t k = 0; k < selected_.count; ++k) {
    const std::size_t first = selected_.first[k];
    const double* const gaps = columns.before.gap + first;
    const double wakes_at = before + *std::min_element(gaps, gaps + std::min(lanes, count_ - first)) - slack;
    wakes_at_[first / lanes] = wakes_at > travel_ ? wakes_at : awake;
  }
  list_candidates();
}

// Returns how far the tips of a group must travel at least before one touches [m]; 0: unknown.
// `first`: the group's first element.
double ActiveSet::clearance(const kernel::Columns& columns, std::size_t first) const {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t end = std::min(count_, first + lanes);
  for (std::size_t i = first; i < end; ++i) {
    if (columns.depth_offset[i] != 0.0) return 0.0;
    least = std::min(least, columns.gap[i]);
  }
  return least - slack;
}

}  // namespace slipbench
