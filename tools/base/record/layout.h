// Which arrays and attributes a trial has in the file: the one list that the writing and the reading side share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/trial_record.h"

namespace slipbench {

using Extents = std::vector<std::size_t>;

// Attribute `frame` of a sensor's labels.
inline constexpr const char* label_frame_text =
    "contact plane: the pad frame P turned the shortest way until its z is the surface's normal; x and y are tangential, z is normal, compression is positive; forces act on the pad; positions, heights and slip_centre are in the pad frame P itself";

// Attribute `codes` of an array of labels, events or the control loop whose numbers stand for something: a JSON object, word to
// number. Empty for the others.
inline std::string_view codes_of(std::string_view array) {
  if (array == "unit_state") return R"({"detached":0,"stick":1,"slip":2,"partial":3})";
  if (array == "events/kind") return R"({"touch":0,"slip":1,"stick":2,"detach":3,"micro":4,"part_sticks":5})";
  if (array == "state" || array == "state_micro" || array == "state_paper" || array == "detector_class") {
    return R"({"no_contact":0,"non_slip":1,"incipient":2,"gross":3})";
  }
  return {};
}

// Calls visit(name, unit, extents after the first axis, column) for every label that has a row a sample. `units`: N. Labels without
// truth have state_paper alone, and no event and no attribute of units.
template <class Labels, class Visit>
void for_each_label(Labels& labels, std::size_t units, Visit&& visit) {
  if (!labels.truth) {
    visit("state_paper", "1", Extents{}, labels.state_paper);
    return;
  }
  visit("unit_state", "1", Extents{units}, labels.unit_state);
  visit("slip_velocity", "m/s", Extents{units, 2}, labels.slip_velocity);
  visit("slip_distance", "m", Extents{units}, labels.slip_distance);
  visit("margin", "1", Extents{units}, labels.margin);
  visit("force", "N", Extents{units, 3}, labels.force);
  visit("state", "1", Extents{}, labels.state);
  visit("state_micro", "1", Extents{}, labels.state_micro);
  visit("state_paper", "1", Extents{}, labels.state_paper);
  visit("stuck_fraction", "1", Extents{}, labels.stuck_fraction);
  visit("slip_direction", "rad", Extents{}, labels.slip_direction);
  visit("slip_centre", "m", Extents{2}, labels.slip_centre);
  visit("slip_angle", "rad", Extents{}, labels.slip_angle);
}

// The same for the columns of the events, which have a row an event.
template <class Labels, class Visit>
void for_each_event_column(Labels& labels, Visit&& visit) {
  if (!labels.truth) return;
  visit("events/t", "s", Extents{}, labels.event_time);
  visit("events/unit", "1", Extents{}, labels.event_unit);
  visit("events/kind", "1", Extents{}, labels.event_kind);
}

// Calls visit(name, extents after the first axis, values) for every attribute of the labels, which have a row a unit.
template <class Labels, class Visit>
void for_each_unit_attribute(Labels& labels, Visit&& visit) {
  if (!labels.truth) return;
  visit("unit_positions", Extents{2}, labels.unit_positions);
  visit("unit_heights", Extents{}, labels.unit_heights);
  visit("k_normal", Extents{}, labels.k_normal);
  visit("k_tangential", Extents{}, labels.k_tangential);
  visit("mu_static", Extents{}, labels.mu_static);
  visit("mu_kinetic", Extents{}, labels.mu_kinetic);
  visit("onset_time_s", Extents{}, labels.onset_time);
  visit("micro_onset_time_s", Extents{}, labels.micro_onset_time);
}

// Calls visit(name, unit, extents after the first axis, column) for every array of a body.
template <class Body, class Visit>
void for_each_body_column(Body& body, Visit&& visit) {
  visit("pose", "m, quaternion wxyz", Extents{7}, body.pose);
  visit("velocity", "m/s, rad/s", Extents{6}, body.velocity);
}

// The same for every array of the control loop, which has a row a sample of the sensor that it reads.
template <class Control, class Visit>
void for_each_control_column(Control& control, Visit&& visit) {
  visit("detector_class", "1", Extents{}, control.detector_class);
}

// The same for those that only a grasp has.
template <class Grip, class Visit>
void for_each_grip_column(Grip& grip, Visit&& visit) {
  visit("command", "1", Extents{3}, grip.command);
  visit("measured_position", "1", Extents{}, grip.measured_position);
  visit("grip_force", "N", Extents{}, grip.grip_force);
}

// The same for what only a grasp with a guided arm has.
template <class Grip, class Visit>
void for_each_arm_column(Grip& grip, Visit&& visit) {
  visit("arm_speed", "m/s", Extents{2}, grip.arm);
}

// Whether a sensor has a group of labels: an imported recording whose set says nothing of slip has none.
inline bool has_labels(const LabelRecord& labels) { return labels.truth || !labels.state_paper.empty(); }

inline constexpr const char* control_group = "control";
inline std::string sensor_group(const std::string& sensor) { return "sensors/" + sensor; }
// Where the time of a channel stands that has one of its own.
inline std::string own_time_path(const std::string& channel) { return channel + "_t"; }
inline std::string label_group(const std::string& sensor) { return "labels/" + sensor; }
inline std::string body_group(const std::string& body) { return "truth/" + body; }

}  // namespace slipbench
