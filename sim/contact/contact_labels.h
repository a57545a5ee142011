// From elements to units: the truth about one pad, as sensors read it and datasets store it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/contact/field.h"
#include "sim/contact/label_kernel.h"
#include "sim/contact/unit_rules.h"

namespace slipbench {

// Sums a pad's elements into units and determines the states of units and pad (contact_frame.h).
// Unit states are those of the model's elements; nothing is thresholded. The translation, centre
// and angle of the slip are those of the rigid motion that best fits the slipping units' velocities
// (least squares, equal weights).
//
// A pad has one field for each surface that it may touch, all with the same layout. Forces,
// deflections, slip and counts of friction points are sums over the fields; a unit's contact plane
// and margin are those on the surface with its greatest normal force.
class ContactLabels {
 public:
  explicit ContactLabels(const PadLayout& layout);

  // Reads the fields after a step of `dt` that ended at `time` [s]. Must be called once after every
  // step.
  const ContactFrame& update(std::span<Field> fields, double time, double dt);
  // The three parts of update(), for labels that are not always read and for steps that may be
  // undone. judge() determines the states and leaves events and slip_angle unchanged. fill()
  // computes `part` of the other values, which are valid until the next step. settle(), called once
  // when the step is final, adds the last judged step to the events and the angle.
  void judge(std::span<Field> fields, double time, double dt);
  const ContactFrame& fill(std::span<Field> fields, FramePart part);
  void settle(std::span<const Field> fields, double dt);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }
  // Sets, before judge(), the stage's position in the world [m] and the normal force of its
  // vibration on each unit [N].
  void ride(const Eigen::Array3d& stage_position, double shaking) {
    frame_.stage_position = stage_position;
    shaking_ = shaking;
  }
  // Stops the accumulation of slip_angle, so that labels are computed only when they are read. If
  // slip_angle is accumulated, the labels of a slipping pad are computed at every step.
  void disable_slip_angle() { keeps_angle_ = false; }
  // frame().slip_angle [rad] is the only label state besides the fields' that is carried from one
  // step to the next.
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
  bool single_ = false;      // every unit is one element
  std::size_t felt_;         // number of values that are read: none, force, force and displacement
  bool keeps_angle_ = true;  // false after disable_slip_angle()
  // N, ride(); 1/s, of the last judged step
  double shaking_ = 0.0, rate_ = 0.0;
  bool shaken_ = false;  // true if frame_.force contains shaking_
  // valid part of the frame
  FramePart filled_ = FramePart::all;
  Eigen::ArrayXXd sums_;    // [N, columns] units of several elements, or on several surfaces
  Eigen::ArrayXXd on_one_;  // the same on a single surface
  // [N] with several fields: the one with the greatest normal force on the unit
  std::vector<const Field*> most_loaded_;
  Eigen::Array3Xd undeformed_;  // [3,N] m, mean of a unit's undeformed tips in P
  // [N] of the last judged step, for units of several elements or on several surfaces
  std::vector<unit_rules::Count> counts_;
  std::uint64_t counted_ = 0;  // sum of all fields' changes() at that time
  // [fields] steps() when the felt part, and when all, was last read
  std::array<std::vector<std::uint64_t>, 2> seen_;
  kernel::Groups viewed_{};  // groups read of the last field in this step
  std::vector<unit_rules::UnitEvent> changes_;
  unit_rules::ContactPlane contact_plane_;
  double settled_ = -std::numeric_limits<double>::infinity();  // s, end of the last settled step
  unit_rules::Count elements_;                                 // counts of the whole pad
  double slip_rate_ = 0.0;                                     // rad/s, rotation of the slip in the last judged step
  ContactFrame frame_;
};

}  // namespace slipbench
