// The only file that includes OpenVINO's headers.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <new>
#include <sstream>
#include <string_view>
#include <utility>

#include <openssl/evp.h>
#include <openvino/op/constant.hpp>
#include <openvino/op/gru_sequence.hpp>
#include <openvino/op/lstm_sequence.hpp>
#include <openvino/op/matmul.hpp>
#include <openvino/op/rnn_sequence.hpp>
#include <openvino/op/util/avg_pool_base.hpp>
#include <openvino/op/util/gather_base.hpp>
#include <openvino/op/util/max_pool_base.hpp>
#include <openvino/openvino.hpp>
#include <openvino/pass/constant_folding.hpp>
#include <openvino/runtime/intel_cpu/properties.hpp>

#include "detectors/network/engine.h"
#include "detectors/network/onnx_check.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/process/regular_file.h"

namespace slipbench::network {
namespace {

using Digest = std::array<unsigned char, 32>;

// The shortest text of a number. This library must not need libfmt, which its host may hide.
std::string text_of(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string bytes_of(const std::string& path) {
  check_regular_file(path, most_network_bytes);
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError(path +
                     ": cannot be opened; expected an ONNX file, relative to the scene's folder, in --set to the current one");
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw InputError(path + ": cannot be read");
  return bytes;
}

Digest digest_of(const std::string& bytes) {
  Digest digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  return digest;
}

// Removes each "Check 'CONDITION' failed at FILE:LINE:" and the white space after it.
std::string without_conditions(std::string text) {
  constexpr std::string_view check = "Check '", failed = "' failed at ";
  for (std::size_t begin = text.find(check); begin != std::string::npos; begin = text.find(check, begin)) {
    const std::size_t place = text.find(failed, begin);
    if (place == std::string::npos) break;
    const std::size_t line = text.find(':', place), end = text.find(':', line == std::string::npos ? line : line + 1);
    const std::size_t next = end == std::string::npos ? end : text.find_first_not_of(" \n", end + 1);
    text.erase(begin, next == std::string::npos ? next : next - begin);
  }
  return text;
}

// Returns OpenVINO's message without places in its sources and conditions.
std::string reason_of(const std::exception& error) {
  constexpr std::size_t longest = 400;
  std::istringstream lines(without_conditions(error.what()));
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const auto begins = [&](const char* word) { return line.starts_with(word); };
    if (line.empty() || begins("Exception from ") || begins("FrontEnd API ") || begins("Summary:")) continue;
    if (begins("Model wasn't fully converted.")) continue;
    if (begins("To facilitate ")) continue;
    text += (text.empty() ? "" : " ") + line;
  }
  if (text.size() <= longest) return printable(text);
  text.resize(longest);
  return printable(text.substr(0, text.rfind(' '))) + " ...";
}

// Must be called in the handler that caught `error`.
[[noreturn]] void refuse(const std::string& what, const std::exception& error) {
  if (dynamic_cast<const InputError*>(&error) != nullptr) throw;
  throw InputError(what + reason_of(error));
}

struct Network {
  CheckedNetwork about;
  ov::CompiledModel compiled;
};

// Sizes are doubles, which do not overflow.
constexpr double open_extent = 1e18;

double length_of(const ov::Dimension& extent) {
  return extent.get_max_length() < 0 ? open_extent : static_cast<double>(extent.get_max_length());
}

// Returns the largest number of values of a tensor.
double size_of(const ov::PartialShape& shape) {
  if (shape.rank().is_dynamic()) return open_extent;
  double size = 1.0;
  for (const ov::Dimension& extent : shape) size *= length_of(extent);
  return size;
}

// Returns the largest number of multiply-adds of an operator per step. Each value read or made
// counts as one.
double work_of(const ov::Node& node) {
  double read = 0.0, made = 0.0;
  for (const ov::Input<const ov::Node>& input : node.inputs()) read += size_of(input.get_partial_shape());
  for (const ov::Output<const ov::Node>& output : node.outputs()) made += size_of(output.get_partial_shape());
  const auto size = [&](std::size_t input) { return size_of(node.get_input_partial_shape(input)); };
  // `axis`: from the front, or from the end if negative.
  const auto extent = [&](std::size_t input, std::int64_t axis) {
    const ov::PartialShape& shape = node.get_input_partial_shape(input);
    if (shape.rank().is_dynamic()) return open_extent;
    const std::int64_t rank = shape.rank().get_length();
    return length_of(shape[std::clamp<std::int64_t>(axis < 0 ? rank + axis : axis, 0, rank - 1)]);
  };
  const auto kernel = [](const ov::Shape& shape) {
    double values = 1.0;
    for (const std::size_t one : shape) values *= static_cast<double>(one);
    return values;
  };
  const std::string type = node.get_type_info().name;
  const auto is_one_of = [&](std::initializer_list<const char*> types) {
    return std::ranges::any_of(types, [&](const char* one) { return type == one; });
  };
  double work = 0.0;
  if (const auto* product = ov::as_type<const ov::op::v0::MatMul>(&node)) {
    work = made * extent(0, product->get_transpose_a() ? -2 : -1);
  } else if (is_one_of({"Convolution"})) {
    work = made * size(1) / extent(1, 0);
  } else if (is_one_of({"GroupConvolution"})) {
    work = made * size(1) / (extent(1, 0) * extent(1, 1));
  } else if (is_one_of({"ConvolutionBackpropData"})) {
    work = size(0) * size(1) / extent(1, 0);
  } else if (is_one_of({"GroupConvolutionBackpropData"})) {
    work = size(0) * size(1) / (extent(1, 0) * extent(1, 1));
  } else if (is_one_of({"GRUSequence", "LSTMSequence", "RNNSequence"})) {
    work = extent(0, 0) * extent(0, 1) * read;
  } else if (is_one_of({"GRUCell", "LSTMCell", "RNNCell"})) {
    work = extent(0, 0) * read;
  } else if (is_one_of({"ScaledDotProductAttention"})) {
    work = (size(0) + made) * extent(1, -2);
  } else if (const auto* most = ov::as_type<const ov::op::util::MaxPoolBase>(&node)) {
    work = made * kernel(most->get_kernel());
  } else if (const auto* mean = ov::as_type<const ov::op::util::AvgPoolBase>(&node)) {
    work = made * kernel(mean->get_kernel());
  } else if (is_one_of({"LRN"})) {
    work = made * extent(0, 1);
  } else if (is_one_of({"Einsum"})) {
    work = made * read;
  }
  return read + made + (std::isnan(work) ? 0.0 : work);  // 0/0: without weights
}

// Limits memory and multiply-adds of a step. A small file may ask for any amount: a constant with a
// large shape, repeated tensors, products of their results.
void check_sizes(const ov::Model& model, const std::string& path) {
  double work = 0.0;
  for (const std::shared_ptr<ov::Node>& node : model.get_ops()) {
    for (const ov::Output<ov::Node>& output : node->outputs()) {
      if (size_of(output.get_partial_shape()) <= static_cast<double>(most_elements)) continue;
      throw InputError(path + ": the operator " + quote(node->get_friendly_name()) + " makes a tensor of more than " +
                       std::to_string(most_elements) + " elements, or of unknown shape");
    }
    work += work_of(*node);
  }
  if (work <= most_multiply_adds) return;
  std::ostringstream found;
  found << work;
  throw InputError(path + ": a step of the network takes " + found.str() + " multiply-adds; allowed: at most " +
                   std::to_string(static_cast<std::int64_t>(most_multiply_adds)));
}

// Checks the constants that decide which elements an operator reads. OpenVINO does not compare them
// with the extents. onnx_check.cc ensures that they are constant.
void check_indices(const ov::Model& model, const std::string& path) {
  const auto check = [&](const ov::Node& node, std::size_t input, std::int64_t least, std::int64_t most, const char* what) {
    const auto constant = ov::as_type_ptr<const ov::op::v0::Constant>(node.get_input_node_shared_ptr(input));
    if (constant == nullptr)
      throw InputError(path + ": the operator " + quote(node.get_friendly_name()) + " has " + what + "s that are not constant");
    for (const std::int64_t value : constant->cast_vector<std::int64_t>()) {
      if (value >= least && value <= most) continue;
      throw InputError(path + ": the operator " + quote(node.get_friendly_name()) + " has the " + what + " " +
                       std::to_string(value) +
                       (least > most ? ", but its data have an extent of 0 along the axis"
                                     : "; allowed: " + std::to_string(least) + " to " + std::to_string(most)));
    }
  };
  const std::shared_ptr<ov::Model> folded = model.clone();
  ov::pass::ConstantFolding().run_on_model(folded);
  for (const std::shared_ptr<ov::Node>& node : folded->get_ops()) {
    if (const auto gather = ov::as_type_ptr<ov::op::util::GatherBase>(node)) {
      const ov::Shape& shape = node->get_input_shape(0);
      const std::int64_t axis = gather->get_axis(), rank = static_cast<std::int64_t>(shape.size());
      const auto extent = static_cast<std::int64_t>(shape.at(axis < 0 ? rank + axis : axis));
      check(*node, 1, -extent, extent - 1, "index");
    }
    // Inputs of OpenVINO's operators: X, the states H and, with LSTM, C, then the lengths.
    constexpr std::size_t with_one_state = 2, with_two_states = 3;
    const bool one_state = ov::is_type<ov::op::v5::GRUSequence>(node) || ov::is_type<ov::op::v5::RNNSequence>(node);
    const bool two_states = ov::is_type<ov::op::v5::LSTMSequence>(node);
    if (!one_state && !two_states) continue;
    check(*node, one_state ? with_one_state : with_two_states, 0, static_cast<std::int64_t>(node->get_input_shape(0).at(1)),
          "length");
  }
}

Network compiled(const std::string& bytes, const std::string& path) {
  Network network{.about = check_network(bytes, path), .compiled = {}};
  // Never destroyed, because its threads may outlive what the end of the program destroys.
  static ov::Core* const core = new ov::Core;
  const std::shared_ptr<ov::Model> model = core->read_model(bytes, ov::Tensor());
  std::map<std::string, ov::PartialShape> shapes;
  const auto fix = [&](const Port& port) {
    // OpenVINO removes an input that no output needs.
    const auto has_name = [&](const auto& input) { return input.get_names().contains(port.name); };
    if (std::ranges::none_of(model->inputs(), has_name)) {
      throw InputError(path + ": no output of the network depends on its input " + quote(port.name) +
                       "; export a network that uses each of its inputs");
    }
    shapes.emplace(port.name, ov::PartialShape(std::vector<ov::Dimension>(port.shape.begin(), port.shape.end())));
  };
  fix(network.about.input);
  for (const Port& state : network.about.states) fix(state);
  try {
    model->reshape(shapes);
  } catch (const std::exception& error) {
    if (!network.about.input.open) throw;
    throw InputError(path + ": the extents that " + quote(network.about.input.name) +
                     " leaves open are taken as 1, but OpenVINO rejects the network with them: " + reason_of(error) +
                     "; export the input with fixed extents");
  }
  check_sizes(*model, path);
  check_indices(*model, path);
  // One thread, f32 and no pinning make results independent of other load. Denormals are kept, as
  // everywhere in the program.
  network.compiled = core->compile_model(model, "CPU", ov::inference_num_threads(1), ov::num_streams(1),
                                         ov::hint::inference_precision(ov::element::f32),
                                         ov::hint::performance_mode(ov::hint::PerformanceMode::LATENCY),
                                         ov::hint::enable_cpu_pinning(false), ov::intel_cpu::denormals_optimization(false));
  return network;
}

// Returns the network at `path`, compiled once per thread while the file is unchanged.
Network& network_at(const std::string& path) {
  thread_local std::map<std::string, std::pair<Digest, Network>> kept;
  const std::string bytes = bytes_of(path);
  const Digest digest = digest_of(bytes);
  const auto found = kept.find(path);
  if (found != kept.end() && found->second.first == digest) return found->second.second;
  return kept.insert_or_assign(path, std::pair(digest, compiled(bytes, path))).first->second.second;
}

class OpenVinoEngine final : public Engine {
 public:
  OpenVinoEngine(Network& network, std::string path)
      : about_(network.about.description), path_(std::move(path)), request_(network.compiled.create_infer_request()) {
    input_ = tensor(network.compiled.input(network.about.input.name));
    std::fill_n(input_.data<float>(), input_.get_size(), 0.0F);
    output_ = tensor(network.compiled.output(network.about.output));
    if (output_.get_size() != about_.classes.size()) {
      throw InputError(path_ + ": returns " + counted(output_.get_size(), "value") + "; expected " +
                       std::to_string(about_.classes.size()) + ", one for each class of its description");
    }
    for (const State& state : about_.states) {
      states_.emplace_back(tensor(network.compiled.input(state.input)), tensor(network.compiled.output(state.output)));
      const auto& [in, out] = states_.back();
      if (in.get_size() != out.get_size()) {
        throw InputError(path_ + ": the state " + quote(state.input) + " has " + counted(in.get_size(), "value") + ", but " +
                         quote(state.output) + " has " + std::to_string(out.get_size()));
      }
    }
    reset();
    request_.infer();  // finds out here if the network cannot run
  }

  [[nodiscard]] const Description& description() const override { return about_; }
  [[nodiscard]] std::size_t inputs() const override { return input_.get_size(); }

  void reset() override {
    for (auto& [in, out] : states_) std::fill_n(in.data<float>(), in.get_size(), 0.0F);
  }

  std::span<const float> run(std::span<const float> input) override {
    if (input.size() != inputs()) throw std::logic_error("a network's input of another size");
    check_finite(input, "receives");
    std::ranges::copy(input, input_.data<float>());
    try {
      request_.infer();
    } catch (const std::exception& error) {
      refuse(path_ + ": the network cannot be run: ", error);
    }
    for (auto& [in, out] : states_) std::copy_n(out.data<float>(), out.get_size(), in.data<float>());
    const std::span<const float> output{output_.data<float>(), output_.get_size()};
    check(output);
    return output;
  }

 private:
  // Binds a tensor owned by the engine to `port`; its address is constant.
  ov::Tensor tensor(const ov::Output<const ov::Node>& port) {
    if (port.get_element_type() != ov::element::f32 || port.get_partial_shape().is_dynamic()) {
      throw InputError(path_ + ": " + quote(port.get_any_name()) + " must be float32 with a fixed shape");
    }
    ov::Tensor made(ov::element::f32, port.get_shape());
    request_.set_tensor(port, made);
    return made;
  }

  // A network can turn NaN into a number: ReLU gives 0.
  void check_finite(std::span<const float> values, const char* verb) const {
    const auto found = std::ranges::find_if_not(values, [](float value) { return std::isfinite(value); });
    if (found == values.end()) return;
    throw InputError(path_ + ": the network " + verb + " " + text_of(*found) + "; allowed: finite numbers");
  }

  void check(std::span<const float> output) const {
    check_finite(output, "returns");
    constexpr double rounding = 1e-3;  // of a sum of probabilities
    double sum = 0.0;
    bool probabilities = true;
    for (const float value : output) {
      if (!std::isfinite(value))
        throw InputError(path_ + ": the network returns " + text_of(value) + "; allowed: finite numbers");
      sum += double{value};
      probabilities = probabilities && double{value} >= -rounding;
    }
    if (about_.output == Output::probabilities && (!probabilities || std::abs(sum - 1.0) > rounding)) {
      throw InputError(path_ + ": the network returns values that are not probabilities, with the sum " + text_of(sum) +
                       "; expected values of 0 or more with the sum 1, or \"output\": \"logits\" in its description");
    }
  }

  Description about_;
  std::string path_;
  ov::InferRequest request_;
  ov::Tensor input_, output_;
  std::vector<std::pair<ov::Tensor, ov::Tensor>> states_;  // input and output of each state
};

}  // namespace
}  // namespace slipbench::network

extern "C" __attribute__((visibility("default"))) slipbench::network::Engine* slipbench_load_engine(const std::string& path) {
  using namespace slipbench::network;
  try {
    return new OpenVinoEngine(network_at(path), path);
  } catch (const std::exception& error) {
    refuse(path + ": OpenVINO rejects it: ", error);
  }
}
