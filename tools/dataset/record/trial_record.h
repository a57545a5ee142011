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
#include "sim/api/pad_state.h"
#include "tools/dataset/record/sample_timing.h"
#include "tools/dataset/record/trial_outcome.h"
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

// Label of a sample of an imported recording whose state nobody knows (state_paper only). Figures,
// training and drawings leave such samples out.
inline constexpr PadState unknown_state{4};

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
  std::vector<std::uint8_t> state_paper;  // [L] PadState, the rule of the sensor's paper; of recordings also unknown_state
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

// True if the samples of a sensor are evenly_spaced(), by the resolution of its stamps.
bool evenly_spaced(const SensorRecord& sensor);
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
