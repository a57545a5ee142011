// From simulated grasps to a trained detector in the loop: runs every command of the chain as a
// user does.
#include <iterator>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

using Json = nlohmann::json;

struct LearnedLoop : ::testing::Test {
  // Returns the output of the program, which must end with status 0.
  static std::string said(const std::vector<std::string>& words) {
    const ChildResult result = run_program_file(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  static Json json(std::vector<std::string> words) {
    words.emplace_back("--json");
    return Json::parse(said(words), nullptr, false);
  }

  // Each of two controllers holds half of the grasps.
  void make_grasps(const std::string& trials) {
    said({"sweep", SLIPBENCH_SOURCE_DIR "/scenes/grasp/learn.yaml", "--trials", trials, "--jobs", "2", "-o", grasps_});
  }
  // A preset of 4 N holds 2 x 0.2 x 4 N = 1.6 N of the 1.96 N of the box. The samples of the loop
  // itself are judged afterwards.
  Json lifted(const std::string& detector, const std::string& model) {
    const std::string file = folder_ / "lift.h5";
    said({"run", SLIPBENCH_SOURCE_DIR "/scenes/grasp/lift.yaml", "--set", "friction.static=0.2", "--set", "friction.kinetic=0.19",
          "--set", "detector=" + detector, "--trials", "2", "--seed", "77", "-o", file});
    return json({"eval", model, file, "--labels", "micro"});
  }

  TemporaryFolder folder_;
  const std::string grasps_ = folder_ / "grasps.h5";
};

// The split of the scene gives 28 of 40 grasps for training and 6 for validation, which are left
// out of the evaluation; the other 6 are evaluated.
TEST_F(LearnedLoop, NetworkFromSweepToGrip) {
  make_grasps("20");
  const std::string model = folder_ / "grasp.onnx";
  const Json trained = json({"train", grasps_, "--recipe", "grasp_gru", "--steps", "150", "--alarms", "20/min", "-o", model});
  ASSERT_EQ(trained["recipe"], "grasp_gru");
  const Json judged = json({"eval", model, grasps_, "--labels", "micro"});
  EXPECT_EQ(judged["left_out"].size(), 34U);
  EXPECT_EQ(judged["all"]["trials"], 6);
  const Json lift = lifted("{type: network, model: " + model + "}", model);
  EXPECT_EQ(lift["all"]["missed"], 0);                                        // every box slips, and the network reports it
  EXPECT_GT(lift["all"]["figures"]["balanced_slip_accuracy"]["value"], 0.6);  // 0.5 if it always reports slip
  EXPECT_TRUE(lift["loop"]["same"]);                                          // eval gives the same classes as the loop
  EXPECT_EQ(lift["loop"]["detector"], "network");
}

// Returns the words of the command that a text suggests next.
std::vector<std::string> next_command(const std::string& text) {
  const std::string before = "next: " SLIPBENCH_PROGRAM " ";
  const std::size_t at = text.find(before);
  if (at == std::string::npos) return {};
  std::istringstream line(text.substr(at + before.size(), text.find('\n', at) - at - before.size()));
  return {std::istream_iterator<std::string>(line), {}};
}

// Trains on one of two sensors: the suggested `eval` must name that sensor and the part test of the
// scene's own split.
TEST_F(LearnedLoop, TheNextCommandThatIsNamedRuns) {
  said({"sweep", SLIPBENCH_SOURCE_DIR "/scenes/grasp/learn.yaml", "--trials", "10", "--jobs", "2", "-o", grasps_, "--set",
        "sensors={pad: {type: papillarray, rate: 100 Hz}, fast: {type: papillarray, rate: 250 Hz, follows: pad}}", "--set",
        "detector={type: truth, sensor: pad}"});
  const std::string text = said({"train", grasps_, "--recipe", "grasp_gru", "--steps", "5", "-o", folder_ / "grasp.onnx"});
  const std::vector<std::string> words = next_command(text);
  EXPECT_THAT(words,
              ElementsAre("eval", folder_ / "grasp.onnx", grasps_, "--sensor", "pad", "--labels", "micro", "--split", "test"));
  said(words);
}

// gst_hd trains on the only PapillArray without --sensor, while `eval` needs --sensor because it
// finds two sensors.
TEST_F(LearnedLoop, TheNextCommandOfMemoriesRuns) {
  said({"sweep", SLIPBENCH_SOURCE_DIR "/scenes/grasp/learn.yaml", "--trials", "10", "--jobs", "2", "-o", grasps_, "--set",
        "sensors={pad: {type: papillarray, rate: 100 Hz}, skin: {type: piezo_skin, follows: pad}}", "--set",
        "detector={type: truth, sensor: pad}"});
  const std::vector<std::string> words =
      next_command(said({"train-hd", grasps_, "--labels", "micro", "-o", folder_ / "memories"}));
  EXPECT_THAT(words,
              ElementsAre("eval", folder_ / "memories", grasps_, "--sensor", "pad", "--labels", "micro", "--split", "test"));
  said(words);
}

TEST_F(LearnedLoop, MemoriesFromSweepToGrip) {
  make_grasps("10");
  const std::string memories = folder_ / "memories";
  json({"train-hd", grasps_, "--labels", "micro", "--quantiser", "unrounded", "-o", memories});
  const Json lift = lifted("{type: gst_hd, memories: " + memories + "}", memories);
  EXPECT_EQ(lift["all"]["trials"], 2);
  EXPECT_EQ(lift["loop"]["detector"], "gst_hd");
  EXPECT_TRUE(lift["loop"]["same"]);
}

// The shipped check of a trained detector. 2 mu 4 N = 1.6 N cannot hold 1.96 N, so with a detector
// that never reports slip the box drops. With one that always does, the loop tightens to the end,
// to 4 times the least force, and drops none. Returns the failed expectations.
struct LearnedCheck : LearnedLoop {
  static std::vector<std::string> failed(std::vector<std::string> more) {
    std::vector<std::string> words{"check", SLIPBENCH_SOURCE_DIR "/scenes/grasp/check_learned.yaml", "--trials", "10", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Json check = Json::parse(run_program_file(words).out, nullptr, false);
    std::vector<std::string> names;
    for (const Json& expectation : check["scenes"][0]["expectations"]) {
      if (!expectation["passed"].get<bool>()) names.push_back(expectation["name"].get<std::string>());
    }
    return names;
  }
};

TEST_F(LearnedCheck, PassesAsShipped) {
  const ChildResult result = run_program_file({"check", SLIPBENCH_SOURCE_DIR "/scenes/grasp/check_learned.yaml"});
  EXPECT_EQ(result.status, 0) << result.out << result.err;
}

TEST_F(LearnedCheck, FindsALoopThatDropsBoxes) { EXPECT_THAT(failed({"--set", "detector.threshold=1"}), Contains("dropped")); }

TEST_F(LearnedCheck, FindsALoopThatAlwaysTightens) {
  EXPECT_THAT(failed({"--set", "detector={type: force_ratio, ratio: 0.001}"}), ElementsAre("max_force_ratio"));
}

}  // namespace
}  // namespace slipbench
