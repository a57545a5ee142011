// From elements to units and pads: the rules that turn states of friction points into a
// ContactFrame, for any contact model.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/contact/field.h"

namespace slipbench::unit_rules {

// Number of elements of a unit, or units of a pad, that touch, and of those that slip.
struct Count {
  std::uint32_t touching = 0;
  std::uint32_t slipping = 0;

  void add(ElementState state) {
    touching += state != ElementState::detached ? 1U : 0U;
    slipping += state == ElementState::slip ? 1U : 0U;
  }
  void remove(ElementState state) {
    touching -= state != ElementState::detached ? 1U : 0U;
    slipping -= state == ElementState::slip ? 1U : 0U;
  }
};

// A unit slips if all of its touching elements do.
inline UnitState unit_state(const Count& elements) {
  if (elements.touching == 0) return UnitState::detached;
  if (elements.slipping == 0) return UnitState::stick;
  return elements.slipping == elements.touching ? UnitState::slip : UnitState::partial;
}

// The shortest rotation that brings a surface's normal onto +Z: from the pad frame into the contact
// plane.
class ContactPlane {
 public:
  // `normal`: unit vector. Recomputes the rotation only if the normal has changed.
  void face(const Eigen::Vector3d& normal);
  // The rotation's matrix; null if it is the identity.
  [[nodiscard]] const Eigen::Matrix3d* turn() const { return level_ ? nullptr : &turn_; }
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& v) const { return level_ ? v : turn_ * v; }
  [[nodiscard]] Eigen::Vector3d turned_back(const Eigen::Vector3d& v) const { return level_ ? v : turn_.transpose() * v; }

 private:
  Eigen::Vector3d normal_ = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  bool level_ = true;
};

// Sets the pad's state by both rules from the units', and the stuck fraction from the count of all
// its elements. For a pad with a single unit the strict rule equals the micro rule: there are no
// units to distinguish, and its elements, which stick and slip alternately, hardly ever slip all at
// once.
void judge_pad(ContactFrame& frame, const Count& elements);
// The same if every unit is one element.
void judge_pad_of_elements(ContactFrame& frame, const Count& elements);

// Sets slip_direction and slip_centre from the rigid motion that best fits the slipping units'
// velocities (least squares, equal weights), and returns the rate of its rotation [rad/s]. Each is
// NaN if the fit has no translation or no rotation. `undeformed`: [3,N] m, mean of each unit's
// undeformed tips in P. `plane`: that in which all units slip; a level one if each unit has its
// own.
double fit_slip_motion(ContactFrame& frame, const Eigen::Array3Xd& undeformed, const ContactPlane& plane);

// An element's change and its unit.
struct UnitEvent {
  ElementEvent event;
  std::uint32_t unit;
};

// Sorts stably. Calls std::stable_sort, which allocates memory, only if the range is not sorted
// yet.
template <class Iterator, class Before>
void sort_stably(Iterator first, Iterator last, const Before& before) {
  if (!std::is_sorted(first, last, before)) std::stable_sort(first, last, before);
}

// Replays the element changes of a step of `dt` that ended at `time` [s] in order of time and
// appends their effects on the units to `report`, in order of time (contact_frame.h). Sorts
// `changes` in place; `count_before(unit)` returns a unit's Count before the step. `begun`: end of
// the step before [s]. If time - dt differs from it by rounding, no event is earlier than `begun`.
template <class CountBefore>
void report_unit_events(std::vector<UnitEvent>& changes, CountBefore&& count_before, double begun, double time, double dt,
                        std::vector<ContactEvent>& report) {
  // Events of one unit closer than this share of a step are simultaneous: bristles of one tip touch
  // at once, up to rounding.
  constexpr double together = 1e-9;
  constexpr double rounding = 1e-6;  // of times, as a share of a step
  const double start = std::abs(time - dt - begun) <= rounding * dt ? begun : time - dt;
  sort_stably(changes.begin(), changes.end(), [](const UnitEvent& a, const UnitEvent& b) {
    return a.unit != b.unit ? a.unit < b.unit : a.event.fraction < b.event.fraction;
  });
  const std::size_t reported = report.size();
  Count now;
  for (std::size_t k = 0; k < changes.size();) {
    const std::uint32_t unit = changes[k].unit;
    const double fraction = changes[k].event.fraction;
    if (k == 0 || changes[k - 1].unit != unit) now = count_before(unit);
    const Count before = now;
    for (; k < changes.size() && changes[k].unit == unit && changes[k].event.fraction <= fraction + together; ++k) {
      now.remove(changes[k].event.from);
      now.add(changes[k].event.to);
    }
    const double instant = std::max(start, time - (1.0 - fraction) * dt);
    const auto report_event = [&](EventKind kind) { report.push_back({instant, unit, kind}); };
    const bool slipped = before.touching > 0 && before.slipping == before.touching;
    const bool slips = now.touching > 0 && now.slipping == now.touching;
    if (before.touching == 0 && now.touching > 0) report_event(EventKind::touch);
    if (now.slipping > 0 && before.slipping == 0) report_event(EventKind::micro);
    if (now.slipping > 0 && slipped && !slips) report_event(EventKind::part_sticks);
    if (slips && !slipped) report_event(EventKind::slip);
    if (before.slipping > 0 && now.slipping == 0 && now.touching > 0) report_event(EventKind::stick);
    if (before.touching > 0 && now.touching == 0) report_event(EventKind::detach);
  }
  sort_stably(report.begin() + static_cast<std::ptrdiff_t>(reported), report.end(),
              [](const ContactEvent& a, const ContactEvent& b) { return a.time < b.time; });
}

}  // namespace slipbench::unit_rules
