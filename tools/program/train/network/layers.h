// Layers of a network: one declaration that libtorch trains by and the ONNX file is written from.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

namespace slipbench::train {

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

}  // namespace slipbench::train
