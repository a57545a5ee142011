// One trial in memory, column by column, as in a dataset under /data/demo_<k>.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/api/contact_frame.h"
#include "tools/dataset/record/sample_timing.h"
#include "tools/statistics/confusion.h"

namespace slipbench {

// One channel of a sensor: T rows of `shape` values each, in C order.
struct SensorColumn {
  std::string name;  // "force"
  std::string unit;  // "N"
  std::vector<std::size_t> shape;
  std::vector<float> values;  // [T, shape...]
  std::optional<std::vector<double>> time =
      {};  // [T] s, of a channel with its own time stamps (Channel); empty: the sensor's samples

  [[nodiscard]] std::size_t row_size() const;  // values of a row
};

// The truth about one pad's contact at its sensor's samples: L = T samples of N units. Meanings as
// in ContactFrame.
struct LabelRecord {
  std::vector<std::uint8_t> unit_state;   // [L,N] UnitState
  std::vector<float> slip_velocity;       // [L,N,2] m/s
  std::vector<float> slip_distance;       // [L,N] m
  std::vector<float> margin;              // [L,N], NaN while detached
  std::vector<float> force;               // [L,N,3] N
  std::vector<std::uint8_t> state;        // [L] PadState, rule strict
  std::vector<std::uint8_t> state_micro;  // [L] PadState, rule micro
  std::vector<std::uint8_t> state_paper;  // [L] PadState, the rule of the sensor's paper
  std::vector<float> stuck_fraction;      // [L], NaN while nothing touches
  std::vector<float> slip_direction;      // [L] rad, NaN while nothing slips or the slip has no translation
  std::vector<float> slip_centre;         // [L,2] m, NaN while the slip has no rotation
  std::vector<float> slip_angle;          // [L] rad, accumulated
  std::vector<double> event_time;         // [E] s, resolved inside the step
  std::vector<std::uint32_t> event_unit;  // [E]
  std::vector<std::uint8_t> event_kind;   // [E] EventKind
  std::vector<double> unit_positions;     // [N,2] m, mean of the tips of a unit's elements, in the pad plane
  std::vector<double> unit_heights;       // [N] m, the same mean along the pad's normal: z of the pad frame
  std::vector<double> k_normal;           // [N] N/m
  std::vector<double> k_tangential;       // [N] N/m
  std::vector<double> mu_static;          // [N]
  std::vector<double> mu_kinetic;         // [N]
  std::vector<double> onset_time;         // [N] s, first event slip; NaN: never
  std::vector<double> micro_onset_time;   // [N] s, first event micro or slip; NaN: never

  bool truth = true;      // false: an imported recording, which has state_paper alone, or no column
  std::string rule = {};  // without truth: definition of state_paper, as a sentence

  StateCounts state_count{};        // samples in each PadState by `state`; set in every recording mode
  StateCounts state_micro_count{};  // likewise by `state_micro`

  [[nodiscard]] std::size_t units() const { return k_normal.size(); }
};

// Output of one sensor, with the truth.
struct SensorRecord {
  std::string name;                        // as in the scene: "pad"
  std::string type;                        // "papillarray"
  double rate = 0.0;                       // Hz
  std::string frame;                       // sentence that defines the axes
  std::vector<std::string> channel_names;  // of all channels, in order
  std::vector<double> time;                // [T] s
  std::vector<SensorColumn> channels;
  LabelRecord labels;
  std::string follows = {};  // name in the scene of the pad whose contact it reads and which carries its load; empty: its own
  std::optional<SampleTiming> timing = {};  // of an imported recording's stamps in its source; empty: none

  // Times [s] of the rows of one of its channels.
  [[nodiscard]] const std::vector<double>& times_of(const SensorColumn& channel) const {
    return channel.time ? *channel.time : time;
  }
};

// Throws InputError with mean rate, median rate and longest step if the samples of a recorded
// sensor are not evenly_spaced().
void check_evenly_spaced(const SensorRecord& sensor);

// The gripper in the loop, one row per sample of ControlRecord; all empty if the scene is not a
// grasp.
struct GripRecord {
  std::vector<std::uint8_t> command;  // [T,3] registers written last: position, speed, force; before the first write the
                                      // position at which the fingers stand
  std::vector<std::uint8_t> measured_position;  // [T] counts, of the latest read
  std::vector<float> grip_force;                // [T] N, true: mean of both pads' normal forces
  std::vector<float> arm;                       // [T,2] m/s, written last: sideways, up; empty where the motion is prescribed
};

// State of the control loop at the samples of the sensor that it reads.
struct ControlRecord {
  std::string detector;      // "force_ratio"; empty: no detector
  std::string controller;    // "step_on_slip"; empty: no controller
  std::string sensor;        // name in the scene of the sensor that the detector, else the controller reads: "pad"
  double rate = 0.0;         // Hz, of the samples
  std::vector<double> time;  // [T] s
  std::vector<std::uint8_t> detector_class;  // [T] PadState, of the latest estimate available at that time
  GripRecord grip;

  Confusion confusion{};  // set in every recording mode
};

// A body's motion in the world frame, at TrialRecord::body_time.
struct BodyRecord {
  std::string name;
  std::vector<float> pose;        // [T,7] m, then quaternion w x y z; the quaternion's sign is continuous in time
  std::vector<float> velocity;    // [T,6] m/s of the body frame's origin, then rad/s
  std::vector<double> size = {};  // [3] m, its extent along its own axes; empty: unknown
};

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
  // force (Answers: constant_force, hold_preset, force_pid, timed_grip, and step_on_slip while its
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
// The first alarm decides, as the stopping time does in sequential change detection (A. N.
// Shiryaev, Theory Probab. Appl. 8, 1963; G. Lorden, Ann. Math. Stat. 42, 1971), where the delay is
// that of the runs without an alarm before the change. So a detector that alarms before the slip
// has no delay in that trial, even if the alarm is withdrawn and comes again after the slip began:
// a loop has acted on the first one, and an alarm that comes and goes would hit any slip at once.
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

struct TrialRecord {
  std::size_t trial = 0;      // k of demo_<k>
  std::uint64_t seed = 0;     // of the dataset; the trial's draws are keyed by (seed, trial)
  std::string material;       // group by which /mask splits the trials; the material unless the scene's `split` says otherwise
  std::string params = "{}";  // JSON object: path -> value of what was swept
  std::string model_sha256 = {};  // of the scene's model file, 64 hexadecimal digits; empty: no such file
  // "MuJoCo, FFTW": third-party libraries that computed in it, whose last digits depend on the
  // processor. Empty: none, and the trial is bit-identical on every processor.
  std::string libraries = {};
  TrialOutcome outcome;
  std::vector<SensorRecord> sensors;  // empty, as are the bodies, if only the outcome was recorded
  std::vector<double> body_time;      // [T] s, samples of the fastest sensor with its own pad; imported: of the first sensor
  std::vector<BodyRecord> bodies;
  std::optional<ControlRecord> control;  // empty: no detector and no controller

  // Number of samples in `body_time`.
  [[nodiscard]] std::size_t num_samples() const { return body_time.size(); }
  // Throws InputError, naming the trial, if there is no body of that name.
  [[nodiscard]] const BodyRecord& body(std::string_view called) const;
};

}  // namespace slipbench
