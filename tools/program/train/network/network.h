// Neural networks that name the class of every frame of a sequence, trained by libtorch. libtorch takes 0.4 s to load, so it stands in a library
// of its own, which is loaded when the first network is made; no other file than torch_network.cc sees its headers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "detectors/network/description.h"
#include "tools/program/train/network/layers.h"

namespace slipbench::train {

// From frames of `inputs` values to the logits of some classes: the values after the last layer.
struct NetworkShape {
  std::size_t inputs = 1;
  Layers layers;
};

// What it learns: without running means. Throws std::invalid_argument where layers do not fit each other.
std::size_t parameter_count(const NetworkShape& shape);
// Classes that it tells. Throws std::invalid_argument where the last layer's frame is no list.
std::size_t class_count(const NetworkShape& shape);
// Frames that an answer is made of, the latest among them: those of Last, or 1 + the sum of (kernel - 1) of every Conv1d. What recurrent layers
// carry from earlier frames is not counted.
std::size_t history_of(const NetworkShape& shape);
// Whether a recurrent layer carries state from frame to frame.
bool carries_state(const NetworkShape& shape);

inline constexpr std::uint8_t masked = 255;  // label of a frame that neither teaches nor judges

struct FrameSequence {
  std::vector<float> features;      // [T, inputs]
  std::vector<std::uint8_t> label;  // [T] class of each frame, or `masked`
};

enum class Optimiser {
  rmsprop,  // Hinton; decay 0.99
  adam,     // Kingma and Ba, ICLR 2015; 0.9, 0.999
};

// How rare classes come to count as much as common ones.
enum class Balance {
  weights,  // clips are drawn uniformly from the sequences, and the loss of a class is weighted by the inverse of its share
  drawing,  // a class is drawn, then one of its frames from all sequences, then the clip's place around it
};

// Gradient descent on the cross entropy of clips drawn from the sequences.
struct TrainingOptions {
  std::size_t steps = 1000;
  std::size_t batch = 32;  // clips a step
  std::size_t clip =
      128;  // answers a clip, which has history_of() - 1 frames more; fewer where the longest sequence has fewer, 1 with Last. A shorter sequence is
            // a clip as a whole, behind which its last frame stands still and teaches nothing
  // Of a run of a class other than 0, as a slip: so many frames from its first on teach, then each tenth, since a loop acts on the beginning and
  // recordings slip on for seconds. 0: all.
  std::size_t onset_frames = 0;
  Optimiser optimiser = Optimiser::rmsprop;
  double learning_rate = 8e-4;  // at the first step
  double final_rate = 0.1;      // share of it at the last step; it falls in a straight line
  Balance balance = Balance::weights;
  double label_smoothing = 0.0;            // share of the target that all classes share alike
  double change_penalty = 0.0;             // times the mean |y_t - y_(t-1)| of the logits is added to the loss
  std::size_t change_from = 0;             // from this step on
  std::size_t validate_every = 50;         // steps; the last state is judged, too
  std::size_t patience = 0;                // ends after so many validations without a better one; 0: never
  std::uint64_t seed = 1;                  // of the draws of clips
  std::function<void()> before_step = {};  // may throw, which ends the training with what the last validation has saved
};

struct TrainingProgress {
  std::size_t step = 0, steps = 0;   // done, at most
  double loss = 0.0;                 // mean since the last report
  std::optional<double> validation;  // balanced accuracy of the state after this step; empty: there is nothing to validate on
  bool best = false;                 // of all so far
};

struct TrainingResult {
  std::vector<double> losses;                                    // of every step done
  std::size_t best_step = 0;                                     // steps that made the state which is kept
  double validation = std::numeric_limits<double>::quiet_NaN();  // its balanced accuracy; NaN: there was nothing to validate on
};

// Where a training that may be killed leaves its state, at each validation.
struct Checkpoint {
  std::string path;      // empty: none
  std::string identity;  // of the data and of all that is not in shape and options
  bool resume = false;   // go on from it where it is there; false: it must not be there
};

class Network {
 public:
  virtual ~Network() = default;

  [[nodiscard]] virtual const NetworkShape& shape() const = 0;
  // Every Parameter of every layer, in order.
  [[nodiscard]] virtual std::vector<std::vector<float>> state() const = 0;
  // Learns. Of the states that were validated the one with the greatest balanced accuracy on `validation` is kept, the earliest of equals; the
  // last where `validation` is empty. `report` is called after every validation and may throw, which ends it. Throws std::invalid_argument where
  // a class has no frame, or features and labels do not fit each other; InputError for a checkpoint of something else or damaged, and for
  // one that is there and not to be gone on with.
  virtual TrainingResult train(std::span<const FrameSequence> learnt, std::span<const FrameSequence> validation,
                               const TrainingOptions& options, const Checkpoint& checkpoint = {},
                               const std::function<void(const TrainingProgress&)>& report = {}) = 0;
  // Logits of every frame but the first history_of() - 1: [T - history + 1, classes].
  [[nodiscard]] virtual std::vector<float> logits(std::span<const float> features) const = 0;
};

// A network whose weights are uniform within +-1/sqrt(fan-in), drawn by RandomStream(seed, 0, "network"). The same seed and the same machine give
// the same weights after training, on any number of threads; another BLAS may round otherwise. Networks are independent of each other, and
// each is used by one thread at a time. Throws InputError where the program was built without libtorch.
std::unique_ptr<Network> make_network(const NetworkShape& shape, std::uint64_t seed);

// The bytes of an ONNX file of opset 13 that does one step: input "frames" [1, history x inputs], output "output" [1, classes]; carried
// state number k of all members goes in as "state_k" and comes out as "state_k_next". BatchNorm is a scale and an
// offset. Several `members`, states of networks of this shape: the mean of their probabilities; one: its logits. `description.states` and
// `description.output` are filled in; the whole stands in the file's metadata. The model has passed onnx's own checker. Throws InputError
// where the program was built without libtorch, std::invalid_argument where a state is not that of the shape.
std::string onnx_model(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                       network::Description description);

// Whether make_network() has its library.
bool networks_available();
// "libtorch 1.13.0, onnx 1.12.0": what trains and writes. Throws as make_network().
std::string network_libraries();

// The offset and scale that frames are learnt with, and seen with in the loop (network::Input).

enum class Scaling {
  standard,  // mean 0 and standard deviation 1 of every feature
  common,    // likewise, with one mean and one deviation for all features
  range,     // 0 to 1, the least to the greatest value of every feature
};

// A feature x becomes (x - offset) scale. One for all, or one for each feature.
struct Scale {
  std::vector<double> offset, scale;
};

// That of the frames of these sequences. What never changes is only shifted. Throws std::invalid_argument of no frame.
Scale scale_of(std::span<const FrameSequence* const> sequences, std::size_t inputs, Scaling scaling);

// In float32, as network::Frames does it.
void apply(const Scale& scale, FrameSequence& sequence);

// A written detector against libtorch.

// Runs the ONNX file at `path` as a loop would, on the scaled frames of one sequence, and compares what it says with the logits of its members,
// or the mean of their probabilities: 1e-5, of the greater of 1 and the value. Throws std::logic_error where it says something else, InputError as
// network::load_engine().
void check_engine(const std::string& path, std::span<const std::unique_ptr<Network>> members, const FrameSequence& sequence);

}  // namespace slipbench::train
