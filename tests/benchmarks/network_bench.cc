// Time of one frame through a network in the loop: run with --benchmark_repetitions=9 and read the
// medians.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <onnx/onnx_pb.h>

#include "detectors/detector_kinds.h"
#include "detectors/network/description.h"
#include "detectors/network/frames.h"

namespace slipbench::network {
namespace {

constexpr std::int64_t bins = 12;
constexpr std::int64_t width = 32;
constexpr int layers = 4;

FrameSource piezo_skin() {
  return {.sensor = "skin",
          .type = "piezo_skin",
          .rate = 10e3,
          .channels = {{.name = "signal", .unit = "", .shape = {1}, .channel_names = {}}}};
}

// The published features: 20 ms every 10 ms at 10 kHz, twelve bins of 50 Hz.
Description description() {
  Description d;
  d.input.sensor = "piezo_skin";
  d.input.rate = 10e3;
  d.input.channels = {{"signal", {}}};
  d.input.window = 200;
  d.input.stride = 100;
  d.input.centre = true;
  d.input.transform = Transform::log_psd;
  d.input.low = 50.0;
  d.input.high = 600.0;
  d.input.floor = 1e-3;
  for (int layer = 0; layer < layers; ++layer) {
    d.states.push_back({"h" + std::to_string(layer), "next" + std::to_string(layer)});
  }
  d.classes = {{"hold", PadState::non_slip}, {"slip", PadState::gross}};
  return d;
}

class Builder {
 public:
  Builder() {
    model_.set_ir_version(8);
    model_.add_opset_import()->set_version(17);
    model_.mutable_graph()->set_name("fft_gru");
  }

  std::string weights(const std::string& name, const std::vector<std::int64_t>& shape) {
    onnx::TensorProto* const tensor = model_.mutable_graph()->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::FLOAT);
    std::int64_t size = 1;
    for (const std::int64_t extent : shape) {
      tensor->add_dims(extent);
      size *= extent;
    }
    for (std::int64_t i = 0; i < size; ++i) tensor->add_float_data(0.2F * std::sin(static_cast<float>(i)));
    return name;
  }

  std::string whole(const std::string& name, std::int64_t value) {
    onnx::TensorProto* const tensor = model_.mutable_graph()->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::INT64);
    tensor->add_dims(1);
    tensor->add_int64_data(value);
    return name;
  }

  onnx::NodeProto& node(const std::string& type, const std::vector<std::string>& inputs,
                        const std::vector<std::string>& outputs) {
    onnx::NodeProto* const made = model_.mutable_graph()->add_node();
    made->set_op_type(type);
    for (const std::string& input : inputs) made->add_input(input);
    for (const std::string& output : outputs) made->add_output(output);
    return *made;
  }

  static void attribute(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
    onnx::AttributeProto* const made = node.add_attribute();
    made->set_name(name);
    made->set_type(onnx::AttributeProto::INT);
    made->set_i(value);
  }

  static void port(onnx::ValueInfoProto& value, const std::string& name, const std::vector<std::int64_t>& shape) {
    value.set_name(name);
    auto& tensor = *value.mutable_type()->mutable_tensor_type();
    tensor.set_elem_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t extent : shape) tensor.mutable_shape()->add_dim()->set_dim_value(extent);
  }

  onnx::ModelProto& model() { return model_; }

 private:
  onnx::ModelProto model_;
};

// Four stacked GRUs of 32 on twelve bins.
std::string fft_gru() {
  Builder b;
  onnx::GraphProto& graph = *b.model().mutable_graph();
  Builder::port(*graph.add_input(), "frame", {1, bins});
  b.whole("zero", 0);
  b.whole("one", 1);
  b.node("Unsqueeze", {"frame", "zero"}, {"x0"});  // [1, 1, bins]
  for (int layer = 0; layer < layers; ++layer) {
    const std::string l = std::to_string(layer);
    Builder::port(*graph.add_input(), "h" + l, {1, 1, width});
    Builder::port(*graph.add_output(), "next" + l, {1, 1, width});
    b.weights("W" + l, {1, 3 * width, layer == 0 ? bins : width});
    b.weights("R" + l, {1, 3 * width, width});
    b.weights("B" + l, {1, 6 * width});
    onnx::NodeProto& gru = b.node("GRU", {"x" + l, "W" + l, "R" + l, "B" + l, "", "h" + l}, {"y" + l, "next" + l});
    Builder::attribute(gru, "hidden_size", width);
    Builder::attribute(gru, "linear_before_reset", 1);
    b.node("Squeeze", {"y" + l, "one"}, {"x" + std::to_string(layer + 1)});
  }
  b.node("Squeeze", {"x" + std::to_string(layers), "zero"}, {"last"});
  onnx::NodeProto& gemm = b.node("Gemm", {"last", b.weights("W", {2, width}), b.weights("B", {2})}, {"logits"});
  Builder::attribute(gemm, "transB", 1);
  Builder::port(*graph.add_output(), "logits", {1, 2});
  onnx::StringStringEntryProto* const entry = b.model().add_metadata_props();
  entry->set_key(metadata_key);
  entry->set_value(description_text(description()));
  return b.model().SerializeAsString();
}

// Noise that does not repeat within a window.
std::vector<float> signal() {
  std::vector<float> values(4096);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::sin(static_cast<float>(n * n % 8191));
  return values;
}

void frame(benchmark::State& state) {
  const std::string path = std::filesystem::temp_directory_path() / "network_bench.onnx";
  std::ofstream(path, std::ios::binary) << fft_gru();
  Parameters parameters = defaults_of(network_detector().about.parameters);
  parameters.set("model", path);
  const std::unique_ptr<Detector> detector = network_detector().create(parameters, piezo_skin());
  std::filesystem::remove(path);
  const std::vector<float> values = signal();
  std::size_t n = 0;
  for (auto _ : state) {
    for (int i = 0; i < 100; ++i) {
      const std::span<const float> sample(&values[n++ % values.size()], 1);
      benchmark::DoNotOptimize(detector->update({.time = 0.0, .values = sample}));
    }
  }
}

void spectrum_alone(benchmark::State& state) {
  Frames frames(description().input, "piezo_skin", 10e3, piezo_skin().channels);
  const std::vector<float> values = signal();
  std::size_t n = 0;
  for (auto _ : state) {
    for (int i = 0; i < 100; ++i) benchmark::DoNotOptimize(frames.push({&values[n++ % values.size()], 1}));
  }
}

BENCHMARK(frame);
BENCHMARK(spectrum_alone);

}  // namespace
}  // namespace slipbench::network

BENCHMARK_MAIN();
