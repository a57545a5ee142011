// The trials of a dataset as networks learn from them: frames, a class for each, and what is known of each trial.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "detectors/hd/words.h"
#include "detectors/network/description.h"
#include "sim/core/pad_state.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::train {

inline constexpr std::uint8_t masked = 255;  // label of a frame that neither trains nor judges

struct FrameSequence {
  std::vector<float> features;      // [T, inputs]
  std::vector<std::uint8_t> label;  // [T] class of each frame, or `masked`
};

// Whose word it is that a sample slips.
enum class LabelRule {
  micro,    // truth: a part of a unit slips
  strict,   // truth: a whole unit slips
  paper,    // the rule of the sensor's paper: of a piezo_skin, that its 100 Hz position has changed
  latched,  // micro, and from its first slip on until nothing touches any more
  masked,  // micro, and a frame that sticks again after a slip, before nothing touches, is masked: it is under the shear that made it slip
  tightened,  // on a stage masked, in a grasp micro: what sticks again there is held, since the grip has tightened
  recorded,   // no truth: the labels of an imported recording
};
inline constexpr std::array label_words{
    hd::Word<LabelRule>{"micro", LabelRule::micro},      hd::Word<LabelRule>{"strict", LabelRule::strict},
    hd::Word<LabelRule>{"paper", LabelRule::paper},      hd::Word<LabelRule>{"latched", LabelRule::latched},
    hd::Word<LabelRule>{"masked", LabelRule::masked},    hd::Word<LabelRule>{"tightened", LabelRule::tightened},
    hd::Word<LabelRule>{"recorded", LabelRule::recorded}};

// What slip is divided into.
enum class ClassRule {
  slip,  // hold, slip
  kind,  // stable, translation, rotation: of the rigid motion in the pad plane that fits the slip of all units best, the part with more energy
  // t (touch), n, e, s, w, cw, aw: that of the trial, by its name or its motion, while something touches, else masked. Whatever the labels, but by
  // `latched` and with the truth t until more than half of what touches slips. Masked: frames in which that is so in a trial of t, and those
  // before it in which a whole unit slips in another.
  direction,
};
// What a network says by that rule: a slip is incipient by the rules micro, latched and masked, else gross.
std::vector<network::Class> classes_of(ClassRule classes, LabelRule labels);

// One sensor in one trial.
struct Example {
  std::size_t trial = 0;
  std::string sha256;       // the trial's digest (trial_identity)
  std::string part;         // of the dataset's own split: "train", "valid", "test", or "none"; empty: the dataset has no masks
  std::size_t dataset = 0;  // number of the file that it is from
  std::string twin;         // truth_sha256(): trials in which it is equal are one experiment; empty: not known
  std::string sensor;       // the scene's name
  std::string material;     // what was swept of surface.material and friction.static and kinetic; empty: nothing
  std::string object;       // what was swept of shapes, sizes, surface, friction, effects and stiffness; empty: nothing
  double speed = std::numeric_limits<double>::quiet_NaN();  // m/s, motion.speed as it was swept; NaN: was not
  double mass = std::numeric_limits<double>::quiet_NaN();   // kg, of box.mass or bodies.*.mass likewise
  bool touches = false;                                     // something touches at some time; else only motors run
  double onset = std::numeric_limits<
      double>::quiet_NaN();     // s, true first slip of a whole unit (strict), of a part of one (all others); NaN: none
  std::vector<double> time;     // [T] s, of each frame's last sample
  std::vector<PadState> truth;  // [T] by micro; by strict where the labels are strict; empty: a recording without truth
  FrameSequence frames;         // not scaled
  std::uint8_t turn = 0;        // its images are turned by so many times 30 degrees; such a copy only learns
};

// Called before the first trial is read and after each: how many have been read of how many.
using ReadingProgress = std::function<void(std::size_t read, std::size_t trials)>;

struct ExampleOptions {
  network::Input input;  // offset and scale are not used
  LabelRule labels = LabelRule::micro;
  ClassRule classes = ClassRule::slip;
  std::string sensor;       // empty: every sensor of the input's type and rate (network::rate_fits) whose values its picks fit
  std::size_t turned = 0;   // of a myrmex: so many copies of each example more, their images turned (samples/myrmex_images.h)
  std::size_t at_most = 0;  // frames of a class in an example, drawn; 0: all. For networks that see one frame at a time
  std::uint64_t seed = 1;   // of what is drawn: RandomStream(seed, trial, "frames") and "turns"
  ReadingProgress read = {};
};

struct Examples {
  std::string command;              // that made the dataset
  std::vector<std::string> sha256;  // of its content, a file each
  std::size_t inputs = 0;           // values a frame
  std::vector<Example> all;         // by trial, then by sensor
};

// What a network that sees units alike (Transform::units) reads of a dataset, whatever the sensor and however many its units: `input` with type, rate
// and channel of a sensor of the first trial; samples of window, stride and spans in the ratio of the rates, a window of 2 and spans of 2, 3, 4, ...
// at least. The channel is the sensor's first of three axes. Where it is not the one of `input`, the floor is a thousandth of its greatest value in
// that trial. Of several sensors, or those called `sensor`, the first with the channel of `input` at 200 Hz or more is taken, else the first with any
// of three axes. units: how many there are, 0 where no sensor has such a channel, and the input is unchanged. Throws InputError as read_examples, and
// for a channel that is 0 throughout.
struct UnitsInput {
  network::Input input;
  std::size_t units = 0;
};
UnitsInput units_input(const std::string& dataset_path, const std::string& sensor, const network::Input& input);

// Reads every trial, all shards, of a dataset that holds what was written (whole_dataset). A frame's label
// is that of its last sample. Throws InputError, naming the file: no whole dataset, no sensor that fits, labels that are not there.
Examples read_examples(const std::string& dataset_path, const ExampleOptions& options);

// The same of several datasets, one at least. The numbers of trials run on from one to the next.
Examples read_examples(std::span<const std::string> dataset_paths, const ExampleOptions& options);

// One sensor of a trial, its images turned by `turn` times 30 degrees; what read_examples() does for each. Throws InputError as Frames does.
Example example_of(const TrialRecord& record, const SensorRecord& sensor, const ExampleOptions& options, std::size_t turn = 0);

// Facts of a trial, out of the JSON of what was swept.
struct SweptFacts {
  std::string material, object;
  double speed = std::numeric_limits<double>::quiet_NaN(), mass = std::numeric_limits<double>::quiet_NaN();
};
SweptFacts swept_facts(const std::string& params);

}  // namespace slipbench::train
