// Runs every example of the help texts as printed.
#include <fstream>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string scenes = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/";

// The lines of a help text that begin with "  slipbench ".
std::vector<std::string> examples_of(const std::string& command) {
  std::istringstream help(run_program_file({command, "--help"}).out);
  std::vector<std::string> examples;
  for (std::string line; std::getline(help, line);) {
    if (line.starts_with("  slipbench ")) examples.push_back(line.substr(2));
  }
  return examples;
}

// The sweep of 200 long trials is replaced by 50 short ones, because writing all of them as text
// takes long.
std::string shortened(const std::string& sweep) {
  const std::string fewer = std::regex_replace(sweep, std::regex("motion.compression: \\[.*\\]"), "motion.compression: [1 mm]");
  return std::regex_replace(fewer, std::regex("duration: 4 s"), "duration: 2.5 s");
}

// Runs the examples of the commands in a folder with the scenes that they name, in the order of the
// commands, because later examples read the output of earlier ones.
void check_examples(std::initializer_list<const char*> commands) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "scenes/papillarray");
  std::filesystem::copy(scenes + "stage.yaml", folder / "scenes/papillarray/stage.yaml");
  // Uses one scene instead of the whole folder.
  std::filesystem::create_directories(folder / "scenes/grasp");
  std::filesystem::copy(SLIPBENCH_SOURCE_DIR "/scenes/grasp/check_ptfe.yaml", folder / "scenes/grasp/check_ptfe.yaml");
  std::filesystem::create_directories(folder / "mine");
  std::ofstream(folder / "mine/press.csv") << "t,load\n0,0.1\n0.01,0.2\n0.02,0.3\n";
  const std::string whole = bytes_of(scenes + "hexapod.yaml");
  ASSERT_NE(shortened(whole), whole);
  std::ofstream(folder / "scenes/papillarray/hexapod.yaml") << shortened(whole);
  for (const char* command : commands) {
    const std::vector<std::string> examples = examples_of(command);
    EXPECT_FALSE(examples.empty()) << command;
    for (const std::string& example : examples) {
      if (example.find("--recordings") != std::string::npos) continue;  // needs downloads; studies_real tests it
      const ChildResult result = run_shell(example, folder / "");
      EXPECT_EQ(result.status, 0) << example << "\n" << result.err;
    }
  }
}

// The example of `benchmark` takes minutes; tests/tools/benchmark tests the same with fewer trials.
TEST(Help, EveryExampleWorks) {
  check_examples({"run", "sweep", "check", "report", "verify", "merge", "export", "import", "train", "train-hd", "eval", "detect",
                  "reproduce", "list", "describe", "schema", "help", "completion", "man"});
}

TEST(Help, ExamplesOfQuickCommandsWork) { check_examples({"run", "list", "describe", "schema", "help", "completion", "man"}); }

}  // namespace
}  // namespace slipbench
