// The shipped scenes as regression tests: each planted fault of a controller is found by the
// expectation that it breaks, and the copy without a fault passes. The fault libraries:
// faults/step_on_slip.cc.
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string scenes = SLIPBENCH_SOURCE_DIR "/scenes/grasp/";
const std::vector<std::string> names{"check_felt", "check_ptfe", "check_rubber"};

std::string controller(const std::string& fault) {
  return "controller={type: plugin, library: " SLIPBENCH_TEST_PLUGINS "/" + fault + ".so}";
}

struct FaultCase {
  const char* fault;
  const char* found_by;  // the expectation that must fail in every scene
};

void PrintTo(const FaultCase& c, std::ostream* out) { *out << c.fault; }

class PlantedFault : public testing::TestWithParam<FaultCase> {};

TEST_P(PlantedFault, IsFoundInEveryScene) {
  const TemporaryFolder folder;
  std::vector<std::string> words{"check"};
  for (const std::string& name : names) words.push_back(scenes + name + ".yaml");
  words.insert(words.end(), {"--set", controller(GetParam().fault), "--trials", "5", "--json", "-o", folder / "left"});
  const ChildResult result = run_program_file(words);
  EXPECT_EQ(result.status, 1) << result.err;
  const nlohmann::json found = nlohmann::json::parse(result.out);
  EXPECT_EQ(found.at("passed"), false);
  ASSERT_EQ(found.at("scenes").size(), names.size());
  for (const nlohmann::json& scene : found.at("scenes")) {
    EXPECT_EQ(scene.at("verdict"), "failed") << scene;
    std::set<std::string> failed;
    for (const nlohmann::json& expectation : scene.at("expectations")) {
      if (!expectation.at("passed")) failed.insert(expectation.at("name"));
    }
    EXPECT_TRUE(failed.contains(GetParam().found_by)) << scene.dump(1);
  }
}

INSTANTIATE_TEST_SUITE_P(Faults, PlantedFault,
                         testing::Values(FaultCase{"never_tightens", "dropped"}, FaultCase{"late", "max_reaction_time"},
                                         FaultCase{"stuck_sensor", "dropped"}, FaultCase{"wrong_sign", "dropped"},
                                         FaultCase{"overshoots", "max_grip_force"}, FaultCase{"latches", "max_grip_force"}),
                         [](const testing::TestParamInfo<FaultCase>& info) { return std::string(info.param.fault); });

// The whole folder as shipped; scenes without expectations are skipped.
TEST(ShippedScenes, Pass) {
  std::vector<std::string> words{"check", scenes + "lift.yaml"};
  for (const std::string& name : names) words.push_back(scenes + name + ".yaml");
  const ChildResult result = run_program_file(words);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 of 4 scenes passed, 1 not checked")) << result.out;
}

// The copy has the results of step_on_slip, which the scenes name.
TEST(HealthyCopy, PassesWithTheFiguresOfTheOriginal) {
  std::vector<std::string> original{"check"};
  for (const std::string& name : names) original.push_back(scenes + name + ".yaml");
  original.insert(original.end(), {"--trials", "5", "--json"});
  std::vector<std::string> copy = original;
  copy.insert(copy.end(), {"--set", controller("none")});
  std::vector<nlohmann::json> figures;
  for (const auto& words : {original, copy}) {
    const ChildResult result = run_program_file(words);
    EXPECT_EQ(result.status, 0) << result.out;
    figures.push_back(nlohmann::json::parse(result.out));
    for (nlohmann::json& scene : figures.back().at("scenes")) {
      for (nlohmann::json& expectation : scene.at("expectations")) expectation.erase("replay");  // it names the controller
    }
  }
  EXPECT_EQ(figures[0], figures[1]);
}

// The printed command writes the same bytes as the failed check.
TEST(FailedCheck, IsReplayedByItsCommand) {
  const TemporaryFolder folder;
  const ChildResult check = run_shell(
      "slipbench check " + scenes + "check_ptfe.yaml --set '" + controller("late") + "' --trials 3 --seed 5 --json -o left",
      folder / "");
  ASSERT_EQ(check.status, 1) << check.err;
  const nlohmann::json scene = nlohmann::json::parse(check.out).at("scenes").at(0);
  const std::string left = scene.at("files").at(0);
  for (const nlohmann::json& expectation : scene.at("expectations")) {
    if (expectation.at("passed") || expectation.at("worst_trial") != scene.at("replayed")) continue;
    const std::string replay = expectation.at("replay");
    EXPECT_THAT(replay, HasSubstr(" --trial " + std::to_string(scene.at("replayed").get<int>())));
    const ChildResult again = run_shell(replay + " --quiet -o again.h5", folder / "");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(bytes_of(folder / "again.h5"), bytes_of(folder / left));
    return;
  }
  FAIL() << scene.dump(1);
}

TEST(NegativeControl, ThatPassesIsReported) {
  // 4 N hold up to 2 * 0.35 * 4/9.81 = 0.285 kg.
  const TemporaryFolder folder;
  const std::vector<std::string> words{
      "check",   scenes + "check_ptfe.yaml", "--set", "box.mass=100 g", "expect={dropped: false}", "--trials", "2",
      "--junit", folder / "j.xml",           "-o",    folder / "left"};
  const ChildResult result = run_program_file(words);
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_THAT(result.out, HasSubstr("tests nothing"));
  EXPECT_THAT(bytes_of(folder / "j.xml"), HasSubstr("<failure message=\"tests nothing\""));
  // Failing a reaction time or a force ratio with a controller that never tightens does not make
  // the box a valid test.
  std::vector<std::string> light = words;
  light[3] = "box.mass=200 g";
  light.erase(light.begin() + 4);
  const ChildResult kept = run_program_file(light);
  EXPECT_EQ(kept.status, 1) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("tests nothing"));
  std::vector<std::string> without = words;
  without[4] = "expect={dropped: false, control: none}";
  EXPECT_EQ(run_program_file(without).status, 0);
}

}  // namespace
}  // namespace slipbench
