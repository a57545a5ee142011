// Training examples for networks from a dataset: frames, a class for each, and properties of each
// trial.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "detectors/network/description.h"
#include "sim/api/pad_state.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/learning_data/label_rules.h"

namespace slipbench::train {

inline constexpr std::uint8_t masked = 255;  // label of a frame that is neither used for training nor judged

struct FrameSequence {
  std::vector<float> features;      // [T, inputs]
  std::vector<std::uint8_t> label;  // [T] class of each frame, or `masked`
};

// Classes of slip.
enum class ClassRule {
  slip,  // hold, slip
  kind,  // stable, translation, rotation: the larger energy in the rigid motion in the pad plane that best fits the slip of all units
  // The class of the trial, t (touch), n, e, s, w, cw or aw, by its name or its motion, while in
  // contact. Masked without contact. Independent of the labels, except for `latched` with truth:
  // then t until more than half of what touches slips. In that case frames with more than half
  // slipping are masked in a trial of t, and earlier frames with a slipping whole unit in other
  // trials.
  direction,
};
// Classes of a network's output by that rule. Slip is incipient if the labels derive from the rule
// micro, else gross.
std::vector<network::Class> classes_of(ClassRule classes, LabelRule labels);

// One sensor in one trial.
struct Example {
  std::size_t trial = 0;
  std::string sha256;       // the trial's digest (trial_identity)
  std::string part;         // in the dataset's own split: "train", "valid", "test", or "none"; empty: no masks
  std::size_t dataset = 0;  // index of its file
  std::string twin;         // truth_sha256(): trials with equal values are one experiment; empty: unknown
  std::string sensor;       // name in the scene
  std::string material;     // swept surface.material, friction.static and friction.kinetic; empty: not swept
  std::string object;       // swept shapes, sizes, surface, friction, effects and stiffness; empty: not swept
  double speed = std::numeric_limits<double>::quiet_NaN();  // m/s, swept motion.speed; NaN: not swept
  double mass = std::numeric_limits<double>::quiet_NaN();   // kg, swept box.mass or bodies.*.mass, likewise
  bool touches = false;                                     // there is contact at some time; else only motors run
  bool holds = false;                                       // no part of a unit slips in any sample; false without truth
  double onset = std::numeric_limits<
      double>::quiet_NaN();     // s, true first slip: of a whole unit (strict), of a part of one (other rules); NaN: none
  std::vector<double> time;     // [T] s, of each frame's last sample
  std::vector<PadState> truth;  // [T] by strict if the labels are strict, else by micro; empty: a recording without truth
  FrameSequence frames;         // unscaled
  // For the choice of the operating point by score; both empty for a recording without truth.
  // [T] 1: slip, 0: none, `masked`: neither. As the benchmark counts slip (`masked` on a stage,
  // `micro` in a grasp), except that a slip of less than least_slip_distance is not counted.
  std::vector<std::uint8_t> scored;
  std::vector<double> path;  // [T] m, path that the object has slipped since the start
  std::uint8_t turn = 0;     // images are turned by this many times 30 degrees; turned copies are for training only
};

// Called before the first trial is read and after each, with the number of trials read and of all
// trials.
using ReadingProgress = std::function<void(std::size_t read, std::size_t trials)>;

struct ExampleOptions {
  // Offset and scale are ignored. With a range of rates, the rate of each trial is drawn from it (its
  // logarithm uniformly, up to the sensor's): RandomStream(seed, trial, "rate").
  network::Input input;
  LabelRule labels = LabelRule::micro;
  ClassRule classes = ClassRule::slip;
  std::string sensor;  // empty: every sensor of the input's type and rate (network::rate_fits) whose values fit its picks
  std::size_t turned =
      0;  // for images: number of additional copies of each example with turned images (tools/learning_data/myrmex_images.h)
  std::size_t at_most =
      0;  // maximum number of drawn frames per class and example; 0: all. For networks that see one frame at a time
  std::uint64_t seed = 1;  // of the draws: RandomStream(seed, trial, "frames") and "turns"
  ReadingProgress read = {};
};

struct Examples {
  std::string command;              // command that wrote the dataset
  std::vector<std::string> sha256;  // content digest of each file
  std::size_t inputs = 0;           // values per frame
  network::Input input;             // that of the options, with the physical unit of each channel in the datasets
  std::vector<Example> all;         // by trial, then by sensor
};

// Input of a network that treats units alike (Transform::units) for a dataset of any sensor with
// any number of units: `input` with type, rate and channel of a sensor of the first trial. Window,
// stride and spans in samples are scaled by the ratio of the rates, to a window of at least 2 and
// spans of at least 2, 3, 4, ... The channel is the sensor's first of three axes. If it differs
// from that of `input`, the floor is a thousandth of its greatest value in that trial. Of several
// sensors, or those called `sensor`, takes the first with the channel of `input` at 200 Hz or more,
// else the first with any channel of three axes. units: their number; 0 if no sensor has such a
// channel, and the input is unchanged. Throws InputError as read_examples(), and for a channel that
// is 0 throughout.
struct UnitsInput {
  network::Input input;
  std::size_t units = 0;
};
UnitsInput units_input(const std::string& dataset_path, const std::string& sensor, const network::Input& input);

// Reads every trial of all shards of an intact dataset (whole_dataset). A frame's label is that of
// its last sample. Throws InputError, naming the file, for an incomplete dataset, without a
// matching sensor, and for missing labels.
Examples read_examples(const std::string& dataset_path, const ExampleOptions& options);

// As above for one or more datasets. Trial numbers continue from one to the next.
Examples read_examples(std::span<const std::string> dataset_paths, const ExampleOptions& options);

// Example of one sensor of a trial, with its images turned by `turn` times 30 degrees, as in
// read_examples(). Throws InputError as Frames does.
Example example_of(const TrialRecord& record, const SensorRecord& sensor, const ExampleOptions& options, std::size_t turn = 0);

// Properties of a trial from the JSON of its swept values.
struct SweptFacts {
  std::string material, object;
  double speed = std::numeric_limits<double>::quiet_NaN(), mass = std::numeric_limits<double>::quiet_NaN();
};
SweptFacts swept_facts(const std::string& params);

}  // namespace slipbench::train
