// Neural networks that call every frame of a sequence hold or slip, trained by libtorch. libtorch takes 0.4 s to load, so it stands in a
// library of its own, which is loaded when the first network is made; no other file than torch_network.cc sees its headers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace slipbench::learn {

enum class Architecture {
  mlp,  // each frame by itself
  tcn,  // causal convolutions along time
  gru,  // stacked gated recurrent units
};

// `layers` layers of `dim` channels, with ReLU after those of an mlp and a tcn, then a linear layer to two classes.
struct NetworkShape {
  Architecture architecture = Architecture::mlp;
  std::size_t inputs = 12;  // features a frame
  std::size_t dim = 32;
  std::size_t layers = 4;
  std::size_t kernel = 1;  // frames that a layer of a tcn sees
};

// Weights and biases of such a network. With i inputs, d = dim, l layers and k = kernel: 2d + 2 of the classes and
//   mlp  d(i + 1) + (l - 1) d(d + 1)
//   tcn  d(k i + 1) + (l - 1) d(k d + 1)
//   gru  3d(i + d + 2) + (l - 1) 3d(2d + 2)
std::size_t parameter_count(const NetworkShape& shape);

struct FrameSequence {
  std::vector<float> features;     // [T, inputs]
  std::vector<std::uint8_t> slip;  // [T] 1: slip, 0: hold
};

// RMSProp on the cross entropy of clips drawn from the sequences (papers/piezo-fft-gru, IV.B). A class counts by the inverse of its share
// of the training frames, so that both count alike. The state after the last step is kept.
struct TrainingOptions {
  std::size_t steps = 1000;
  std::size_t batch = 32;       // clips a step
  std::size_t clip = 128;       // frames a clip; fewer where the shortest sequence has fewer
  double learning_rate = 8e-4;  // at the first step, falling in a straight line to a tenth of it at the last
  std::uint64_t seed = 1;       // of the draws of clips
};

class Network {
 public:
  virtual ~Network() = default;

  // All weights and biases, layer by layer. [parameter_count()]
  [[nodiscard]] virtual std::vector<float> weights() const = 0;
  // Learns, and returns the loss of every step [steps]. Throws std::invalid_argument where a class has no frame, or features and labels do
  // not fit each other.
  virtual std::vector<double> train(std::span<const FrameSequence> sequences, const TrainingOptions& options) = 0;
  // The logarithm of the odds of slip, both classes equally likely beforehand, of every frame of a sequence. [T]
  [[nodiscard]] virtual std::vector<float> log_odds(std::span<const float> features) const = 0;
};

// A network whose weights are uniform within +-1/sqrt(fan-in), drawn by RandomStream(seed, 0, "network"). The same seed and the same machine give
// the same weights after training, on any number of threads; another BLAS may round otherwise. Networks are independent of each other, and
// each is used by one thread at a time. Throws InputError where the program was built without libtorch.
std::unique_ptr<Network> make_network(const NetworkShape& shape, std::uint64_t seed);

// Whether make_network() has its library.
bool networks_available();

}  // namespace slipbench::learn
