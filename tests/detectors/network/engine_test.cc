// Networks in ONNX files: their output, and the files that are refused.

#include <array>
#include <cfenv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <onnx/onnx_pb.h>
#include <unistd.h>

#include "detectors/network/engine.h"
#include "tests/detectors/network/networks.h"
#include "tests/expect.h"

namespace slipbench::network {
namespace {

onnx::ModelProto model_of(const std::string& name) {
  onnx::ModelProto model;
  std::ifstream file(shipped(name), std::ios::binary);
  if (!model.ParseFromIstream(&file)) throw std::logic_error("cannot read " + name);
  return model;
}

// A file that is removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_ = testing::TempDir() + "network-" + std::to_string(::getpid()) + ".onnx";
};

std::string refusal_of(const std::string& path) {
  return slipbench::refusal_of([&] { load_engine(path); });
}

// Returns the error for the network `name` after `change`.
std::string refusal_of(const std::string& name, const std::function<void(onnx::ModelProto&)>& change) {
  onnx::ModelProto model = model_of(name);
  change(model);
  return refusal_of(TemporaryFile(model.SerializeAsString()).path());
}

void describe(onnx::ModelProto& model, const std::string& from, const std::string& to) {
  std::string& text = *model.mutable_metadata_props(0)->mutable_value();
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error(text + " has no " + from);
  text.replace(at, from.size(), to);
}

TEST(Engine, AMultilayerPerceptronSaysWhatItsFormulaSays) {
  const std::unique_ptr<Engine> engine = load_engine(shipped("mlp13.onnx"));
  ASSERT_EQ(engine->inputs(), 6u);
  for (const float x : {0.0F, 1.0F, -2.0F}) {
    const std::array<float, 6> input{x, 0.5F, 1.0F, -1.0F, x * x, 3.0F};
    const std::array<double, 2> expected = mlp(input);
    const std::span<const float> said = engine->run(input);
    ASSERT_EQ(said.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(said[i], expected[i], 1e-5);
  }
}

TEST(Engine, ARecurrentStateIsCarriedUntilItIsReset) {
  const std::unique_ptr<Engine> engine = load_engine(shipped("gru21.onnx"));
  for (int trial = 0; trial < 2; ++trial) {
    Gru gru;
    engine->reset();
    for (const float x : {0.0F, 1.0F, -2.0F, 4.0F}) {
      const std::array<float, 3> input{x, 1.0F, 0.25F * x};
      const std::array<double, 2> expected = gru.step(input);
      const std::span<const float> said = engine->run(input);
      for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(said[i], expected[i], 1e-5);
    }
  }
}

TEST(Engine, EnginesOfOneNetworkAreIndependent) {
  const std::array<float, 3> loud{4.0F, -3.0F, 2.0F};
  const std::array<float, 3> input{1.0F, 1.0F, 1.0F};
  const std::unique_ptr<Engine> first = load_engine(shipped("gru21.onnx"));
  const std::unique_ptr<Engine> second = load_engine(shipped("gru21.onnx"));
  first->run(loud);
  const double alone = Gru().step(input)[0];
  EXPECT_NEAR(second->run(input)[0], alone, 1e-5);
}

TEST(Engine, ThreadsSayTheSameBits) {
  const std::array<float, 3> input{1.0F, -0.5F, 2.0F};
  std::array<float, 4> said{};
  std::vector<std::thread> threads;
  for (float& one : said) {
    threads.emplace_back([&] {
      const std::unique_ptr<Engine> engine = load_engine(shipped("gru21.onnx"));
      for (int i = 0; i < 100; ++i) one = engine->run(input)[0];
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(said, Each(said[0]));
}

TEST(Engine, LeavesTheProcessorsRoundingAsItWas) {
  // Processors can round results below the smallest normal number to zero, and read such numbers as
  // zero.
  const auto rounding = [] {
    const volatile double normal = std::numeric_limits<double>::min(), below = std::numeric_limits<double>::denorm_min();
    return std::tuple(std::fegetround(), ::fegetexcept(), normal / 2.0, below * 0x1p1022);
  };
  const auto before = rounding();
  const std::unique_ptr<Engine> engine = load_engine(shipped("gru21.onnx"));
  engine->run(std::array<float, 3>{1.0F, 2.0F, 3.0F});
  EXPECT_EQ(rounding(), before);
}

TEST(Engine, AFileThatChangesIsReadAgain) {
  onnx::ModelProto model = model_of("mlp13.onnx");
  const TemporaryFile file(model.SerializeAsString());
  const std::array<float, 6> input{};
  const float before = load_engine(file.path())->run(input)[0];
  for (onnx::TensorProto& tensor : *model.mutable_graph()->mutable_initializer()) {
    if (tensor.name() == "B2") tensor.mutable_raw_data()->assign(8, '\0');
  }
  std::ofstream(file.path(), std::ios::binary) << model.SerializeAsString();
  EXPECT_NEAR(load_engine(file.path())->run(input)[0], before - weight(36), 1e-6);
}

TEST(Engine, SaysWhatIsMissingAndHowToAddIt) {
  const std::string message = refusal_of("mlp13.onnx", [](onnx::ModelProto& model) { model.clear_metadata_props(); });
  EXPECT_THAT(message, mentions({"metadata", "slipbench"}));
  EXPECT_THAT(message, HasSubstr("entry.key, entry.value = \"slipbench\", json.dumps(about)"));
  EXPECT_THAT(message, HasSubstr("onnx.save(model, "));
}

TEST(Engine, RefusesWhatIsNoNetworkOfOneFile) {
  using onnx::ModelProto;
  EXPECT_THAT(refusal_of("/dev/zero"), mentions({"/dev/zero", "device"}));
  EXPECT_THAT(refusal_of(testing::TempDir()), mentions({"folder"}));
  EXPECT_THAT(refusal_of("/nowhere.onnx"), mentions({"/nowhere.onnx", "opened"}));
  EXPECT_THAT(refusal_of(TemporaryFile("").path()), mentions({"ONNX file"}));
  EXPECT_THAT(refusal_of(TemporaryFile("#!/bin/sh\n").path()), mentions({"ONNX file"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_domain("com.acme"); }),
              mentions({"Relu", "com.acme"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_op_type("Frobnicate"); }),
              HasSubstr("Frobnicate"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.add_functions()->set_name("mine"); }),
              mentions({"operator", "mine"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_opset_import(0)->set_version(12); }),
              mentions({"operator set 12", "13"}));
}

TEST(Engine, RefusesWhatNeedNotEndOrTakesAnyMemory) {
  EXPECT_THAT(refusal_of("mlp13.onnx", [](onnx::ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_op_type("Loop"); }),
              mentions({"operator", "Loop"}));
  // 4 hidden values, each repeated 2^40 times: a few bytes that ask for 16 TB.
  const auto tile = [](onnx::ModelProto& m) {
    onnx::TensorProto* const repeats = m.mutable_graph()->add_initializer();
    repeats->set_name("repeats");
    repeats->set_data_type(onnx::TensorProto::INT64);
    repeats->add_dims(2);
    repeats->add_int64_data(std::int64_t{1} << 40);
    repeats->add_int64_data(1);
    onnx::NodeProto* const relu = m.mutable_graph()->mutable_node(2);
    relu->set_op_type("Tile");
    relu->add_input("repeats");
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", tile), mentions({"tensor", "67108864"}));
}

// mlp13.onnx with `type` in place of its Relu; its inputs are the Relu's and `inputs`.
std::string refusal_of_hidden(
    const std::string& type, const std::vector<std::string>& inputs = {},
    const std::function<void(onnx::ModelProto&)>& more = [](onnx::ModelProto&) {}) {
  return refusal_of("mlp13.onnx", [&](onnx::ModelProto& m) {
    onnx::NodeProto* const node = m.mutable_graph()->mutable_node(2);
    node->set_op_type(type);
    for (const std::string& input : inputs) node->add_input(input);
    more(m);
  });
}

void add_scalar(onnx::ModelProto& model, const std::string& name, onnx::TensorProto::DataType type, const std::string& bytes) {
  onnx::TensorProto* const tensor = model.mutable_graph()->add_initializer();
  tensor->set_name(name);
  tensor->set_data_type(type);
  tensor->set_raw_data(bytes);
}

TEST(Engine, RefusesWhatIsRandom) {
  for (const char* type :
       {"Bernoulli", "Multinomial", "RandomNormal", "RandomNormalLike", "RandomUniform", "RandomUniformLike"}) {
    EXPECT_THAT(refusal_of_hidden(type), mentions({"operator", type, "random"}));
  }
  // Dropout(data, ratio, training_mode).
  const auto dropout = [](const std::string& training) {
    return refusal_of_hidden("Dropout", {"ratio", "training"}, [&](onnx::ModelProto& m) {
      add_scalar(m, "ratio", onnx::TensorProto::FLOAT, std::string("\0\0\0\x3f", 4));  // 0.5
      add_scalar(m, "training", onnx::TensorProto::BOOL, training);
    });
  };
  EXPECT_THAT(dropout(std::string(1, '\1')), HasSubstr("uses the operator 'Dropout' in training mode"));
  EXPECT_EQ(dropout(std::string(1, '\0')), "accepted");
  EXPECT_EQ(refusal_of_hidden("Dropout"), "accepted");
}

// The 4 hidden values become 4 x `side` x `side` values, fewer than a tensor may have, which are
// multiplied with each other: 4 side^3 multiply-adds.
TEST(Engine, RefusesWhatTakesAnyTime) {
  const auto squared = [](std::int64_t side) {
    return refusal_of("mlp13.onnx", [&](onnx::ModelProto& m) {
      onnx::GraphProto& graph = *m.mutable_graph();
      const auto integers = [&](const std::string& name, const std::vector<std::int64_t>& values) {
        onnx::TensorProto* const tensor = graph.add_initializer();
        tensor->set_name(name);
        tensor->set_data_type(onnx::TensorProto::INT64);
        tensor->add_dims(static_cast<std::int64_t>(values.size()));
        for (const std::int64_t value : values) tensor->add_int64_data(value);
      };
      integers("column", {4, 1, 1});
      integers("square", {4, side, side});
      integers("sides", {1, 2});
      integers("row", {1, 4});
      // hidden [1, 4] -> [4, 1, 1] -> [4, side, side] -> its square -> mean of each of the 4 -> [1,
      // 4] relu
      onnx::NodeProto last = graph.node(3);
      graph.mutable_node()->RemoveLast();
      graph.mutable_node()->RemoveLast();
      const auto node = [&](const std::string& type, const std::vector<std::string>& inputs, const std::string& output) {
        onnx::NodeProto* const added = graph.add_node();
        added->set_op_type(type);
        for (const std::string& input : inputs) added->add_input(input);
        added->add_output(output);
        return added;
      };
      node("Reshape", {"hidden", "column"}, "columns");
      node("Expand", {"columns", "square"}, "squares");
      node("MatMul", {"squares", "squares"}, "products");
      onnx::NodeProto* const mean = node("ReduceMean", {"products"}, "means");
      onnx::AttributeProto* const axes = mean->add_attribute();
      axes->set_name("axes");
      axes->set_type(onnx::AttributeProto::INTS);
      axes->add_ints(1);
      axes->add_ints(2);
      node("Reshape", {"means", "row"}, "relu");
      *graph.add_node() = last;
    });
  };
  EXPECT_EQ(squared(8), "accepted");
  // 4 x 2000^3 = 3.2e10, plus some 1e7 values read and made.
  EXPECT_THAT(squared(2000), HasSubstr(" 3.20"));
  EXPECT_THAT(squared(2000), mentions({"multiply-adds", "10000000000"}));
}

// OpenVINO names the weights that do not fit, here by 200 words of three letters.
TEST(Engine, CutsALongReasonBetweenWords) {
  std::string words;
  for (int i = 0; i < 200; ++i) words += i == 0 ? "odd" : " odd";
  const std::string message = refusal_of("mlp13.onnx", [&](onnx::ModelProto& m) {
    onnx::TensorProto* const weights = m.mutable_graph()->mutable_initializer(0);
    weights->set_name(words);
    weights->set_dims(1, 5);
    weights->mutable_raw_data()->resize(80);
    m.mutable_graph()->mutable_node(1)->set_input(1, words);
  });
  EXPECT_THAT(message, mentions({"OpenVINO"}));
  EXPECT_THAT(message, EndsWith(" odd ..."));
}

void add_integers(onnx::ModelProto& model, const std::string& name, const std::vector<std::int64_t>& values) {
  onnx::TensorProto* const tensor = model.mutable_graph()->add_initializer();
  tensor->set_name(name);
  tensor->set_data_type(onnx::TensorProto::INT64);
  tensor->add_dims(static_cast<std::int64_t>(values.size()));
  for (const std::int64_t value : values) tensor->add_int64_data(value);
}

onnx::AttributeProto* add_integer(onnx::NodeProto* node, const std::string& name, std::int64_t value) {
  onnx::AttributeProto* const attribute = node->add_attribute();
  attribute->set_name(name);
  attribute->set_type(onnx::AttributeProto::INT);
  attribute->set_i(value);
  return attribute;
}

// mlp13.onnx with the integer "index" [1, 4], computed from the hidden values, before its Relu.
void add_computed_index(onnx::ModelProto& model) {
  onnx::GraphProto& graph = *model.mutable_graph();
  onnx::NodeProto* const cast = graph.add_node();
  cast->set_op_type("Cast");
  cast->add_input("hidden");
  cast->add_output("index");
  add_integer(cast, "to", onnx::TensorProto::INT64);
  for (int at = graph.node_size() - 1; at > 2; --at) graph.mutable_node()->SwapElements(at, at - 1);
}

// Positions that a value decides can be outside of a tensor, where OpenVINO reads and writes.
TEST(Engine, RefusesOperatorsThatAddressMemoryByValues) {
  for (const char* type :
       {"ScatterElements", "ScatterND", "GatherElements", "GatherND", "OneHot", "CumSum", "MaxUnpool", "GridSample", "RoiAlign",
        "ReverseSequence", "NonMaxSuppression", "TopK", "NonZero", "Compress", "Unique", "If"}) {
    const std::string message = refusal_of("mlp13.onnx", [&](onnx::ModelProto& m) {
      m.mutable_graph()->mutable_node(2)->set_op_type(type);
      m.mutable_graph()->mutable_node(2)->set_name("the one");
    });
    EXPECT_THAT(message, mentions({"operator", type, "the one", "detectors/network/README.md"}));
  }
}

TEST(Engine, RefusesIndicesAndShapesThatDependOnTheInput) {
  // Gather(data, index), Reshape(data, shape), Slice(data, starts, ends), Pad(data, pads).
  const std::vector<std::pair<std::string, std::vector<std::string>>> nodes{
      {"Gather", {"index"}}, {"Reshape", {"index"}}, {"Slice", {"index", "index"}}, {"Pad", {"index"}}, {"Expand", {"index"}}};
  for (const auto& [type, inputs] : nodes) {
    EXPECT_THAT(refusal_of("mlp13.onnx",
                           [&, type = type, inputs = inputs](onnx::ModelProto& m) {
                             add_computed_index(m);
                             onnx::NodeProto* const node = m.mutable_graph()->mutable_node(3);
                             node->set_op_type(type);
                             for (const std::string& input : inputs) node->add_input(input);
                           }),
                mentions({type.c_str(), "relu", "index", "constant"}));
  }
  // Lengths of the sequences of a GRU, its fifth input.
  EXPECT_THAT(refusal_of("gru21.onnx",
                         [](onnx::ModelProto& m) {
                           onnx::NodeProto* const cast = m.mutable_graph()->add_node();
                           cast->set_op_type("Cast");
                           cast->add_input("frame");
                           cast->add_output("index");
                           add_integer(cast, "to", onnx::TensorProto::INT32);
                           for (int at = m.graph().node_size() - 1; at > 0; --at) {
                             m.mutable_graph()->mutable_node()->SwapElements(at, at - 1);
                           }
                           m.mutable_graph()->mutable_node(2)->set_input(4, "index");
                         }),
              mentions({"GRU", "index", "constant"}));
}

// Four hidden values: indices from -4 to 3.
TEST(Engine, RefusesConstantIndicesOutOfRange) {
  const auto gather = [](std::int64_t index) {
    return refusal_of_hidden("Gather", {"indices"}, [&](onnx::ModelProto& m) {
      add_integers(m, "indices", {0, 1, 2, index});
      add_integer(m.mutable_graph()->mutable_node(2), "axis", 1);
    });
  };
  EXPECT_EQ(gather(3), "accepted");
  EXPECT_EQ(gather(-4), "accepted");
  EXPECT_THAT(gather(4), mentions({"index 4", "-4 to 3"}));
  EXPECT_THAT(gather(-5), mentions({"index -5", "-4 to 3"}));
  // Gather from the hidden values 0 to 0.
  EXPECT_THAT(refusal_of_hidden(
                  "Gather", {"indices"},
                  [](onnx::ModelProto& m) {
                    onnx::GraphProto& graph = *m.mutable_graph();
                    for (const char* name : {"starts", "ends"}) add_integers(m, name, {0});
                    add_integers(m, "axes", {1});
                    add_integers(m, "indices", {0, 0, 0, 0});
                    add_integer(graph.mutable_node(2), "axis", 1);
                    const std::string hidden = graph.node(2).input(0);
                    graph.mutable_node(2)->set_input(0, "nothing");
                    onnx::NodeProto* const slice = graph.add_node();
                    slice->set_op_type("Slice");
                    for (const std::string& name : {hidden, std::string("starts"), std::string("ends"), std::string("axes")})
                      slice->add_input(name);
                    slice->add_output("nothing");
                    for (int k = graph.node_size() - 1; k > 2; --k) graph.mutable_node()->SwapElements(k, k - 1);
                  }),
              mentions({"index 0", "extent of 0 along the axis"}));
  // A sequence of one frame.
  const auto length = [](std::int32_t frames) {
    return refusal_of("gru21.onnx", [&](onnx::ModelProto& m) {
      onnx::TensorProto* const tensor = m.mutable_graph()->add_initializer();
      tensor->set_name("frames");
      tensor->set_data_type(onnx::TensorProto::INT32);
      tensor->add_dims(1);
      tensor->add_int32_data(frames);
      m.mutable_graph()->mutable_node(1)->set_input(4, "frames");
    });
  };
  EXPECT_EQ(length(1), "accepted");
  EXPECT_THAT(length(2), mentions({"length 2", "0 to 1"}));
}

// An operator that reads its own output, by way of another one.
TEST(Engine, RefusesGraphsThatAreNotInOrder) {
  EXPECT_THAT(refusal_of("mlp13.onnx", [](onnx::ModelProto& m) { m.mutable_graph()->mutable_node(1)->set_input(0, "relu"); }),
              mentions({"Gemm", "hidden", "relu", "earlier"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](onnx::ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_output(0, "hidden"); }),
              mentions({"Relu", "hidden", "twice"}));
  EXPECT_THAT(
      refusal_of("mlp13.onnx", [](onnx::ModelProto& m) { *m.mutable_graph()->add_initializer() = m.graph().initializer(0); }),
      mentions({"W1", "twice"}));
}

// OpenVINO crashes on Conv without weights and on Mean without values.
TEST(Engine, RefusesOperatorsWithoutTheirInputs) {
  EXPECT_THAT(refusal_of_hidden("Conv"), mentions({"Conv", "2 inputs"}));
  EXPECT_THAT(refusal_of_hidden("Where", {"", "W1"}), mentions({"Where", "3 inputs"}));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](onnx::ModelProto& m) {
                           m.mutable_graph()->mutable_node(2)->set_op_type("Mean");
                           m.mutable_graph()->mutable_node(2)->clear_input();
                         }),
              mentions({"Mean", "1 input"}));
}

TEST(Engine, RefusesGraphsInsideOperators) {
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](onnx::ModelProto& m) {
                           onnx::AttributeProto* const branch = m.mutable_graph()->mutable_node(2)->add_attribute();
                           branch->set_name("branch");
                           branch->set_type(onnx::AttributeProto::GRAPH);
                           branch->mutable_g()->set_name("inner");
                         }),
              mentions({"Relu", "branch", "graph"}));
}

// The README lists the operators between two lines that begin with "<!--".
TEST(Engine, AcceptsTheOperatorsThatTheReadmeLists) {
  const std::string text = bytes_of(std::string(SLIPBENCH_SOURCE_DIR) + "/detectors/network/README.md");
  const std::size_t begin = text.find("<!-- operators -->"), end = text.find("<!-- end of operators -->");
  ASSERT_NE(end, std::string::npos);
  std::size_t found = 0;
  for (std::size_t open = text.find('`', begin); open < end; open = text.find('`', open)) {
    const std::size_t close = text.find('`', open + 1);
    const std::string type = text.substr(open + 1, close - open - 1);
    onnx::ModelProto model = model_of("mlp13.onnx");
    model.mutable_graph()->mutable_node(2)->set_op_type(type);
    const TemporaryFile file(model.SerializeAsString());
    const std::string message = slipbench::refusal_of([&] { load_engine_unchecked(file.path()); });
    EXPECT_THAT(message, Not(HasSubstr("README.md"))) << type;
    open = close + 1;
    ++found;
  }
  EXPECT_GT(found, 100u);
}

TEST(Engine, RefusesTensorsThatAreNotWhatTheySay) {
  using onnx::ModelProto;
  const auto first = [](ModelProto& m) { return m.mutable_graph()->mutable_initializer(0); };
  const auto external = [](onnx::TensorProto* tensor) {
    tensor->set_data_location(onnx::TensorProto::EXTERNAL);
    onnx::StringStringEntryProto* const entry = tensor->add_external_data();
    entry->set_key("location");
    entry->set_value("/etc/passwd");
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { external(first(m)); }), mentions({"W1", "file"}));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [&](ModelProto& m) {
                           onnx::AttributeProto* const value = m.mutable_graph()->mutable_node(0)->add_attribute();
                           value->set_name("value");
                           value->mutable_t()->set_name("hidden");
                           external(value->mutable_t());
                         }),
              mentions({"hidden", "file"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_dims(0, std::int64_t{1} << 62); }),
              mentions({"W1", "4611686018427387904", "67108864"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_dims(0, -4); }), mentions({"extent", "-4"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->mutable_raw_data()->resize(92); }),
              mentions({"W1", "24", "23"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_data_type(onnx::TensorProto::STRING); }),
              mentions({"W1", "type 8"}));
}

// A weight of nan can stay hidden: behind it a ReLU gives 0. The bits are those of the formats,
// lowest byte first.
TEST(Engine, RefusesWeightsThatAreNoNumbers) {
  using onnx::TensorProto;
  struct Case {
    TensorProto::DataType type;
    std::string nan, infinity;
  };
  const std::vector<Case> cases{
      {TensorProto::FLOAT, std::string("\x01\0\x80\x7f", 4), std::string("\0\0\x80\x7f", 4)},
      {TensorProto::DOUBLE, std::string("\x01\0\0\0\0\0\xf0\x7f", 8), std::string("\0\0\0\0\0\0\xf0\x7f", 8)},
      {TensorProto::FLOAT16, std::string("\x01\xfc", 2), std::string("\0\xfc", 2)},
      {TensorProto::BFLOAT16, std::string("\xc0\xff", 2), std::string("\x80\xff", 2)}};
  for (const Case& one : cases) {
    const auto with = [&](const std::string& bytes) {
      return refusal_of("mlp13.onnx", [&](onnx::ModelProto& m) { add_scalar(m, "mask", one.type, bytes); });
    };
    EXPECT_THAT(with(one.nan), mentions({"mask", "NaN"})) << one.type;
    EXPECT_EQ(with(one.infinity), "accepted") << one.type;
  }
  const auto typed = [](onnx::ModelProto& m) {
    TensorProto* const tensor = m.mutable_graph()->mutable_initializer(0);
    tensor->clear_raw_data();
    for (std::size_t i = 0; i < 24; ++i) tensor->add_float_data(i == 23 ? std::numeric_limits<float>::quiet_NaN() : 1.0F);
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", typed), mentions({"W1", "NaN"}));
  const auto attribute = [](onnx::ModelProto& m) {
    onnx::AttributeProto* const alpha = m.mutable_graph()->mutable_node(2)->add_attribute();
    alpha->set_name("alpha");
    alpha->set_type(onnx::AttributeProto::FLOAT);
    alpha->set_f(std::numeric_limits<float>::quiet_NaN());
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", attribute), mentions({"alpha", "NaN"}));
}

// mlp13.onnx takes two frames of three values; if it leaves the two open, one is taken.
TEST(Engine, SaysThatAnOpenTimeIsTakenAsOne) {
  const auto open = [](onnx::ModelProto& m) {
    m.mutable_graph()->mutable_input(0)->mutable_type()->mutable_tensor_type()->mutable_shape()->mutable_dim(1)->set_dim_param(
        "t");
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", open), mentions({"frames", "open", "1"}));
}

// W1 expects five values but gets six: OpenVINO's message has the failed condition and its place in
// the sources.
TEST(Engine, GivesTheReasonWithoutItsCondition) {
  const auto narrow = [](onnx::ModelProto& m) {
    onnx::TensorProto* const weights = m.mutable_graph()->mutable_initializer(0);
    weights->set_dims(1, 5);
    weights->mutable_raw_data()->resize(80);
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", narrow),
              AllOf(mentions({"OpenVINO", "MatMul"}), Not(AnyOf(HasSubstr("Check '"), HasSubstr("failed at"), HasSubstr("  ")))));
}

TEST(Engine, RefusesInputsAndOutputsThatTheDescriptionDoesNotSay) {
  using onnx::ModelProto;
  EXPECT_THAT(refusal_of("gru21.onnx", [](ModelProto& m) { describe(m, "[{\"input\": \"h\", \"output\": \"h_next\"}]", "[]"); }),
              mentions({"frame", "h", "2"}));
  EXPECT_THAT(refusal_of("gru21.onnx", [](ModelProto& m) { describe(m, "\"h_next\"", "\"h_nxt\""); }),
              mentions({"h_nxt", "h_next"}));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](ModelProto& m) {
                           m.mutable_graph()->mutable_input(0)->mutable_type()->mutable_tensor_type()->set_elem_type(
                               onnx::TensorProto::DOUBLE);
                         }),
              mentions({"frames", "float32"}));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](ModelProto& m) {
                           describe(m, "\"classes\": [", "\"classes\": [{\"name\": \"air\", \"state\": \"no_contact\"}, ");
                         }),
              mentions({"2 values", "3"}));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { describe(m, "\"stride\"", "\"strid\""); }),
              mentions({"slipbench", "strid", "stride"}));
}

// The output reads a constant instead of the hidden values.
TEST(Engine, RefusesANetworkThatIgnoresItsInput) {
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](onnx::ModelProto& m) {
                           onnx::GraphProto& graph = *m.mutable_graph();
                           const std::string input = graph.input(0).name();
                           onnx::TensorProto* const zeros = graph.add_initializer();
                           zeros->set_name("zeros");
                           zeros->set_data_type(onnx::TensorProto::FLOAT);
                           for (const auto& extent : graph.input(0).type().tensor_type().shape().dim()) {
                             zeros->add_dims(std::max<std::int64_t>(1, extent.dim_value()));
                           }
                           std::int64_t count = 1;
                           for (const std::int64_t extent : zeros->dims()) count *= extent;
                           for (std::int64_t k = 0; k < count; ++k) zeros->add_float_data(0.0F);
                           for (onnx::NodeProto& node : *graph.mutable_node()) {
                             for (std::string& name : *node.mutable_input()) {
                               if (name == input) name = "zeros";
                             }
                           }
                         }),
              mentions({"no output", "depends on its input 'frames'"}));
}

TEST(Engine, WhatIsNoNumberIsAnError) {
  const std::unique_ptr<Engine> engine = load_engine(shipped("mlp13.onnx"));
  std::array<float, 6> input{};
  input[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(engine->run(input), InputError);
  // The first row of the first layer is (-5, 2, -2, 5, 1, -3)/8: for these inputs it gives 2.25
  // times 3e38, beyond a float32.
  input = {-3e38F, 3e38F, -3e38F, 3e38F, 3e38F, -3e38F};
  EXPECT_THROW(engine->run(input), InputError);
}

TEST(Engine, ValuesThatAreNoProbabilitiesAreAnError) {
  onnx::ModelProto model = model_of("mlp13.onnx");
  describe(model, "\"classes\"", "\"output\": \"probabilities\", \"classes\"");
  const TemporaryFile file(model.SerializeAsString());
  const std::unique_ptr<Engine> engine = load_engine(file.path());
  EXPECT_THAT(slipbench::refusal_of([&] { engine->run(std::array<float, 6>{}); }), mentions({"probabilities"}));
}

}  // namespace
}  // namespace slipbench::network
