// The outcome of a trial: slip, the detector's result, and whether a body is held.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace slipbench {

// Final attitude of a box that a guided arm turned on its table.
struct TurnOutcome {
  double tilt = 0.0;        // rad, at the trial's end, between the box's own axis Y and the vertical
  double least_tilt = 0.0;  // rad, minimum over the trial
  bool standing = false;    // at the trial's end no pad touches it, the table carries it, and it is upright to 5 degrees
};

// Outcome of a grasp. NaN: did not happen, or does not apply.
struct GraspOutcome {
  bool dropped = false;                                         // lost after it was lifted
  double drop_time = std::numeric_limits<double>::quiet_NaN();  // s
  // True if the box left the table in the lift (GraspSimulation). Empty: the arm is guided, or the
  // trial is imported or of a version without this value.
  std::optional<bool> lifted = {};
  double lift_height =
      std::numeric_limits<double>::quiet_NaN();  // m, greatest height of the box's lowest corner above the table in the lift
  // Motion of the box in the arm's frame from the lift's beginning to the trial's end, compliance
  // of pads and fingers included; NaN: not held.
  double slip_translation = std::numeric_limits<double>::quiet_NaN();  // m, of its middle
  double slip_rotation = std::numeric_limits<double>::quiet_NaN();     // rad
  // True grip forces: mean of both pads' normal forces.
  double max_grip_force = 0.0;    // N, at any tick
  double final_grip_force = 0.0;  // N, at the last tick
  // N, m g/(2 mu_s) with mu_s upwards: the least force that can hold the box
  // (HeldBox::ideal_force()); NaN if no force can.
  double ideal_grip_force = std::numeric_limits<double>::quiet_NaN();
  // s, from the first tick of the lift at which a unit of the sensor's pad truly slips until a
  // command that follows from a later read, and closes further, begins to act. NaN: no such command
  // before the drop, the detector is Detection::early, or the controller closes only to hold a
  // force (Answers: constant_force, hold_preset, timed_grip, and step_on_slip while its
  // detector gives no answer).
  double reaction_time = std::numeric_limits<double>::quiet_NaN();
  std::optional<TurnOutcome> turn = {};  // empty: the arm's motion is prescribed

  // Exactly one of dropped, held() and not_lifted() is true.
  [[nodiscard]] bool held() const { return !dropped && lifted.value_or(true); }
  [[nodiscard]] bool not_lifted() const { return !dropped && !lifted.value_or(true); }
};

// Outcome of a scene's `hold`: whether the body is held at the trial's end.
struct HoldOutcome {
  bool held = false;
  double from = 0.0;   // s, hold.from
  double moved = 0.0;  // m, displacement of the body's origin relative to its holder, from `from` to the end
};

// Result of a detector in a trial. An alarm is a tick at which the loop sees incipient or gross.
// The first alarm decides, as the stopping time does in sequential change detection
// ([shiryaev1963], [lorden1971]), where the delay is that of the runs without an alarm before the
// change. So a detector that alarms before the slip has no delay in that trial, even if the alarm
// is withdrawn and comes again after the slip began: a loop has acted on the first one, and an
// alarm that comes and goes would hit any slip at once.
enum class Detection : std::uint8_t {
  quiet,        // no slip, no alarm
  false_alarm,  // no slip, an alarm
  early,        // an alarm before the slip
  seen,         // the first alarm comes after slip began: the only case with a delay
  missed,       // slip, no alarm
};

// "quiet", "false_alarm", "early", "seen", "missed"
std::string_view detection_word(Detection detection);

// Outcome of a trial. NaN: did not happen. With several sensors the earliest time and the largest
// distance count, except for sensors that follow another's pad.
struct TrialOutcome {
  double touch_time = std::numeric_limits<double>::quiet_NaN();             // s
  double first_micro_slip_time = std::numeric_limits<double>::quiet_NaN();  // s, a first part of a unit slips
  double first_slip_time = std::numeric_limits<double>::quiet_NaN();        // s, a first unit slips as a whole
  double gross_slip_time = std::numeric_limits<double>::quiet_NaN();        // s, all touching units slip
  double max_slip_distance = 0.0;                                           // m, of any unit; NaN: imported

  // Result of the detector. Slip is that of the sensor that it reads, by the rule strict: it begins
  // when a first unit slips as a whole. In a grasp it is the first slip of the lift, and nothing
  // counts after a drop. Alarms count from the trial's beginning. Slip caused by closing fingers is
  // not a false alarm, so in a grasp whose sensor slips before the lift no alarm counts from that
  // slip to the lift.
  double false_alarm_time = std::numeric_limits<double>::quiet_NaN();  // s, first alarm before slip
  double detection_time = std::numeric_limits<double>::quiet_NaN();    // s, first alarm after slip began
  double detection_delay =
      std::numeric_limits<double>::quiet_NaN();  // s, from the start of slip to detection_time; Detection::seen only
  double judged_slip_time = std::numeric_limits<double>::quiet_NaN();  // s, start of slip
  std::optional<Detection> detection = {};                             // empty: the scene has no detector

  std::optional<GraspOutcome> grasp;  // empty: not a grasp
  std::optional<HoldOutcome> hold;    // empty: no `hold` in the scene

  // Number of samples with a value beyond the sensor's range (Sensor::saturated), by sensor.
  // Sensors without such samples are absent.
  std::map<std::string, std::uint64_t> saturated;
};

// The JSON object of a demo's attribute `outcome`:
// - always: touch_time_s, first_micro_slip_time_s, first_slip_time_s, gross_slip_time_s,
//   max_slip_distance_m, false_alarm_time_s, detection_time_s, detection_delay_s
// - with a detector: judged_slip_time_s, detection (a detection_word())
// - of a grasp, null without one: dropped, lifted, drop_time_s, lift_height_m, slip_translation_m,
//   slip_rotation_rad, max_grip_force_N, final_grip_force_N, ideal_grip_force_N, reaction_time_s
// - with a guided arm: tilt_rad, least_tilt_rad, standing
// - with `hold` in the scene: held, hold_from_s, moved_m
// - if values were beyond a sensor's range: saturated_samples, an object {sensor: samples}.
std::string outcome_json(const TrialOutcome& outcome);
// Inverse of outcome_json(). Datasets of versions without detectors lack the detector's keys.
// Throws InputError if `text` is not such an object.
TrialOutcome parse_outcome(const std::string& text);

// Sets `detection` from `false_alarm_time`, `detection_time` and `slips`: whether there is slip to
// judge by. For Detection::early it clears the delay, and the reaction time of a grasp, whose loop
// closed because of the alarm and not of the slip.
void settle_detection(TrialOutcome& outcome, bool slips);

}  // namespace slipbench
