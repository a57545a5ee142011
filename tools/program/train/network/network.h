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
#include <variant>
#include <vector>

#include "detectors/network/description.h"

namespace slipbench::train {

// Layers of a network: one declaration that libtorch trains by and the ONNX file is written from.

// Between layers there are clips [N, T, shape...]: T frames of N sequences, each frame an array of `shape`, at first [F]. "Each frame" below
// means that a layer works on the frames one by one.

struct Linear {  // y = W x + b along the last axis, each frame
  std::size_t outputs = 1;
};
struct Relu {};
struct Tanh {};
// (x - m)/sqrt(v + 1e-5) g + b, for each place along `axis` of a frame. m and v are those of the batch while it learns, and running means,
// a tenth of each batch, when it answers.
struct BatchNorm {
  std::size_t axis = 0;
};
struct Gru {  // [F] -> [units], along T; the state is zero at the beginning of a clip
  std::size_t units = 1;
};
struct Lstm {  // likewise
  std::size_t units = 1;
};
// [C, H, W] -> [channels, H, W], along T: an LSTM whose gates are convolutions (Shi et al., NIPS 2015, without peepholes).
struct ConvLstm {
  std::size_t channels = 1, kernel = 3;  // odd; what lies outside is 0
};
struct Conv1d {  // [F] -> [channels], over `kernel` frames of T: an answer for all but the first kernel - 1 frames
  std::size_t channels = 1, kernel = 1;
};
struct Conv2d {  // [C, H, W] -> [channels, H', W'], H' = H + 2 padding - kernel + 1; each frame
  std::size_t channels = 1, kernel = 3, padding = 0;
};
struct MaxPool {};        // [C, H, W] -> [C, H/2, W/2], the largest of 2 x 2; an odd row or column is left out
struct GlobalAverage {};  // [C, H, W] -> [C]
// The mean of each place over the units, and the greatest: [units, F] -> [2 F], or beside each unit's own, [units, 3 F].
struct PoolUnits {
  bool beside = false;
};
// [nodes, F] -> [nodes, units]: y = A x W + b (Kipf and Welling, ICLR 2017), each frame. `adjacency` [nodes, nodes]: A.
struct GraphConvolution {
  std::size_t units = 1;
  std::vector<double> adjacency;
};
struct Flatten {};  // to one axis, in C order
struct Reshape {    // in C order
  std::vector<std::size_t> shape;
};
struct Permute {  // axis i of what comes out is axis order[i] of what goes in
  std::vector<std::size_t> order;
};
// The last of `frames` frames alone. What is recurrent begins afresh with every answer; without it, state is carried from frame to frame.
struct Last {
  std::size_t frames = 1;
};

using Layer = std::variant<Linear, Relu, Tanh, BatchNorm, Gru, Lstm, ConvLstm, Conv1d, Conv2d, MaxPool, GlobalAverage, PoolUnits,
                           GraphConvolution, Flatten, Reshape, Permute, Last>;
using Layers = std::vector<Layer>;

using Shape = std::vector<std::size_t>;
std::size_t extent_of(const Shape& shape);  // values of an array of that shape

// The shape of a frame after `layer` where it was `in` before. Throws std::invalid_argument where the layer does not fit.
Shape shape_after(const Layer& layer, const Shape& in);

// An array that a layer learns, or (`running`) keeps beside: the mean and variance of a BatchNorm.
struct Parameter {
  Shape shape;
  std::size_t fan_in = 1;  // values that one of its outputs is a sum of: bounds its first values
  bool running = false;
  double first = 0.0;  // its first value where it is not drawn
  bool drawn = true;   // uniform within +-1/sqrt(fan_in)
};
// In the order in which they are kept. Linear: W [outputs, inputs], b. Conv1d: W [channels, inputs, kernel], b. Conv2d: W [channels, C, kernel,
// kernel], b. GraphConvolution: W [F, units], b. Gru: W_ih [3 units, F], W_hh [3 units, units], b_ih, b_hh, gates r, z, n. Lstm: the
// same with four, i, f, g, o. ConvLstm: W [4 channels, C + channels, kernel, kernel], b, gates i, f, g, o. BatchNorm: g, b, running mean,
// running variance.
std::vector<Parameter> parameters_of(const Layer& layer, const Shape& in);

// The adjacency of undirected edges between nodes, with every node its own neighbour, normalised: D^-1/2 (A + 1) D^-1/2. [nodes, nodes]
struct Edge {
  std::size_t a = 0, b = 0;
};
std::vector<double> normalised_adjacency(std::size_t nodes, std::span<const Edge> edges);

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

// Both throw as make_network() and onnx_model(); who calls make() owns the network.
struct TorchLibrary {
  Network* (*make)(const NetworkShape& shape, std::uint64_t seed);
  // `metadata`: the text of the description.
  std::string (*onnx)(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                      const std::string& metadata);
  const char* versions;  // network_libraries()
};

// Of a function that returns the address of a TorchLibrary.
inline constexpr const char* torch_symbol = "slipbench_torch_library";

// The `onnx` of the above.
std::string write_onnx(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                       const std::string& metadata);

}  // namespace slipbench::train
