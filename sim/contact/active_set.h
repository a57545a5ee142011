// The active set of a field: few of the many elements on a body touch; most are far from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/api/pad_layout.h"
#include "sim/contact/contact_points.h"
#include "sim/contact/kernel.h"
#include "sim/core/pose.h"

namespace slipbench {

// Groups of elements (kernel::lanes) are in one of three states:
// - active: an element touches, or has touched in one of the last two steps: both columns of each
//   pair now/before must be overwritten without contact. Springs, friction and labels are computed
//   for these groups only.
// - idle: no element touches, but one may touch in the next step. Only contact points and gaps are
//   computed.
// - asleep: a distance from the surface changes by no more than a tip moves, so a group with all
//   tips outside touches nothing until the pad has travelled as far as its smallest gap. Nothing is
//   computed.
// In groups that are not active every column is, up to the sign of a zero, as the dense passes
// would leave it; the contact points of a sleeping group are those of an earlier pose. A group that
// wakes is evaluated at the last step's pose too, since locating a touch needs it: no result
// depends on how long the group has slept.
//
// A step calls begin_step(), sort() and end_step(), in this order.
class ActiveSet {
 public:
  // Fields with at least this many elements keep an active set.
  static constexpr std::size_t least_elements = 64;

  explicit ActiveSet(const PadLayout& layout);

  // Call after now and before have been swapped. Computes the contact points of the groups that may
  // touch at `pose` and returns these groups.
  kernel::Groups begin_step(const ContactPoints& contacts, const kernel::Columns& columns, const Pose& pose);
  // Call when their gaps are final. Separates active from idle groups. Returns true if an element
  // touches that did not before.
  bool sort(const kernel::Columns& columns);
  // Puts groups to sleep that are far from touching.
  void end_step(const ContactPoints& contacts, const kernel::Columns& columns);

  // The active groups of the last step.
  [[nodiscard]] kernel::Groups active() const { return active_.groups(); }
  // True if element i does not sleep: its contact point is up to date.
  [[nodiscard]] bool is_awake(std::size_t i) const { return !sleeps(i / kernel::lanes); }
  // Number of steps begun.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  // Returns the groups that were active in a step after step number `since`, all up to date. The
  // list is valid until the next call.
  kernel::Groups active_since(std::uint64_t since, const ContactPoints& contacts, const kernel::Columns& columns);
  // Updates the contact points of all groups, or of element i's group, to the last step.
  void update_all(const ContactPoints& contacts, const kernel::Columns& columns);
  void update_element(std::size_t i, const ContactPoints& contacts, const kernel::Columns& columns);
  // The columns have been overwritten: keeps all groups active in the next two steps.
  void reset();

 private:
  // A list of groups, named by their first element, in order.
  struct List {
    std::vector<std::uint32_t> first;  // [groups], the first `count` are valid
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
  List candidates_;                         // all that are awake: active and idle
  List active_, idle_;                      // of the last step
  List listed_;                             // by active_since()
  List selected_;                           // for one extra pass
  std::vector<std::uint64_t> last_active_;  // [groups] last step in which the group was active
  // m, [groups] travel at which the group may touch, or awake
  std::vector<double> wakes_at_;
  double travel_ = 0.0;       // m, upper bound of a tip's travel since the start
  double step_travel_ = 0.0;  // m, in the last step
  double next_wake_ = 0.0;    // m, travel at which the first sleeping group may touch
  Pose pose_;                 // of the last step
  std::uint64_t steps_ = 0;
  // remaining steps in which all groups are active, as some columns are unknown
  int all_active_ = 2;
};

}  // namespace slipbench
