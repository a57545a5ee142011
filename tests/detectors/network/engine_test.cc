// Networks in ONNX files: what they say, and which files are refused.

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <onnx/onnx_pb.h>
#include <unistd.h>
#include <xmmintrin.h>

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

// A file that is gone at the end.
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

// What is said of `name` once it is changed so.
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
  const unsigned before = _mm_getcsr() & ~_MM_EXCEPT_MASK;
  const std::unique_ptr<Engine> engine = load_engine(shipped("gru21.onnx"));
  engine->run(std::array<float, 3>{1.0F, 2.0F, 3.0F});
  EXPECT_EQ(_mm_getcsr() & ~_MM_EXCEPT_MASK, before);
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
  EXPECT_THAT(message, HasSubstr("has no metadata 'slipbench'"));
  EXPECT_THAT(message, HasSubstr("entry.key, entry.value = \"slipbench\", json.dumps(about)"));
  EXPECT_THAT(message, HasSubstr("onnx.save(model, "));
}

TEST(Engine, RefusesWhatIsNoNetworkOfOneFile) {
  using onnx::ModelProto;
  EXPECT_THAT(refusal_of("/dev/zero"), HasSubstr("is a device, no file"));
  EXPECT_THAT(refusal_of(testing::TempDir()), HasSubstr("is a folder, no file"));
  EXPECT_THAT(refusal_of("/nowhere.onnx"), HasSubstr("/nowhere.onnx: cannot be opened"));
  EXPECT_THAT(refusal_of(TemporaryFile("").path()), HasSubstr("is no ONNX file"));
  EXPECT_THAT(refusal_of(TemporaryFile("#!/bin/sh\n").path()), HasSubstr("is no ONNX file"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_domain("com.acme"); }),
              HasSubstr("uses the operator 'Relu' of 'com.acme'; allowed: the operators of ONNX itself"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_op_type("Frobnicate"); }),
              HasSubstr("Frobnicate"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.add_functions()->set_name("mine"); }),
              HasSubstr("defines the operator 'mine' of its own"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { m.mutable_opset_import(0)->set_version(12); }),
              HasSubstr("is of the operator set 12 of ONNX; allowed: 13 to"));
}

TEST(Engine, RefusesWhatNeedNotEndOrTakesAnyMemory) {
  EXPECT_THAT(refusal_of("mlp13.onnx", [](onnx::ModelProto& m) { m.mutable_graph()->mutable_node(2)->set_op_type("Loop"); }),
              HasSubstr("uses the operator 'Loop', which need not end"));
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
  EXPECT_THAT(refusal_of("mlp13.onnx", tile), HasSubstr("makes a tensor of more than 67108864 elements"));
}

// mlp13.onnx with `type` in place of its Relu, of the inputs of the Relu and `inputs`.
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
    EXPECT_THAT(refusal_of_hidden(type),
                HasSubstr("uses the operator '" + std::string(type) +
                          "', which draws random numbers; allowed: operators that give the same each time"));
  }
  // Dropout(data, ratio, training_mode).
  const auto dropout = [](const std::string& training) {
    return refusal_of_hidden("Dropout", {"ratio", "training"}, [&](onnx::ModelProto& m) {
      add_scalar(m, "ratio", onnx::TensorProto::FLOAT, std::string("\0\0\0\x3f", 4));  // 0.5
      add_scalar(m, "training", onnx::TensorProto::BOOL, training);
    });
  };
  EXPECT_THAT(dropout(std::string(1, '\1')), HasSubstr("uses the operator 'Dropout' as in training"));
  EXPECT_EQ(dropout(std::string(1, '\0')), "accepted");
  EXPECT_EQ(refusal_of_hidden("Dropout"), "accepted");
}

// The 4 hidden values become 4 x `side` x `side` ones, less than a tensor may have, and are multiplied with each other: 4 side^3 multiply-adds.
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
      // hidden [1, 4] -> [4, 1, 1] -> [4, side, side] -> its square -> a mean of each of the 4 -> [1, 4] relu
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
  // 4 x 2000^3 = 3.2e10, and some 1e7 values that are read and made.
  EXPECT_THAT(squared(2000), HasSubstr(": a step of the network takes 3.20"));
  EXPECT_THAT(squared(2000), HasSubstr("e+10 multiply-adds; allowed: at most 10000000000"));
}

// OpenVINO repeats the name of what it does not know, here 200 words of three letters.
TEST(Engine, CutsALongReasonBetweenWords) {
  std::string words;
  for (int i = 0; i < 200; ++i) words += i == 0 ? "odd" : " odd";
  const std::string message = refusal_of_hidden(words);
  EXPECT_THAT(message, HasSubstr("OpenVINO does not take it"));
  EXPECT_THAT(message, EndsWith(" odd ..."));
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
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { external(first(m)); }),
              HasSubstr("keeps the tensor 'W1' in another file"));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [&](ModelProto& m) {
                           onnx::AttributeProto* const branch = m.mutable_graph()->mutable_node(0)->add_attribute();
                           branch->set_name("then_branch");
                           onnx::TensorProto* const tensor = branch->mutable_g()->add_initializer();
                           tensor->set_name("hidden");
                           external(tensor);
                         }),
              HasSubstr("keeps the tensor 'hidden' in another file"));
  EXPECT_THAT(
      refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_dims(0, std::int64_t{1} << 62); }),
      HasSubstr("has the tensor 'W1' of an extent of 4611686018427387904; allowed: 0 or more, and 67108864 elements in all"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_dims(0, -4); }), HasSubstr("of an extent of -4"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->mutable_raw_data()->resize(92); }),
              HasSubstr("has the tensor 'W1' of 24 elements, with the data of 23; allowed: one value an element"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [&](ModelProto& m) { first(m)->set_data_type(onnx::TensorProto::STRING); }),
              HasSubstr("has the tensor 'W1' of data type 8; allowed: numbers and flags"));
}

// A weight of nan need not be heard: behind it a ReLU says 0. The bits are those of the formats, lowest byte first.
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
    EXPECT_THAT(with(one.nan), HasSubstr("has the tensor 'mask' with nan in it; allowed: numbers")) << one.type;
    EXPECT_EQ(with(one.infinity), "accepted") << one.type;
  }
  const auto typed = [](onnx::ModelProto& m) {
    TensorProto* const tensor = m.mutable_graph()->mutable_initializer(0);
    tensor->clear_raw_data();
    for (std::size_t i = 0; i < 24; ++i) tensor->add_float_data(i == 23 ? std::numeric_limits<float>::quiet_NaN() : 1.0F);
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", typed), HasSubstr("has the tensor 'W1' with nan in it"));
  const auto attribute = [](onnx::ModelProto& m) {
    onnx::AttributeProto* const alpha = m.mutable_graph()->mutable_node(2)->add_attribute();
    alpha->set_name("alpha");
    alpha->set_type(onnx::AttributeProto::FLOAT);
    alpha->set_f(std::numeric_limits<float>::quiet_NaN());
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", attribute), HasSubstr("has nan for the attribute 'alpha'; allowed: numbers"));
}

// Two frames of three values are what mlp13.onnx is made for; where it leaves the two open, one is taken.
TEST(Engine, SaysThatAnOpenTimeIsTakenAsOne) {
  const auto open = [](onnx::ModelProto& m) {
    m.mutable_graph()->mutable_input(0)->mutable_type()->mutable_tensor_type()->mutable_shape()->mutable_dim(1)->set_dim_param(
        "t");
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", open), AllOf(HasSubstr("the extents that 'frames' leaves open are taken as 1"),
                                                    HasSubstr("allowed: an input exported with its extents")));
}

// W1 is made for five values, and six come: OpenVINO says so behind the condition that failed and its place in the sources.
TEST(Engine, GivesTheReasonWithoutItsCondition) {
  const auto narrow = [](onnx::ModelProto& m) {
    onnx::TensorProto* const weights = m.mutable_graph()->mutable_initializer(0);
    weights->set_dims(1, 5);
    weights->mutable_raw_data()->resize(80);
  };
  EXPECT_THAT(refusal_of("mlp13.onnx", narrow), AllOf(HasSubstr("OpenVINO does not take it: "), HasSubstr("MatMul"),
                                                      Not(AnyOf(HasSubstr("Check '"), HasSubstr("failed at"), HasSubstr("  ")))));
}

TEST(Engine, RefusesInputsAndOutputsThatTheDescriptionDoesNotSay) {
  using onnx::ModelProto;
  EXPECT_THAT(refusal_of("gru21.onnx", [](ModelProto& m) { describe(m, "[{\"input\": \"h\", \"output\": \"h_next\"}]", "[]"); }),
              HasSubstr("has 2 inputs that are no states: 'frame', 'h'; allowed: one"));
  EXPECT_THAT(refusal_of("gru21.onnx", [](ModelProto& m) { describe(m, "\"h_next\"", "\"h_nxt\""); }),
              HasSubstr("has no output 'h_nxt', which its states name; did you mean 'h_next'?"));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](ModelProto& m) {
                           m.mutable_graph()->mutable_input(0)->mutable_type()->mutable_tensor_type()->set_elem_type(
                               onnx::TensorProto::DOUBLE);
                         }),
              HasSubstr("has the input 'frames', which is no tensor of float32; allowed: float32"));
  EXPECT_THAT(refusal_of("mlp13.onnx",
                         [](ModelProto& m) {
                           describe(m, "\"classes\": [", "\"classes\": [{\"name\": \"air\", \"state\": \"no_contact\"}, ");
                         }),
              HasSubstr("says 2 values; allowed: 3, one for each class of its description"));
  EXPECT_THAT(refusal_of("mlp13.onnx", [](ModelProto& m) { describe(m, "\"stride\"", "\"strid\""); }),
              HasSubstr("metadata 'slipbench': input: unknown key 'strid'; did you mean 'stride'?"));
}

TEST(Engine, WhatIsNoNumberIsAnError) {
  const std::unique_ptr<Engine> engine = load_engine(shipped("mlp13.onnx"));
  std::array<float, 6> input{};
  input[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(engine->run(input), InputError);
  // The first row of the first layer is (-5, 2, -2, 5, 1, -3)/8: of these it makes 2.25 times 3e38, more than a float32 can hold.
  input = {-3e38F, 3e38F, -3e38F, 3e38F, 3e38F, -3e38F};
  EXPECT_THROW(engine->run(input), InputError);
}

TEST(Engine, ValuesThatAreNoProbabilitiesAreAnError) {
  onnx::ModelProto model = model_of("mlp13.onnx");
  describe(model, "\"classes\"", "\"output\": \"probabilities\", \"classes\"");
  const TemporaryFile file(model.SerializeAsString());
  const std::unique_ptr<Engine> engine = load_engine(file.path());
  EXPECT_THAT(slipbench::refusal_of([&] { engine->run(std::array<float, 6>{}); }),
              HasSubstr("says values that are no probabilities"));
}

}  // namespace
}  // namespace slipbench::network
