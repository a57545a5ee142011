// The only file with ONNX's headers.
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <onnx/checker.h>
#include <onnx/onnx_pb.h>

#include "tools/program/train/network/network.h"

namespace slipbench::train {
namespace {

using Ints = std::vector<std::int64_t>;

Ints sizes_of(const Shape& shape) { return {shape.begin(), shape.end()}; }

Ints with_front(std::int64_t front, const Shape& shape) {
  Ints sizes = sizes_of(shape);
  sizes.insert(sizes.begin(), front);
  return sizes;
}

// A graph that grows node by node; values are known by their names.
class Graph {
 public:
  explicit Graph(onnx::GraphProto& graph) : graph_(graph) {}

  std::string node(const std::string& kind, const std::vector<std::string>& inputs) { return nodes(kind, inputs, 1).front(); }
  std::vector<std::string> nodes(const std::string& kind, const std::vector<std::string>& inputs, std::size_t outputs) {
    onnx::NodeProto& node = *graph_.add_node();
    node.set_op_type(kind);
    node.set_name(new_name(kind));
    for (const std::string& input : inputs) node.add_input(input);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < outputs; ++i) node.add_output(names.emplace_back(new_name("value")));
    return names;
  }
  // Of the node that was added last.
  Graph& with(const std::string& name, std::int64_t value) {
    onnx::AttributeProto& attribute = add_attribute(name, onnx::AttributeProto::INT);
    attribute.set_i(value);
    return *this;
  }
  Graph& with(const std::string& name, const Ints& values) {
    onnx::AttributeProto& attribute = add_attribute(name, onnx::AttributeProto::INTS);
    for (const std::int64_t value : values) attribute.add_ints(value);
    return *this;
  }
  void rename_output(int output, const std::string& name) {
    graph_.mutable_node(graph_.node_size() - 1)->set_output(output, name);
  }

  std::string floats(const Ints& sizes, std::span<const float> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.set_name(new_name("weights"));
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t size : sizes) tensor.add_dims(size);
    tensor.set_raw_data(values.data(), values.size_bytes());
    return tensor.name();
  }
  std::string integers(const Ints& values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.set_name(new_name("sizes"));
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    tensor.set_raw_data(values.data(), values.size() * sizeof(std::int64_t));
    return tensor.name();
  }
  std::string reshaped(const std::string& value, const Ints& sizes) { return node("Reshape", {value, integers(sizes)}); }
  std::string transposed(const std::string& value, const Ints& order) {
    const std::string result = node("Transpose", {value});
    with("perm", order);
    return result;
  }

  void input(const std::string& name, const Ints& sizes) { describe(*graph_.add_input(), name, sizes); }
  void output(const std::string& name, const Ints& sizes) { describe(*graph_.add_output(), name, sizes); }

 private:
  std::string new_name(const std::string& kind) { return fmt::format("{}_{}", kind, count_++); }
  onnx::AttributeProto& add_attribute(const std::string& name, onnx::AttributeProto::AttributeType type) {
    onnx::AttributeProto& attribute = *graph_.mutable_node(graph_.node_size() - 1)->add_attribute();
    attribute.set_name(name);
    attribute.set_type(type);
    return attribute;
  }
  static void describe(onnx::ValueInfoProto& value, const std::string& name, const Ints& sizes) {
    value.set_name(name);
    onnx::TypeProto::Tensor& tensor = *value.mutable_type()->mutable_tensor_type();
    tensor.set_elem_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t size : sizes) tensor.mutable_shape()->add_dim()->set_dim_value(size);
  }

  onnx::GraphProto& graph_;
  std::size_t count_ = 0;
};

// `gates` blocks of a recurrent layer's weights, of which block i becomes the one that ONNX has at that place.
std::vector<float> reordered(std::span<const float> values, std::span<const std::size_t> order) {
  const std::size_t block = values.size() / order.size();
  std::vector<float> all;
  for (const std::size_t from : order)
    all.insert(all.end(), values.begin() + static_cast<std::ptrdiff_t>(from * block),
               values.begin() + static_cast<std::ptrdiff_t>((from + 1) * block));
  return all;
}

constexpr std::array<std::size_t, 3> gru_order{1, 0, 2};      // libtorch r z n; ONNX z r h
constexpr std::array<std::size_t, 4> lstm_order{0, 3, 1, 2};  // libtorch i f g o; ONNX i o f c

// One member's layers: frames [T, shape...].
class Writer {
 public:
  Writer(Graph& graph, const NetworkShape& shape, const std::vector<std::vector<float>>& state, std::size_t& states)
      : graph_(graph), shape_(shape), state_(state), carried_(carries_state(shape)), states_(states) {}

  // The logits [1, classes] of `frames` [history, inputs].
  std::string logits(std::string frames) {
    frame_ = {shape_.inputs};
    length_ = static_cast<std::int64_t>(history_of(shape_));
    value_ = std::move(frames);
    for (const Layer& layer : shape_.layers) {
      const Shape after = shape_after(layer, frame_);
      parameters_ = parameters_of(layer, frame_);
      std::visit([&](const auto& kind) { write(kind, after); }, layer);
      frame_ = after;
    }
    if (length_ != 1 || next_ != state_.size()) throw std::invalid_argument("a network that does not give one answer a step");
    return value_;
  }

 private:
  std::span<const float> take() {
    if (next_ == state_.size() || state_[next_].size() != extent_of(parameters_.front().shape))
      throw std::invalid_argument("a state that is not that of its network");
    parameters_.erase(parameters_.begin());
    return state_[next_++];
  }
  std::string take_as(const Ints& sizes) { return graph_.floats(sizes, take()); }

  void write(const Linear& linear, const Shape&) {
    const std::size_t inputs = frame_.back();
    const std::span<const float> weight = take();
    std::vector<float> turned(weight.size());
    for (std::size_t o = 0; o < linear.outputs; ++o) {
      for (std::size_t i = 0; i < inputs; ++i) turned[i * linear.outputs + o] = weight[o * inputs + i];
    }
    value_ = graph_.node("MatMul", {value_, graph_.floats(sizes_of({inputs, linear.outputs}), turned)});
    value_ = graph_.node("Add", {value_, take_as(sizes_of({linear.outputs}))});
  }
  void write(const Relu&, const Shape&) { value_ = graph_.node("Relu", {value_}); }
  void write(const Tanh&, const Shape&) { value_ = graph_.node("Tanh", {value_}); }
  void write(const BatchNorm& norm, const Shape&) {
    const std::span<const float> scale = take(), offset = take(), mean = take(), variance = take();
    Ints sizes{static_cast<std::int64_t>(scale.size())};
    sizes.resize(frame_.size() - norm.axis, 1);
    std::vector<float> slope, constant;
    for (std::size_t i = 0; i < scale.size(); ++i) {
      const double s = static_cast<double>(scale[i]) / std::sqrt(static_cast<double>(variance[i]) + 1e-5);
      slope.push_back(static_cast<float>(s));
      constant.push_back(static_cast<float>(static_cast<double>(offset[i]) - static_cast<double>(mean[i]) * s));
    }
    value_ = graph_.node("Mul", {value_, graph_.floats(sizes, slope)});
    value_ = graph_.node("Add", {value_, graph_.floats(sizes, constant)});
  }
  void write(const Gru& gru, const Shape& after) {
    recurrent("GRU", gru_order, gru.units, after, 1);
    graph_.with("linear_before_reset", 1);
    after_recurrent(after);
  }
  void write(const Lstm& lstm, const Shape& after) {
    recurrent("LSTM", lstm_order, lstm.units, after, 2);
    after_recurrent(after);
  }
  void recurrent(const std::string& kind, std::span<const std::size_t> order, std::size_t units, const Shape& after,
                 std::size_t carried) {
    const auto gates = static_cast<std::int64_t>(order.size()), u = static_cast<std::int64_t>(units);
    const std::vector<float> inward = reordered(take(), order), back = reordered(take(), order);
    std::vector<float> bias = reordered(take(), order);
    const std::vector<float> back_bias = reordered(take(), order);
    bias.insert(bias.end(), back_bias.begin(), back_bias.end());
    std::vector<std::string> inputs{graph_.reshaped(value_, {length_, 1, static_cast<std::int64_t>(frame_[0])}),
                                    graph_.floats({1, gates * u, static_cast<std::int64_t>(frame_[0])}, inward),
                                    graph_.floats({1, gates * u, u}, back), graph_.floats({1, 2 * gates * u}, bias)};
    std::vector<std::string> next;
    if (carried_) {
      inputs.emplace_back();  // lengths of sequences: all alike
      for (std::size_t i = 0; i < carried; ++i) {
        const std::string name = fmt::format("state_{}", states_++);
        graph_.input(name, {1, 1, u});
        graph_.output(name + "_next", {1, 1, u});
        inputs.push_back(name);
        next.push_back(name + "_next");
      }
    }
    value_ = graph_.nodes(kind, inputs, 1 + next.size()).front();
    for (std::size_t i = 0; i < next.size(); ++i) graph_.rename_output(static_cast<int>(i) + 1, next[i]);
    graph_.with("hidden_size", static_cast<std::int64_t>(after[0]));
  }
  void after_recurrent(const Shape& after) { value_ = graph_.reshaped(value_, with_front(length_, after)); }

  void write(const ConvLstm& lstm, const Shape& after) {
    const Ints sizes = with_front(1, after);
    const auto pad = static_cast<std::int64_t>(lstm.kernel / 2);
    const std::string weight = take_as(sizes_of({4 * lstm.channels, frame_[0] + lstm.channels, lstm.kernel, lstm.kernel}));
    const std::string bias = take_as(sizes_of({4 * lstm.channels}));
    std::array<std::string, 2> state;  // hidden, cell
    std::array<std::string, 2> names;
    for (std::size_t i = 0; i < 2; ++i) {
      if (carried_) {
        names[i] = fmt::format("state_{}", states_++);
        graph_.input(names[i], sizes);
        graph_.output(names[i] + "_next", sizes);
        state[i] = names[i];
      } else {
        state[i] = graph_.floats(sizes, std::vector<float>(extent_of(after), 0.0F));
      }
    }
    const std::vector<std::string> frames = split(value_, 0, length_, 1);
    std::vector<std::string> hidden;
    for (const std::string& frame : frames) {
      const std::string both = graph_.node("Concat", {frame, state[0]});
      graph_.with("axis", 1);
      const std::string gates = graph_.node("Conv", {both, weight, bias});
      graph_.with("pads", Ints{pad, pad, pad, pad});
      const std::vector<std::string> four = split(gates, 1, 4, static_cast<std::int64_t>(lstm.channels));
      const std::string kept = graph_.node("Mul", {graph_.node("Sigmoid", {four[1]}), state[1]});
      const std::string added = graph_.node("Mul", {graph_.node("Sigmoid", {four[0]}), graph_.node("Tanh", {four[2]})});
      state[1] = graph_.node("Add", {kept, added});
      state[0] = graph_.node("Mul", {graph_.node("Sigmoid", {four[3]}), graph_.node("Tanh", {state[1]})});
      hidden.push_back(state[0]);
    }
    for (std::size_t i = 0; carried_ && i < 2; ++i) {
      graph_.node("Identity", {state[i]});
      graph_.rename_output(0, names[i] + "_next");
    }
    value_ = hidden.front();
    if (hidden.size() > 1) {
      value_ = graph_.node("Concat", hidden);
      graph_.with("axis", 0);
    }
  }
  // `count` equal parts of `each` along an axis.
  std::vector<std::string> split(const std::string& value, std::int64_t axis, std::int64_t count, std::int64_t each) {
    if (count == 1) return {value};
    const std::string sizes = graph_.integers(Ints(static_cast<std::size_t>(count), each));
    std::vector<std::string> parts = graph_.nodes("Split", {value, sizes}, static_cast<std::size_t>(count));
    graph_.with("axis", axis);
    return parts;
  }

  void write(const Conv1d& conv, const Shape&) {
    const auto inputs = static_cast<std::int64_t>(frame_[0]), channels = static_cast<std::int64_t>(conv.channels);
    value_ = graph_.reshaped(graph_.transposed(value_, {1, 0}), {1, inputs, length_});
    const std::string weight = take_as(sizes_of({conv.channels, frame_[0], conv.kernel})), bias = take_as({channels});
    value_ = graph_.node("Conv", {value_, weight, bias});
    length_ -= static_cast<std::int64_t>(conv.kernel) - 1;
    if (length_ < 1) throw std::invalid_argument("a convolution along time after a layer that carries state");
    value_ = graph_.transposed(graph_.reshaped(value_, {channels, length_}), {1, 0});
  }
  void write(const Conv2d& conv, const Shape&) {
    const std::string weight = take_as(sizes_of({conv.channels, frame_[0], conv.kernel, conv.kernel})),
                      bias = take_as(sizes_of({conv.channels}));
    value_ = graph_.node("Conv", {value_, weight, bias});
    graph_.with("pads", Ints(4, static_cast<std::int64_t>(conv.padding)));
  }
  void write(const MaxPool&, const Shape&) {
    value_ = graph_.node("MaxPool", {value_});
    graph_.with("kernel_shape", Ints{2, 2}).with("strides", Ints{2, 2});
  }
  void write(const GlobalAverage&, const Shape& after) {
    value_ = graph_.reshaped(graph_.node("GlobalAveragePool", {value_}), with_front(length_, after));
  }
  void write(const PoolUnits& pool, const Shape& after) {
    std::vector<std::string> parts;
    if (pool.beside) parts.push_back(value_);
    for (const char* kind : {"ReduceMean", "ReduceMax"}) {
      std::string& part = parts.emplace_back(graph_.node(kind, {value_}));
      graph_.with("axes", Ints{1});
      if (pool.beside) part = graph_.node("Expand", {part, graph_.integers(with_front(length_, frame_))});
    }
    value_ = graph_.node("Concat", parts);
    graph_.with("axis", 2);
    if (!pool.beside) value_ = graph_.reshaped(value_, with_front(length_, after));
  }
  void write(const GraphConvolution& graph, const Shape&) {
    const std::vector<float> adjacency(graph.adjacency.begin(), graph.adjacency.end());
    const std::string weight = take_as(sizes_of({frame_[1], graph.units})), bias = take_as(sizes_of({graph.units}));
    value_ = graph_.node("MatMul", {value_, weight});
    value_ = graph_.node("MatMul", {graph_.floats(sizes_of({frame_[0], frame_[0]}), adjacency), value_});
    value_ = graph_.node("Add", {value_, bias});
  }
  void write(const Flatten&, const Shape& after) { value_ = graph_.reshaped(value_, with_front(length_, after)); }
  void write(const Reshape&, const Shape& after) { value_ = graph_.reshaped(value_, with_front(length_, after)); }
  void write(const Permute& permute, const Shape&) {
    Ints order{0};
    for (const std::size_t axis : permute.order) order.push_back(static_cast<std::int64_t>(axis) + 1);
    value_ = graph_.transposed(value_, order);
  }
  void write(const Last&, const Shape&) {
    if (length_ > 1) {
      value_ = graph_.node("Gather", {value_, graph_.integers({length_ - 1})});
      graph_.with("axis", 0);
    }
    length_ = 1;
  }

  Graph& graph_;
  const NetworkShape& shape_;
  const std::vector<std::vector<float>>& state_;
  bool carried_;
  std::size_t& states_;
  std::size_t next_ = 0;
  std::vector<Parameter> parameters_;  // of the layer, those not taken yet
  Shape frame_;
  std::int64_t length_ = 1;
  std::string value_;
};

}  // namespace

std::string write_onnx(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                       const std::string& metadata) {
  onnx::ModelProto model;
  model.set_ir_version(8);
  model.set_producer_name("slipbench");
  onnx::OperatorSetIdProto& opset = *model.add_opset_import();
  opset.set_domain("");
  opset.set_version(13);
  onnx::StringStringEntryProto& entry = *model.add_metadata_props();
  entry.set_key(network::metadata_key);
  entry.set_value(metadata);
  model.mutable_graph()->set_name("detector");
  Graph graph(*model.mutable_graph());
  const auto history = static_cast<std::int64_t>(history_of(shape)), inputs = static_cast<std::int64_t>(shape.inputs);
  const auto classes = static_cast<std::int64_t>(class_count(shape));
  graph.input("frames", {1, history * inputs});
  graph.output("output", {1, classes});
  const std::string frames = graph.reshaped("frames", {history, inputs});
  std::size_t states = 0;
  std::vector<std::string> said;
  for (const std::vector<std::vector<float>>& member : members) {
    const std::string logits = Writer(graph, shape, member, states).logits(frames);
    if (members.size() == 1) {
      graph.node("Identity", {logits});
      graph.rename_output(0, "output");
      break;
    }
    said.push_back(graph.node("Softmax", {logits}));
    graph.with("axis", 1);
  }
  if (members.size() > 1) {
    graph.node("Mean", said);
    graph.rename_output(0, "output");
  }
  onnx::checker::check_model(model);
  return model.SerializeAsString();
}

}  // namespace slipbench::train
