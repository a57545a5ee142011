#include "tools/program/train/network/network.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace slipbench::train {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>  // clang 14 deduces no aggregate
Overloaded(Cases...)->Overloaded<Cases...>;

void need(bool good, const char* what) {
  if (!good) throw std::invalid_argument(std::string("a layer does not fit: ") + what);
}

Parameter drawn(Shape shape, std::size_t fan_in) { return {std::move(shape), fan_in}; }
Parameter constant(std::size_t size, double value, bool running) { return {{size}, 1, running, value, false}; }

std::vector<Parameter> recurrent(std::size_t gates, std::size_t units, std::size_t inputs) {
  const std::size_t rows = gates * units;
  return {drawn({rows, inputs}, units), drawn({rows, units}, units), drawn({rows}, units), drawn({rows}, units)};
}

void need_list(const Shape& in) { need(in.size() == 1, "a frame is no list"); }
void need_image(const Shape& in) { need(in.size() == 3, "a frame is no image [C, H, W]"); }

// What each kind makes of a frame.
Shape shape_of(const Linear& linear, Shape in) {
  need(!in.empty(), "a frame is a single value");
  in.back() = linear.outputs;
  return in;
}
Shape shape_of(const Relu& /*relu*/, Shape in) { return in; }
Shape shape_of(const Tanh& /*tanh*/, Shape in) { return in; }
Shape shape_of(const BatchNorm& norm, Shape in) {
  need(norm.axis < in.size(), "no such axis");
  return in;
}
Shape shape_of(const Gru& gru, const Shape& in) {
  need_list(in);
  return {gru.units};
}
Shape shape_of(const Lstm& lstm, const Shape& in) {
  need_list(in);
  return {lstm.units};
}
Shape shape_of(const ConvLstm& lstm, const Shape& in) {
  need_image(in);
  need(lstm.kernel % 2 == 1, "an even kernel");
  return {lstm.channels, in[1], in[2]};
}
Shape shape_of(const Conv1d& conv, const Shape& in) {
  need_list(in);
  need(conv.kernel >= 1, "no kernel");
  return {conv.channels};
}
Shape shape_of(const Conv2d& conv, const Shape& in) {
  need_image(in);
  const std::size_t height = in[1] + 2 * conv.padding, width = in[2] + 2 * conv.padding;
  need(height >= conv.kernel && width >= conv.kernel && conv.kernel >= 1, "a kernel larger than the image");
  return {conv.channels, height - conv.kernel + 1, width - conv.kernel + 1};
}
Shape shape_of(const MaxPool& /*pool*/, const Shape& in) {
  need_image(in);
  need(in[1] >= 2 && in[2] >= 2, "an image too small to pool");
  return {in[0], in[1] / 2, in[2] / 2};
}
Shape shape_of(const GlobalAverage& /*average*/, const Shape& in) {
  need_image(in);
  return {in[0]};
}
Shape shape_of(const PoolUnits& pool, const Shape& in) {
  need(in.size() == 2, "a frame is no list of units");
  return pool.beside ? Shape{in[0], 3 * in[1]} : Shape{2 * in[1]};
}
Shape shape_of(const GraphConvolution& graph, const Shape& in) {
  need(in.size() == 2 && graph.adjacency.size() == in[0] * in[0], "a frame is no list of nodes of that graph");
  return {in[0], graph.units};
}
Shape shape_of(const Flatten& /*flatten*/, const Shape& in) { return {extent_of(in)}; }
Shape shape_of(const Reshape& reshape, const Shape& in) {
  need(extent_of(reshape.shape) == extent_of(in), "another number of values");
  return reshape.shape;
}
Shape shape_of(const Permute& permute, const Shape& in) {
  Shape sorted = permute.order, out;
  std::ranges::sort(sorted);
  need(sorted.size() == in.size(), "another number of axes");
  for (std::size_t i = 0; i < sorted.size(); ++i) need(sorted[i] == i, "no order of axes");
  for (const std::size_t axis : permute.order) out.push_back(in[axis]);
  return out;
}
Shape shape_of(const Last& last, Shape in) {
  need(last.frames >= 1, "no frame");
  return in;
}

}  // namespace

std::size_t extent_of(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

Shape shape_after(const Layer& layer, const Shape& in) {
  return std::visit([&in](const auto& kind) { return shape_of(kind, in); }, layer);
}

std::vector<Parameter> parameters_of(const Layer& layer, const Shape& in) {
  return std::visit(
      Overloaded{
          [&](const Linear& linear) -> std::vector<Parameter> {
            return {drawn({linear.outputs, in.back()}, in.back()), drawn({linear.outputs}, in.back())};
          },
          [&](const BatchNorm& norm) -> std::vector<Parameter> {
            const std::size_t n = in[norm.axis];
            return {constant(n, 1.0, false), constant(n, 0.0, false), constant(n, 0.0, true), constant(n, 1.0, true)};
          },
          [&](const Gru& gru) { return recurrent(3, gru.units, in[0]); },
          [&](const Lstm& lstm) { return recurrent(4, lstm.units, in[0]); },
          [&](const ConvLstm& lstm) -> std::vector<Parameter> {
            const std::size_t channels = in[0] + lstm.channels, fan_in = channels * lstm.kernel * lstm.kernel;
            return {drawn({4 * lstm.channels, channels, lstm.kernel, lstm.kernel}, fan_in), drawn({4 * lstm.channels}, fan_in)};
          },
          [&](const Conv1d& conv) -> std::vector<Parameter> {
            const std::size_t fan_in = in[0] * conv.kernel;
            return {drawn({conv.channels, in[0], conv.kernel}, fan_in), drawn({conv.channels}, fan_in)};
          },
          [&](const Conv2d& conv) -> std::vector<Parameter> {
            const std::size_t fan_in = in[0] * conv.kernel * conv.kernel;
            return {drawn({conv.channels, in[0], conv.kernel, conv.kernel}, fan_in), drawn({conv.channels}, fan_in)};
          },
          [&](const GraphConvolution& graph) -> std::vector<Parameter> {
            return {drawn({in[1], graph.units}, in[1]), drawn({graph.units}, in[1])};
          },
          [](const auto&) { return std::vector<Parameter>{}; },
      },
      layer);
}

std::vector<double> normalised_adjacency(std::size_t nodes, std::span<const Edge> edges) {
  std::vector<double> adjacency(nodes * nodes, 0.0);
  for (std::size_t node = 0; node < nodes; ++node) adjacency[node * nodes + node] = 1.0;
  for (const Edge& edge : edges) adjacency.at(edge.a * nodes + edge.b) = adjacency.at(edge.b * nodes + edge.a) = 1.0;
  std::vector<double> degree(nodes, 0.0);
  for (std::size_t a = 0; a < nodes; ++a) {
    for (std::size_t b = 0; b < nodes; ++b) degree[a] += adjacency[a * nodes + b];
  }
  for (std::size_t a = 0; a < nodes; ++a) {
    for (std::size_t b = 0; b < nodes; ++b) adjacency[a * nodes + b] /= std::sqrt(degree[a] * degree[b]);
  }
  return adjacency;
}

std::size_t parameter_count(const NetworkShape& shape) {
  std::size_t count = 0;
  Shape frame{shape.inputs};
  for (const Layer& layer : shape.layers) {
    for (const Parameter& parameter : parameters_of(layer, frame)) count += parameter.running ? 0 : extent_of(parameter.shape);
    frame = shape_after(layer, frame);
  }
  return count;
}

std::size_t class_count(const NetworkShape& shape) {
  Shape frame{shape.inputs};
  for (const Layer& layer : shape.layers) frame = shape_after(layer, frame);
  if (frame.size() != 1) throw std::invalid_argument("what the last layer gives is no list of classes");
  return frame[0];
}

std::size_t history_of(const NetworkShape& shape) {
  std::size_t frames = 1;
  for (const Layer& layer : shape.layers) {
    if (const auto* conv = std::get_if<Conv1d>(&layer)) frames += conv->kernel - 1;
  }
  for (const Layer& layer : shape.layers) {
    if (const auto* last = std::get_if<Last>(&layer)) frames = last->frames;
  }
  return frames;
}

bool carries_state(const NetworkShape& shape) {
  bool recurrent = false;
  for (const Layer& layer : shape.layers) {
    if (std::holds_alternative<Last>(layer)) return false;
    recurrent = recurrent || std::holds_alternative<Gru>(layer) || std::holds_alternative<Lstm>(layer) ||
                std::holds_alternative<ConvLstm>(layer);
  }
  return recurrent;
}

}  // namespace slipbench::train
