#include "detectors/network/onnx_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include <google/protobuf/stubs/logging.h>
#include <onnx/onnx_pb.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench::network {
namespace {

constexpr std::int64_t least_opset = 13;
constexpr std::int64_t most_opset = 23;
constexpr int most_nodes = 100'000;

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

// An operator of ONNX that a network may use.
struct Operator {
  std::string_view name;
  int inputs = 1;  // that are required, the first ones
  // Input k must be constant if bit k is set: it is an index, a shape, an axis or a length.
  unsigned constant = 0;
};

constexpr unsigned input_1 = 1u << 1u;
constexpr unsigned inputs_1_to_4 = 0b11110u;
constexpr unsigned input_4 = 1u << 4u;
constexpr unsigned all_inputs = ~0u;

// Every tensor of these operators has the same shape and the same addresses at each step, because
// only constants decide them. Sorted by name. README.md lists the same names.
constexpr std::array operators = std::to_array<Operator>({
    {"Abs"},
    {"Acos"},
    {"Acosh"},
    {"Add", 2},
    {"And", 2},
    {"Asin"},
    {"Asinh"},
    {"Atan"},
    {"Atanh"},
    {"Attention", 3},
    {"AveragePool"},
    {"BatchNormalization", 5},
    {"Cast"},
    {"CastLike", 2},
    {"Ceil"},
    {"Celu"},
    {"Clip"},
    {"Concat"},
    {"Constant", 0},
    {"ConstantOfShape", 1, all_inputs},
    {"Conv", 2},
    {"ConvTranspose", 2},
    {"Cos"},
    {"Cosh"},
    {"DepthToSpace"},
    {"Div", 2},
    {"Dropout"},
    {"Einsum"},
    {"Elu"},
    {"Equal", 2},
    {"Erf"},
    {"Exp"},
    {"Expand", 2, input_1},
    {"Flatten"},
    {"Floor"},
    {"GRU", 3, input_4},
    {"Gather", 2, input_1},
    {"Gelu"},
    {"Gemm", 2},
    {"GlobalAveragePool"},
    {"GlobalMaxPool"},
    {"Greater", 2},
    {"GreaterOrEqual", 2},
    {"GroupNormalization", 3},
    {"HardSigmoid"},
    {"HardSwish"},
    {"Identity"},
    {"InstanceNormalization", 3},
    {"IsInf"},
    {"IsNaN"},
    {"LRN"},
    {"LSTM", 3, input_4},
    {"LayerNormalization", 2},
    {"LeakyRelu"},
    {"Less", 2},
    {"LessOrEqual", 2},
    {"Log"},
    {"LogSoftmax"},
    {"LpNormalization"},
    {"MatMul", 2},
    {"Max"},
    {"MaxPool"},
    {"Mean"},
    {"Min"},
    {"Mish"},
    {"Mod", 2},
    {"Mul", 2},
    {"Neg"},
    {"Not"},
    {"Or", 2},
    {"PRelu", 2},
    {"Pad", 2, inputs_1_to_4},
    {"Pow", 2},
    {"RMSNormalization", 2},
    {"RNN", 3, input_4},
    {"Range", 3, all_inputs},
    {"Reciprocal"},
    {"ReduceL1", 1, input_1},
    {"ReduceL2", 1, input_1},
    {"ReduceLogSum", 1, input_1},
    {"ReduceLogSumExp", 1, input_1},
    {"ReduceMax", 1, input_1},
    {"ReduceMean", 1, input_1},
    {"ReduceMin", 1, input_1},
    {"ReduceProd", 1, input_1},
    {"ReduceSum", 1, input_1},
    {"ReduceSumSquare", 1, input_1},
    {"Relu"},
    {"Reshape", 2, input_1},
    {"Resize", 1, inputs_1_to_4},
    {"Round"},
    {"Selu"},
    {"Shape"},
    {"Sigmoid"},
    {"Sign"},
    {"Sin"},
    {"Sinh"},
    {"Size"},
    {"Slice", 3, inputs_1_to_4},
    {"Softmax"},
    {"Softplus"},
    {"Softsign"},
    {"SpaceToDepth"},
    {"Split", 1, input_1},
    {"Sqrt"},
    {"Squeeze", 1, input_1},
    {"Sub", 2},
    {"Sum"},
    {"Swish"},
    {"Tan"},
    {"Tanh"},
    {"ThresholdedRelu"},
    {"Tile", 2, input_1},
    {"Transpose"},
    {"Trilu", 1, input_1},
    {"Unsqueeze", 2, input_1},
    {"Where", 3},
    {"Xor", 2},
});
static_assert(std::ranges::is_sorted(operators, {}, &Operator::name));

// Returns why an operator is not in the list, where the reason helps; else "".
std::string reason_against(const std::string& type) {
  constexpr std::array random{"Bernoulli",        "Multinomial",   "RandomNormal",
                              "RandomNormalLike", "RandomUniform", "RandomUniformLike"};
  constexpr std::array control{"If", "Loop", "Scan"};
  constexpr std::array indexed{"CumSum",  "GatherElements",  "GatherND",  "MaxUnpool",       "OneHot",    "RoiAlign",
                               "Scatter", "ScatterElements", "ScatterND", "ReverseSequence", "GridSample"};
  const auto is_one_of = [&](const auto& names) { return std::ranges::find(names, type) != names.end(); };
  if (is_one_of(random)) return ", which draws random numbers";
  if (is_one_of(control)) return ", which contains other graphs and may not terminate; use GRU or LSTM instead";
  if (is_one_of(indexed)) return ", which can address memory outside of its tensors; use Gather with constant indices instead";
  return "";
}

class Checker {
 public:
  explicit Checker(const std::string& subject) : subject_(subject) {}

  [[noreturn]] void refuse(const std::string& what) const { throw InputError(subject_ + ": " + what); }

  void check(const onnx::GraphProto& graph) {
    for (const onnx::TensorProto& tensor : graph.initializer()) {
      check(tensor);
      define(tensor.name(), Origin::constant, "the weights");
    }
    // Old files list the weights among the inputs.
    for (const onnx::ValueInfoProto& value : graph.input()) values_.try_emplace(value.name(), Origin::computed);
    if (graph.sparse_initializer_size() != 0) refuse("contains sparse tensors, which are not supported");
    if (graph.node_size() > most_nodes)
      refuse("has more than " + std::to_string(most_nodes) + " operators, the most that is allowed");
    for (const onnx::NodeProto& node : graph.node()) check(graph, node);
  }

 private:
  enum class Origin { constant, computed };  // computed: from the network's inputs

  // Returns the words for a node in messages.
  static std::string about(const onnx::NodeProto& node) {
    const bool named = !node.name().empty() || node.output_size() == 0;
    return "the operator " + quote(node.op_type()) + " (" +
           (named ? "node " + quote(node.name()) : "output " + quote(node.output(0))) + ")";
  }

  void define(const std::string& name, Origin origin, const std::string& by) {
    if (!values_.try_emplace(name, origin).second)
      refuse("defines the value " + quote(name) + " twice, the second time in " + by);
  }

  void check(const onnx::GraphProto& graph, const onnx::NodeProto& node) {
    if (!is_onnx(node.domain())) {
      refuse("uses " + about(node) + " of " + quote(node.domain()) + "; only operators of ONNX are supported");
    }
    const auto found = std::ranges::lower_bound(operators, std::string_view(node.op_type()), {}, &Operator::name);
    if (found == operators.end() || found->name != node.op_type()) {
      const std::string reason = reason_against(node.op_type());
      const std::string near = reason.empty() ? nearest_name(node.op_type(), names()) : "";
      refuse("uses " + about(node) + reason + (near.empty() ? "" : "; did you mean " + quote(near) + "?") +
             "; allowed: the operators that detectors/network/README.md lists");
    }
    // OpenVINO reads required inputs without a check.
    const auto begin = node.input().begin();
    if (node.input_size() < found->inputs ||
        std::any_of(begin, begin + found->inputs, [](const auto& name) { return name.empty(); })) {
      refuse(about(node) + " needs " + counted(static_cast<std::size_t>(found->inputs), "input"));
    }
    Origin made = Origin::constant;
    for (int k = 0; k < node.input_size(); ++k) {
      const std::string& name = node.input(k);
      if (name.empty()) continue;  // an optional input that is absent
      const auto value = values_.find(name);
      if (value == values_.end()) {
        refuse(about(node) + " reads " + quote(name) + ", which no input, weight or earlier operator defines");
      }
      if (value->second == Origin::constant) continue;
      made = Origin::computed;
      const bool constant = found->constant == all_inputs || (k < 32 && (found->constant >> static_cast<unsigned>(k) & 1u) != 0);
      if (constant) {
        refuse(about(node) + " has the input " + quote(name) +
               " that depends on the network's inputs; indices, shapes, axes and lengths must be constant");
      }
    }
    // Extents are fixed.
    if (node.op_type() == "Shape" || node.op_type() == "Size") made = Origin::constant;
    check_dropout(graph, node);
    for (const onnx::AttributeProto& attribute : node.attribute()) check(attribute, node);
    for (const std::string& name : node.output()) {
      if (!name.empty()) define(name, made, about(node));
    }
  }

  static std::vector<std::string> names() {
    std::vector<std::string> all;
    for (const Operator& one : operators) all.emplace_back(one.name);
    return all;
  }

  // Equal samples must give equal classes.
  void check_dropout(const onnx::GraphProto& graph, const onnx::NodeProto& node) const {
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

  void check(const onnx::AttributeProto& attribute, const onnx::NodeProto& node) const {
    if (std::isnan(attribute.f()) || std::ranges::any_of(attribute.floats(), &is_nan<float>))
      refuse("has NaN in the attribute " + quote(attribute.name()));
    if (attribute.has_t()) check(attribute.t());
    for (const onnx::TensorProto& tensor : attribute.tensors()) check(tensor);
    const bool text = node.op_type() == "Constant" && attribute.name().starts_with("value_string");
    if (text || (node.op_type() == "Cast" && attribute.name() == "to" && !bytes_of(static_cast<int>(attribute.i())))) {
      refuse(about(node) + " makes values of an unsupported type; allowed: numbers and booleans");
    }
    if (attribute.has_sparse_tensor() || attribute.sparse_tensors_size() != 0)
      refuse("contains sparse tensors, which are not supported");
    if (attribute.has_g() || attribute.graphs_size() != 0) {
      refuse(about(node) + " has the graph " + quote(attribute.name()) + "; graphs inside operators are not supported");
    }
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
  std::map<std::string, Origin> values_;  // all values that are defined so far
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
