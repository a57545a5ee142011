// The active set of a field: of many elements on a body few touch, and most are far from touching.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/contact_points.h"
#include "sim/field/kernel.h"

namespace slipbench {

// Groups of elements (kernel::lanes) are in one of three states:
// - active: an element touches, or has touched in one of the two steps before, so that both columns of each pair now/before have been written
//   since by what touches nothing. Springs, friction and labels are worked out for these alone.
// - idle: no element has, but one may touch in the next step. Where they meet the surface is worked out, and nothing else.
// - asleep: a distance from the surface changes by no more than a tip moves. A group with all tips outside touches nothing until the pad has
//   travelled as far as its smallest gap. Nothing is worked out.
// Of groups that are not active every column is, to the sign of a zero, what the dense passes would leave; where a sleeping one meets the
// surface is that of an earlier pose. A group that wakes is evaluated at the pose of the step before too, since a touch is located by that:
// nothing depends on how long it has slept.
//
// A step calls begin_step(), sort() and end_step(), in this order.
class ActiveSet {
 public:
  // From so many elements on a field keeps an active set.
  static constexpr std::size_t least_elements = 64;

  explicit ActiveSet(const PadLayout& layout);

  // Once now and before have changed places: works out where the groups that may touch meet the surface at `pose`, and returns them.
  kernel::Groups begin_step(const ContactPoints& contacts, const kernel::Columns& columns, const Pose& pose);
  // Once their gaps are final: tells the active ones from the idle ones. Returns whether an element touches that did not before.
  bool sort(const kernel::Columns& columns);
  // Puts to sleep what is far from touching.
  void end_step(const ContactPoints& contacts, const kernel::Columns& columns);

  // The active groups of the last step.
  [[nodiscard]] kernel::Groups active() const { return active_.groups(); }
  // True if element i does not sleep: where it meets the surface is up to date.
  [[nodiscard]] bool is_awake(std::size_t i) const { return !sleeps(i / kernel::lanes); }
  // How many steps have begun.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  // The groups that have been active in a step after the first `since`, all up to date. The list holds until the next call.
  kernel::Groups active_since(std::uint64_t since, const ContactPoints& contacts, const kernel::Columns& columns);
  // Brings up to date where all groups, or that of element i, met the surface in the last step.
  void update_all(const ContactPoints& contacts, const kernel::Columns& columns);
  void update_element(std::size_t i, const ContactPoints& contacts, const kernel::Columns& columns);
  // The columns have been overwritten: in the next two steps all groups are active.
  void reset();

 private:
  // Some groups, named by their first element, in order.
  struct List {
    std::vector<std::uint32_t> first;  // [groups], of which `count` hold
    std::size_t count = 0;
    void add(std::size_t element) { first[count++] = static_cast<std::uint32_t>(element); }
    [[nodiscard]] kernel::Groups groups() const { return {first.data(), count}; }
  };
  static constexpr double awake = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool sleeps(std::size_t group) const { return wakes_at_[group] > awake; }
  void list_candidates();
  void wake(const ContactPoints& contacts, const kernel::Columns& columns);
  void update(const ContactPoints& contacts, const kernel::Columns& columns);
  [[nodiscard]] double clearance(const kernel::Columns& columns, std::size_t first) const;

  std::size_t count_;                       // of elements
  double reach_ = 0.0;                      // m, of the farthest tip from the pad's origin
  List candidates_;                         // all that do not sleep: active and idle ones
  List active_, idle_;                      // of the last step
  List listed_;                             // by active_since()
  List selected_;                           // for one pass out of turn
  std::vector<std::uint64_t> last_active_;  // of each group: the last step in which it was active
  std::vector<double> wakes_at_;            // m, of each group: the travel at which it may touch, or awake
  double travel_ = 0.0;                     // m, the farthest that a tip may have come since the start
  double step_travel_ = 0.0;                // m, in the last step
  double next_wake_ = 0.0;                  // m, the travel at which the first sleeping group may touch
  Pose pose_;                               // of the last step
  std::uint64_t steps_ = 0;
  int all_active_ = 2;  // steps in which all groups are active, since the columns of some hold what is not known
};

}  // namespace slipbench
