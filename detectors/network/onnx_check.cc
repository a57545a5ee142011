#include "detectors/network/onnx_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include <google/protobuf/stubs/logging.h>
#include <onnx/onnx_pb.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench::network {
namespace {

constexpr std::int64_t least_opset = 13;
constexpr std::int64_t most_opset = 23;
constexpr std::size_t most_nodes = 100'000;  // of all graphs

// Returns the bytes of an element; empty for a type that a numeric network does not use.
std::optional<std::size_t> bytes_of(int type) {
  using T = onnx::TensorProto;
  switch (type) {
    case T::BOOL:
    case T::INT8:
    case T::UINT8: return 1;
    case T::FLOAT16:
    case T::BFLOAT16:
    case T::INT16:
    case T::UINT16: return 2;
    case T::FLOAT:
    case T::INT32:
    case T::UINT32: return 4;
    case T::DOUBLE:
    case T::INT64:
    case T::UINT64: return 8;
    default: return std::nullopt;
  }
}

class Checker {
 public:
  explicit Checker(const std::string& subject) : subject_(subject) {}

  [[noreturn]] void refuse(const std::string& what) const { throw InputError(subject_ + ": " + what); }

  void check(const onnx::GraphProto& graph) {
    for (const onnx::TensorProto& tensor : graph.initializer()) check(tensor);
    if (graph.sparse_initializer_size() != 0) refuse("contains sparse tensors, which are not supported");
    for (const onnx::NodeProto& node : graph.node()) {
      if (++nodes_ > most_nodes) refuse("has more than " + std::to_string(most_nodes) + " operators, the most that is allowed");
      if (!is_onnx(node.domain())) {
        refuse("uses the operator " + quote(node.op_type()) + " of " + quote(node.domain()) +
               "; only operators of ONNX are supported");
      }
      if (node.op_type() == "Loop" || node.op_type() == "Scan") {
        refuse("uses the operator " + quote(node.op_type()) + ", which may not terminate; use GRU or LSTM instead");
      }
      check_random(graph, node);
      for (const onnx::AttributeProto& attribute : node.attribute()) check(attribute);
    }
  }

 private:
  // Equal samples must give equal classes.
  void check_random(const onnx::GraphProto& graph, const onnx::NodeProto& node) const {
    constexpr std::array random{"Bernoulli",        "Multinomial",   "RandomNormal",
                                "RandomNormalLike", "RandomUniform", "RandomUniformLike"};
    if (std::ranges::find(random, node.op_type()) != random.end()) {
      refuse("uses the operator " + quote(node.op_type()) +
             ", which draws random numbers; only deterministic operators are supported");
    }
    constexpr int training = 2;  // input of Dropout
    if (node.op_type() != "Dropout" || node.input_size() <= training || node.input(training).empty()) return;
    if (is_false(graph, node.input(training))) return;
    refuse(
        "uses the operator 'Dropout' in training mode, where it draws random numbers; call model.eval() before the export from PyTorch");
  }

  // True if `name` is a constant of the graph that is false.
  static bool is_false(const onnx::GraphProto& graph, const std::string& name) {
    const auto says_false = [](const onnx::TensorProto& flag) {
      return flag.has_raw_data() ? flag.raw_data() == std::string(1, '\0')
                                 : flag.int32_data_size() == 1 && flag.int32_data(0) == 0;
    };
    for (const onnx::TensorProto& tensor : graph.initializer()) {
      if (tensor.name() == name) return says_false(tensor);
    }
    for (const onnx::NodeProto& node : graph.node()) {
      if (node.op_type() != "Constant" || node.output_size() != 1 || node.output(0) != name) continue;
      return node.attribute_size() == 1 && node.attribute(0).has_t() && says_false(node.attribute(0).t());
    }
    return false;
  }

  static bool is_onnx(const std::string& domain) { return domain.empty() || domain == "ai.onnx"; }

  void check(const onnx::AttributeProto& attribute) {
    if (std::isnan(attribute.f()) || std::ranges::any_of(attribute.floats(), &is_nan<float>))
      refuse("has NaN in the attribute " + quote(attribute.name()));
    if (attribute.has_t()) check(attribute.t());
    for (const onnx::TensorProto& tensor : attribute.tensors()) check(tensor);
    if (attribute.has_sparse_tensor() || attribute.sparse_tensors_size() != 0)
      refuse("contains sparse tensors, which are not supported");
    if (attribute.has_g()) check(attribute.g());
    for (const onnx::GraphProto& graph : attribute.graphs()) check(graph);
  }

  void check(const onnx::TensorProto& tensor) const {
    const std::string name = "the tensor " + quote(tensor.name());
    if (tensor.data_location() == onnx::TensorProto::EXTERNAL || tensor.external_data_size() != 0) {
      refuse("keeps " + name + " in another file; write one file with onnx.save(model, file)");
    }
    const std::optional<std::size_t> width = bytes_of(tensor.data_type());
    if (!width) refuse("has " + name + " of data type " + std::to_string(tensor.data_type()) + "; allowed: numbers and booleans");
    std::size_t elements = 1;
    for (const std::int64_t extent : tensor.dims()) {
      if (extent < 0 || (extent > 0 && elements > most_elements / static_cast<std::size_t>(extent))) {
        refuse("has " + name + " with an extent of " + std::to_string(extent) + "; allowed: 0 or more, and " +
               std::to_string(most_elements) + " elements in all");
      }
      elements *= static_cast<std::size_t>(extent);
    }
    const std::size_t held = tensor.has_raw_data() ? tensor.raw_data().size() / *width : typed_elements(tensor);
    const bool whole = !tensor.has_raw_data() || tensor.raw_data().size() % *width == 0;
    if (held != elements || !whole) {
      refuse("has " + name + " of " + counted(elements, "element") + ", but data of " + std::to_string(held));
    }
    check_numbers(tensor);
  }

  // A layer can turn NaN into a number (ReLU gives 0), so the network would run. Infinities are
  // allowed because masks use them.
  void check_numbers(const onnx::TensorProto& tensor) const {
    using T = onnx::TensorProto;
    const std::string& raw = tensor.raw_data();
    const bool is_raw = tensor.has_raw_data();
    bool nan = false;
    switch (tensor.data_type()) {
      case T::FLOAT:
        nan = is_raw ? any_raw<float>(raw, &is_nan<float>) : std::ranges::any_of(tensor.float_data(), &is_nan<float>);
        break;
      case T::DOUBLE:
        nan = is_raw ? any_raw<double>(raw, &is_nan<double>) : std::ranges::any_of(tensor.double_data(), &is_nan<double>);
        break;
      case T::FLOAT16:
        nan = is_raw ? any_raw<std::uint16_t>(raw, &is_nan_half) : std::ranges::any_of(tensor.int32_data(), &is_nan_half);
        break;
      case T::BFLOAT16:
        nan = is_raw ? any_raw<std::uint16_t>(raw, &is_nan_brain) : std::ranges::any_of(tensor.int32_data(), &is_nan_brain);
        break;
      default: break;
    }
    if (nan) refuse("has the tensor " + quote(tensor.name()) + " with NaN");
  }

  template <class Number>
  static bool is_nan(Number value) {
    return std::isnan(value);
  }
  // NaN: all exponent bits and some of the mantissa are set. float16 has five and ten, bfloat16
  // eight and seven.
  static bool is_nan_half(std::int32_t bits) { return (bits & 0x7C00) == 0x7C00 && (bits & 0x03FF) != 0; }
  static bool is_nan_brain(std::int32_t bits) { return (bits & 0x7F80) == 0x7F80 && (bits & 0x007F) != 0; }

  template <class Element, class Predicate>
  static bool any_raw(const std::string& raw, Predicate predicate) {
    for (std::size_t at = 0; at + sizeof(Element) <= raw.size(); at += sizeof(Element)) {
      Element element{};
      std::memcpy(&element, raw.data() + at, sizeof element);
      if (predicate(element)) return true;
    }
    return false;
  }

  static std::size_t typed_elements(const onnx::TensorProto& tensor) {
    using T = onnx::TensorProto;
    switch (tensor.data_type()) {
      case T::FLOAT: return static_cast<std::size_t>(tensor.float_data_size());
      case T::DOUBLE: return static_cast<std::size_t>(tensor.double_data_size());
      case T::INT64: return static_cast<std::size_t>(tensor.int64_data_size());
      case T::UINT32:
      case T::UINT64: return static_cast<std::size_t>(tensor.uint64_data_size());
      default: return static_cast<std::size_t>(tensor.int32_data_size());
    }
  }

  const std::string& subject_;
  std::size_t nodes_ = 0;
};

// Silences protobuf's output about damaged bytes; the InputError reports them.
void be_quiet() {
  static const bool once = [] {
    google::protobuf::SetLogHandler(nullptr);
    return true;
  }();
  static_cast<void>(once);
}

Port port_of(const onnx::ValueInfoProto& value, const std::string& what, const Checker& checker) {
  const std::string name = what + " " + quote(value.name());
  if (!value.type().has_tensor_type() || value.type().tensor_type().elem_type() != onnx::TensorProto::FLOAT) {
    checker.refuse("the " + name + " is not a tensor of float32");
  }
  Port port{.name = value.name(), .shape = {}, .open = false};
  if (!value.type().tensor_type().has_shape()) checker.refuse("the " + name + " has no shape");
  std::size_t size = 1;
  for (const onnx::TensorShapeProto::Dimension& extent : value.type().tensor_type().shape().dim()) {
    const bool given = extent.has_dim_value() && extent.dim_value() != -1;
    port.open = port.open || (!given && !port.shape.empty());
    port.shape.push_back(given ? extent.dim_value() : 1);
    if (port.shape.back() < 1 || size > most_elements / static_cast<std::size_t>(port.shape.back())) {
      checker.refuse("the " + name + " has an extent of " + std::to_string(port.shape.back()) + "; allowed: 1 or more, and " +
                     std::to_string(most_elements) + " elements in all");
    }
    size *= static_cast<std::size_t>(port.shape.back());
  }
  return port;
}

// Returns how to add metadata to a file, in Python.
std::string how_to_describe(const std::string& file) {
  const std::string path = "'" + printable(file) + "'";  // whole, unlike quote()
  return "  import json, onnx\n"
         "  model = onnx.load(" +
         path +
         ")\n"
         "  about = " +
         example_description() +
         "\n"
         "  for old in [entry for entry in model.metadata_props if entry.key == \"slipbench\"]:\n"
         "      model.metadata_props.remove(old)\n"
         "  entry = model.metadata_props.add()\n"
         "  entry.key, entry.value = \"slipbench\", json.dumps(about)\n"
         "  onnx.save(model, " +
         path +
         ")\n"
         "detectors/network/README.md explains the keys.";
}

std::string metadata_of(const onnx::ModelProto& model, const std::string& subject, const Checker& checker) {
  const onnx::StringStringEntryProto* found = nullptr;
  for (const onnx::StringStringEntryProto& entry : model.metadata_props()) {
    if (entry.key() != metadata_key) continue;
    if (found != nullptr) checker.refuse("has the metadata 'slipbench' twice");
    found = &entry;
  }
  if (found == nullptr) {
    checker.refuse("has no metadata 'slipbench', which describe the inputs and classes of the network. Add them:\n" +
                   how_to_describe(subject));
  }
  return found->value();
}

// Returns all names of `values`, for messages.
template <class Values>
std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> names;
  for (const onnx::ValueInfoProto& value : values) names.push_back(value.name());
  return names;
}

// Returns the only name in `given` that is not in `states`.
template <class Values>
std::string only_other(const Values& given, const std::vector<std::string>& states, const std::string& what,
                       const Checker& checker) {
  const std::vector<std::string> names = names_of(given);
  for (const std::string& state : states) {
    if (std::ranges::find(names, state) == names.end()) {
      checker.refuse("has no " + what + " " + quote(state) + ", which 'states' in its metadata names" +
                     allowed_names(state, names));
    }
  }
  std::vector<std::string> others;
  std::ranges::copy_if(names, std::back_inserter(others),
                       [&](const std::string& name) { return std::ranges::find(states, name) == states.end(); });
  if (others.size() == 1) return others.front();
  std::string found;
  for (const std::string& name : others) found += (found.empty() ? ": " : ", ") + quote(name);
  checker.refuse("has " + std::to_string(others.size()) + " " + what + "s besides its states" + found + "; expected one");
}

}  // namespace

std::size_t Port::size() const {
  std::size_t product = 1;
  for (const std::int64_t extent : shape) product *= static_cast<std::size_t>(extent);
  return product;
}

CheckedNetwork check_network(std::string_view bytes, const std::string& subject) {
  be_quiet();
  Checker checker(subject);
  if (bytes.size() > most_network_bytes) {
    checker.refuse("has " + std::to_string(bytes.size()) + " bytes; allowed: at most " + std::to_string(most_network_bytes));
  }
  onnx::ModelProto model;
  if (!model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) || !model.has_graph()) {
    checker.refuse("is not an ONNX file, or is damaged");
  }
  CheckedNetwork checked{
      .description = parse_description(metadata_of(model, subject, checker), subject + ": metadata 'slipbench'"),
      .input = {},
      .output = {},
      .states = {}};
  std::int64_t opset = 0;
  for (const onnx::OperatorSetIdProto& set : model.opset_import()) {
    if (set.domain().empty() || set.domain() == "ai.onnx") opset = set.version();
  }
  if (opset < least_opset || opset > most_opset) {
    checker.refuse("uses the operator set " + std::to_string(opset) + " of ONNX; allowed: " + std::to_string(least_opset) +
                   " to " + std::to_string(most_opset));
  }
  if (model.functions_size() != 0) {
    checker.refuse("defines the operator " + quote(model.functions(0).name()) + "; only operators of ONNX are supported");
  }
  checker.check(model.graph());

  const Description& about = checked.description;
  std::vector<std::string> state_inputs;
  std::vector<std::string> state_outputs;
  for (const State& state : about.states) {
    state_inputs.push_back(state.input);
    state_outputs.push_back(state.output);
  }
  // Old files list the weights among the inputs.
  google::protobuf::RepeatedPtrField<onnx::ValueInfoProto> inputs;
  for (const onnx::ValueInfoProto& value : model.graph().input()) {
    const auto same = [&](const onnx::TensorProto& tensor) { return tensor.name() == value.name(); };
    if (std::ranges::none_of(model.graph().initializer(), same)) *inputs.Add() = value;
  }
  const std::string input = only_other(inputs, state_inputs, "input", checker);
  checked.output = only_other(model.graph().output(), state_outputs, "output", checker);
  const auto named = [&](const std::string& name) -> const onnx::ValueInfoProto& {
    return *std::ranges::find_if(inputs, [&](const onnx::ValueInfoProto& value) { return value.name() == name; });
  };
  checked.input = port_of(named(input), "input", checker);
  for (const std::string& state : state_inputs) checked.states.push_back(port_of(named(state), "input", checker));
  return checked;
}

}  // namespace slipbench::network
