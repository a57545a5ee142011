// One trial in memory, column by column, as it stands in a dataset under /data/demo_<k>.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/contact_frame.h"
#include "tools/base/record/sample_timing.h"
#include "tools/base/statistics/confusion.h"

namespace slipbench {

// One channel of a sensor: T rows of `shape` values each, in C order.
struct SensorColumn {
  std::string name;  // "force"
  std::string unit;  // "N"
  std::vector<std::size_t> shape;
  std::vector<float> values;  // [T, shape...]
  std::optional<std::vector<double>> time =
      {};  // [T] s, of a channel with a time of its own (Channel); empty: the sensor's samples

  [[nodiscard]] std::size_t row_size() const;  // values of a row
};

// The truth about one pad's contact, sampled with its sensor: L = T samples of N units. Meanings as in ContactFrame.
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

  bool truth = true;      // false: an imported recording; of all columns it has state_paper alone, or none
  std::string rule = {};  // without truth: what state_paper goes by, as a sentence

  StateCounts state_count{};        // samples in each PadState by `state`; there in every mode of recording
  StateCounts state_micro_count{};  // likewise by `state_micro`

  [[nodiscard]] std::size_t units() const { return k_normal.size(); }
};

// What one sensor emitted, and the truth beside it.
struct SensorRecord {
  std::string name;                        // the scene's: "pad"
  std::string type;                        // "papillarray"
  double rate = 0.0;                       // Hz
  std::string frame;                       // a sentence that says what the axes are
  std::vector<std::string> channel_names;  // of all channels, in order
  std::vector<double> time;                // [T] s
  std::vector<SensorColumn> channels;
  LabelRecord labels;
  std::string follows = {};  // the pad whose contact it reads and which carries, as the scene names it; empty: it has its own
  std::optional<SampleTiming> timing =
      {};  // of the stamps of an imported recording, as its source has them; empty: there are none

  // Of the rows of one of its channels.
  [[nodiscard]] const std::vector<double>& times_of(const SensorColumn& channel) const {
    return channel.time ? *channel.time : time;
  }
};

// Throws InputError with mean rate, median rate and longest step for a recorded sensor whose samples are not evenly_spaced().
void check_evenly_spaced(const SensorRecord& sensor);

// The gripper in the loop, a row a sample of ControlRecord; all empty in a scene that is no grasp.
struct GripRecord {
  std::vector<std::uint8_t> command;  // [T,3] registers written last: position, speed, force; before the first write the
                                      // position at which the fingers stand
  std::vector<std::uint8_t> measured_position;  // [T] counts, of the latest read
  std::vector<float> grip_force;                // [T] N, true: mean of both pads' normal forces
  std::vector<float> arm;                       // [T,2] m/s, written last: sideways, up; empty where the motion is prescribed
};

// What the loop saw and did, at the samples of the sensor that it reads.
struct ControlRecord {
  std::string detector;                      // "force_ratio"; empty: the scene has none
  std::string controller;                    // "step_on_slip"; empty: the scene has none
  std::string sensor;                        // the scene's name of the one that the detector, else the controller reads: "pad"
  double rate = 0.0;                         // Hz, of the samples
  std::vector<double> time;                  // [T] s
  std::vector<std::uint8_t> detector_class;  // [T] PadState, of the latest estimate that was there at that instant
  GripRecord grip;

  Confusion confusion{};  // there in every mode of recording
};

// A body's motion in the world frame, at TrialRecord::body_time.
struct BodyRecord {
  std::string name;
  std::vector<float> pose;        // [T,7] m, then quaternion w x y z; the quaternion's sign is continuous in time
  std::vector<float> velocity;    // [T,6] m/s of the body frame's origin, then rad/s
  std::vector<double> size = {};  // [3] m, its extent along its own axes; empty: not said
};

// How a box stood that a guided arm has turned on its table.
struct TurnOutcome {
  double tilt = 0.0;        // rad, at the trial's end, between the box's own axis Y and the vertical
  double least_tilt = 0.0;  // rad, the least of the trial
  bool standing = false;    // at the trial's end no pad touches it, the table carries it, and it is upright to 5 degrees
};

// How a grasp ended. NaN: it never happened, or does not apply.
struct GraspOutcome {
  bool dropped = false;                                         // lost after it was lifted
  double drop_time = std::numeric_limits<double>::quiet_NaN();  // s
  // Whether the box left the table in the lift (GraspSimulation). Empty: the arm is guided, the trial is imported or of a version that did not say.
  std::optional<bool> lifted = {};
  double lift_height =
      std::numeric_limits<double>::quiet_NaN();  // m, the greatest of the box's lowest corner over the table in the lift
  // Of the box in the arm's frame, from the lift's beginning to the trial's end, the give of pads and fingers in it; NaN:
  // not held.
  double slip_translation = std::numeric_limits<double>::quiet_NaN();  // m, of its middle
  double slip_rotation = std::numeric_limits<double>::quiet_NaN();     // rad
  // True grip forces, the mean of both pads' normal forces.
  double max_grip_force = 0.0;    // N, at any tick
  double final_grip_force = 0.0;  // N, at the last tick
  // N, m g/(2 mu_s), mu_s upwards: the least that could hold the box (HeldBox::ideal_force()); NaN where no force could.
  double ideal_grip_force = std::numeric_limits<double>::quiet_NaN();
  // s, from the first tick of the lift at which a unit of the sensor's pad truly slips until a command that follows from a later
  // read, and closes further, begins to act; NaN: none before the drop, the detector is
  // Detection::early, or the controller closes to hold a force alone (Answers: constant_force,
  // hold_preset, force_pid, timed_grip, and step_on_slip while its detector says nothing).
  double reaction_time = std::numeric_limits<double>::quiet_NaN();
  std::optional<TurnOutcome> turn = {};  // empty where the arm's motion is prescribed

  // One of the three is true of every grasp.
  [[nodiscard]] bool held() const { return !dropped && lifted.value_or(true); }
  [[nodiscard]] bool not_lifted() const { return !dropped && !lifted.value_or(true); }
};

// Whether the body of a scene's `hold` is held at the trial's end.
struct HoldOutcome {
  bool held = false;
  double from = 0.0;   // s, hold.from
  double moved = 0.0;  // m, of the body's origin against that of what holds it, from then to the end
};

// How a detector did in a trial. An alarm is a tick at which the loop sees incipient or gross. The first one decides, as the
// stopping time does in sequential change detection (A. N. Shiryaev, Theory Probab. Appl. 8, 1963; G. Lorden, Ann. Math. Stat.
// 42, 1971), where the delay is that of the runs without an alarm before the change. So a detector that alarms before the slip
// has no delay in that trial, also where the alarm is withdrawn and comes again after the slip began: a loop has acted on the
// first one, and one that comes and goes would meet any slip at once.
enum class Detection : std::uint8_t {
  quiet,        // no slip, no alarm
  false_alarm,  // no slip, an alarm
  early,        // an alarm before the slip
  seen,         // the first alarm comes once slip has begun: the one case with a delay
  missed,       // slip, no alarm
};

// "quiet", "false_alarm", "early", "seen", "missed"
std::string_view detection_word(Detection detection);

// How a trial ended. NaN: it never happened. With several sensors the earliest time and the largest distance count, but for those
// that follow another's pad.
struct TrialOutcome {
  double touch_time = std::numeric_limits<double>::quiet_NaN();             // s
  double first_micro_slip_time = std::numeric_limits<double>::quiet_NaN();  // s, a first part of a unit slips
  double first_slip_time = std::numeric_limits<double>::quiet_NaN();        // s, a first unit slips as a whole
  double gross_slip_time = std::numeric_limits<double>::quiet_NaN();        // s, all touching units slip
  double max_slip_distance = 0.0;                                           // m, of any unit; NaN: imported

  // Of the detector. Slip is that of the sensor that it reads, by the rule strict: it begins when a first unit slips as a whole.
  // In a grasp it is the first of the lift, and nothing counts from a drop on. Alarms count from the trial's beginning; what
  // closing fingers make slip is no false alarm, so in a grasp whose sensor slips before the lift none counts from that slip to
  // the lift.
  double false_alarm_time = std::numeric_limits<double>::quiet_NaN();  // s, first alarm before slip
  double detection_time = std::numeric_limits<double>::quiet_NaN();    // s, first alarm once slip has begun
  double detection_delay =
      std::numeric_limits<double>::quiet_NaN();  // s, from when it began to detection_time; of Detection::seen alone
  double judged_slip_time = std::numeric_limits<double>::quiet_NaN();  // s, when it began
  std::optional<Detection> detection = {};                             // empty: the scene has no detector

  std::optional<GraspOutcome> grasp;  // empty: the scene is none
  std::optional<HoldOutcome> hold;    // empty: the scene has no `hold`

  // By sensor, the samples with a value beyond its range (Sensor::saturated). A sensor whose readings all lie within it is not in
  // here.
  std::map<std::string, std::uint64_t> saturated;
};

// The JSON object of a demo's attribute `outcome`: touch_time_s, first_micro_slip_time_s, first_slip_time_s, gross_slip_time_s,
// max_slip_distance_m, false_alarm_time_s, detection_time_s, detection_delay_s; only with a detector: judged_slip_time_s,
// detection (a detection_word()); and of a grasp, null without one: dropped, lifted, drop_time_s, lift_height_m, slip_translation_m, slip_rotation_rad,
// max_grip_force_N, final_grip_force_N, ideal_grip_force_N, reaction_time_s; and only where the arm is guided: tilt_rad,
// least_tilt_rad, standing. Only where the scene has `hold`: held, hold_from_s, moved_m. Only where values were beyond a sensor's range: saturated_samples, an object {sensor: samples}.
std::string outcome_json(const TrialOutcome& outcome);
// The inverse. A dataset of a version without detectors has none of their keys. Throws InputError when `text` is no such object.
TrialOutcome parse_outcome(const std::string& text);

// Says how the detector did: sets `detection`, from `false_alarm_time`, `detection_time` and whether there is slip to be judged
// by. Of an early one it takes away the delay, and the reaction time of a grasp, whose loop has closed for the alarm and not for
// the slip.
void settle_detection(TrialOutcome& outcome, bool slips);

struct TrialRecord {
  std::size_t trial = 0;          // k of demo_<k>
  std::uint64_t seed = 0;         // the dataset's; the trial's draws are keyed by (seed, trial)
  std::string material;           // what /mask splits by, or what else the scene's `split` says
  std::string params = "{}";      // JSON object: path -> value of what was swept
  std::string model_sha256 = {};  // of the scene's model file, 64 hexadecimal digits; empty: it has none
  // "MuJoCo, FFTW": libraries of others that computed in it, whose results depend on the processor in the last digits. Empty: none did, and the trial
  // has the same bits on every processor.
  std::string libraries = {};
  TrialOutcome outcome;
  std::vector<SensorRecord> sensors;  // empty, as are the bodies: only the outcome was recorded
  std::vector<double> body_time;      // [T] s, samples of the fastest sensor that follows no other's pad; imported: of the first
  std::vector<BodyRecord> bodies;
  std::optional<ControlRecord> control;  // empty: the scene has no detector and no controller

  // Samples of that sensor.
  [[nodiscard]] std::size_t num_samples() const { return body_time.size(); }
  // Throws InputError, naming the trial, where there is none of that name.
  [[nodiscard]] const BodyRecord& body(std::string_view called) const;
};

}  // namespace slipbench
