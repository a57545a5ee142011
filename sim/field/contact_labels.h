// From elements to units: the truth about one pad, as sensors read it and datasets keep it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/field/field.h"
#include "sim/field/unit_rules.h"

namespace slipbench {

// Sums a pad's elements into units and tells what each unit and the pad do (contact_frame.h). Unit states are those of the model's
// elements; nothing is thresholded. The translation, centre and angle of the slip are the rigid motion that fits the slipping units'
// velocities best (least squares, equal weights).
// A pad has one field for each surface that it may touch, all of the same layout. Forces, deflections, slip and counts of friction points
// are sums over them; the contact plane and the margin of a unit are those on the surface where its normal force is greatest.
class ContactLabels {
 public:
  explicit ContactLabels(const PadLayout& layout);

  // Reads the fields after a step of `dt` that ended at `time` [s]. Must be called once after every step.
  const ContactFrame& update(std::span<Field> fields, double time, double dt);
  // update() in three parts, for labels that not everybody reads and a step that may not last. judge() finds the states, and leaves events and
  // slip_angle as they were; fill(), until the next step, finds of the rest what it is asked for; settle(), once the step stands, adds what the step
  // judged last has done to events and angle.
  void judge(std::span<Field> fields, double time, double dt);
  const ContactFrame& fill(std::span<Field> fields, FramePart part);
  void settle(std::span<const Field> fields, double dt);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }
  // Before judge(), on a stage: where it stands in the world [m], and the normal force of its vibration on each unit [N].
  void ride(const Eigen::Array3d& stage_position, double shaking) {
    frame_.stage_position = stage_position;
    shaking_ = shaking;
  }
  // From here on slip_angle is not added up: labels then cost what is read of them. Else a slipping pad's are worked out at every step.
  void leave_slip_angle() { keeps_angle_ = false; }
  // All that the labels carry from one step to the next beside the fields' state is frame().slip_angle [rad].
  void set_slip_angle(double angle) { frame_.slip_angle = angle; }

 private:
  void count_units(std::span<Field> fields);
  void label_units(std::span<Field> fields, FramePart part);
  void feel(std::span<const Field> fields, std::size_t vectors);
  void label_elements(std::span<const Field> fields);
  kernel::UnitColumns elements_as_units(const Field& field);
  template <class Visit>
  void for_each_in(const kernel::Groups& groups, Visit&& visit) const;
  kernel::UnitColumns sum_fields(std::span<Field> fields);
  void sum_viewed(Field& field);
  void sum_elements(const Field& field, std::size_t begin, std::size_t end_unit, Eigen::ArrayXXd& sums) const;
  [[nodiscard]] unit_rules::Count count_before(std::span<const Field> fields, std::uint32_t unit) const;

  std::vector<UnitRange> units_;
  std::vector<double> shares_;  // 1/elements of the unit
  std::vector<std::uint32_t> unit_of_element_;
  bool single_ = false;                    // every unit is one element
  std::size_t felt_;                       // of force and displacement, how many are read
  bool keeps_angle_ = true;                // leave_slip_angle() has not been called
  double shaking_ = 0.0, rate_ = 0.0;      // N, ride(); 1/s, of the step judged last
  bool shaken_ = false;                    // all forces have been added to
  FramePart filled_ = FramePart::all;      // of the frame
  Eigen::ArrayXXd sums_;                   // [N, columns] units of several elements, or on several surfaces
  Eigen::ArrayXXd on_one_;                 // the same on one of several surfaces
  std::vector<const Field*> most_loaded_;  // [N] of several fields: the one with the greatest normal force on the unit
  Eigen::Array3Xd undeformed_;             // [3,N] m, mean of a unit's undeformed tips in P
  std::vector<unit_rules::Count>
      counts_;                 // [N] of the step judged last, where units are of several elements or on several surfaces
  std::uint64_t counted_ = 0;  // changes() of all fields then
  std::array<std::vector<std::uint64_t>, 2> seen_;  // of each field: its steps() when what is felt, and all, were read last
  kernel::Groups viewed_{};                         // what has been read of the last field in this step
  std::vector<unit_rules::UnitEvent> changes_;
  unit_rules::ContactPlane contact_plane_;
  unit_rules::Count elements_;  // of the whole pad
  double slip_rate_ = 0.0;      // rad/s, rotation of the slip in the step judged last
  ContactFrame frame_;
};

}  // namespace slipbench
