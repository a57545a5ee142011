// From elements to units and pads: the rules that turn states of friction points into a ContactFrame, whatever model they come
// from.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/field/field.h"

namespace slipbench::unit_rules {

// How many elements of a unit, or units of a pad, touch and how many of those slip.
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

// A unit slips when all of its touching elements do.
inline UnitState unit_state(const Count& elements) {
  if (elements.touching == 0) return UnitState::detached;
  if (elements.slipping == 0) return UnitState::stick;
  return elements.slipping == elements.touching ? UnitState::slip : UnitState::partial;
}

// The turn that brings a surface's normal onto +Z the shortest way: from the pad frame into the contact plane.
class ContactPlane {
 public:
  // `normal`: unit vector. The units of a pad that meet the same one share the turn, which is then not worked out again.
  void face(const Eigen::Vector3d& normal);
  // The turn's matrix, null where there is nothing to turn.
  [[nodiscard]] const Eigen::Matrix3d* turn() const { return level_ ? nullptr : &turn_; }
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& v) const { return level_ ? v : turn_ * v; }
  [[nodiscard]] Eigen::Vector3d turned_back(const Eigen::Vector3d& v) const { return level_ ? v : turn_.transpose() * v; }

 private:
  Eigen::Vector3d normal_ = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  bool level_ = true;
};

// Sets the pad's state by both rules from the units', and the stuck fraction from the count of all its elements. A pad of a single unit has
// no units that could be told apart: strict is micro there. Its elements stick and slip by turns, and hardly ever slip all at once.
void judge_pad(ContactFrame& frame, const Count& elements);
// The same where every unit is one element.
void judge_pad_of_elements(ContactFrame& frame, const Count& elements);

// Sets slip_direction and slip_centre from the rigid motion that fits the slipping units'
// velocities best (least squares, equal weights), and returns the rate of its rotation [rad/s].
// Each is NaN where the fit has no translation or no rotation. `undeformed`: [3,N] m, mean of each
// unit's undeformed tips in P. `plane`: that in which all units slip; a level one where each has
// its own.
double fit_slip_motion(ContactFrame& frame, const Eigen::Array3Xd& undeformed, const ContactPlane& plane);

// An element's change and the unit that it belongs to.
struct UnitEvent {
  ElementEvent event;
  std::uint32_t unit;
};

// Sorts, keeping the order of equals: std::stable_sort, which asks for memory, only where there is something to sort.
template <class Iterator, class Before>
void sort_stably(Iterator first, Iterator last, const Before& before) {
  if (!std::is_sorted(first, last, before)) std::stable_sort(first, last, before);
}

// Replays the element changes of a step of `dt` that ended at `time` [s] in order of time and appends to `report`, in order of
// time, what each does to its unit (contact_frame.h). `changes` is sorted in place; `count_before(unit)` gives a unit's Count
// before the step.
template <class CountBefore>
void report_unit_events(std::vector<UnitEvent>& changes, CountBefore&& count_before, double time, double dt,
                        std::vector<ContactEvent>& report) {
  // Events of one unit closer than this share of a step happen together: bristles of one tip touch at once, up to rounding.
  constexpr double together = 1e-9;
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
    const auto report_event = [&](EventKind kind) { report.push_back({time - (1.0 - fraction) * dt, unit, kind}); };
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
