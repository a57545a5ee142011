// Custom libraries on the command line: the reported line of the scene, the exit status, and
// crashed trials.
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string pressed_scene = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
const std::string own_detector = "detector={type: plugin, library: " SLIPBENCH_TEST_PLUGINS "/";

// One trial of a second, in which the pad is pressed.
ChildResult run_own(const std::string& library, const std::string& wrong = "", const std::string& more = "",
                    const std::string& where = "--isolate") {
  ::setenv("SLIPBENCH_WRONG", wrong.c_str(), 1);
  ChildResult result = run_program_file({"run", pressed_scene, "--set", "duration=1 s", "--set", "motion.start=0.5 s", "--set",
                                         own_detector + library + ".so" + more + "}", "--json", where});
  ::unsetenv("SLIPBENCH_WRONG");
  return result;
}

TEST(PluginProgram, RunsTheExampleOfADetector) {
  const ChildResult result = run_own("ratio_gate", "", ", parameters: {threshold: 0.4}");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("trials").at(0).at("detector").at("type"), "plugin");
}

TEST(PluginProgram, NamesTheLineOfAParameter) {
  const ChildResult result = run_own("ratio_gate", "", ", parameters: {treshold: 0.4}");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--set detector="), HasSubstr(": detector.parameters.treshold: '"),
                                mentions({"treshold", "threshold", "warning", "touch", "rate"})));
}

TEST(PluginProgram, RefusesWrongLibraries) {
  for (const std::string wrong : {"version=3", "size0=8", "rate=nan", "rate=300", "rows=2", "make=1", "crash=7,in=2"}) {
    const ChildResult result = run_own("wrong", wrong);
    EXPECT_EQ(result.status, 2) << wrong;
    EXPECT_EQ(result.out, "") << wrong;
    EXPECT_THAT(result.err, AllOf(HasSubstr("detector.library: '"), HasSubstr("wrong.so'"))) << wrong;
  }
}

// A crash fails an isolated trial; without isolation the signal ends the program.
TEST(PluginProgram, ACrashFailsAnIsolatedTrial) {
  const ChildResult isolated = run_own("wrong", "crash=1,in=3");
  EXPECT_EQ(isolated.status, 2) << isolated.err;
  EXPECT_THAT(isolated.err, HasSubstr("trial 0: its worker process was killed by SIGSEGV"));
  const ChildResult before = run_own("wrong", "crash=1,in=2");
  EXPECT_EQ(before.status, 2);
  EXPECT_THAT(before.err, HasSubstr("before the first trial: its process was killed by SIGSEGV"));
  EXPECT_NE(run_own("wrong", "crash=1,in=3", "", "--no-isolate").status, 0);
}

// A library that ends the process early fails at any call: no incomplete trial counts as finished.
TEST(PluginProgram, ExitInAnIsolatedTrialIsNoSuccess) {
  for (const std::string in : {"1", "2", "3", "4"}) {
    const ChildResult result = run_own("wrong", "crash=8,in=" + in);
    EXPECT_EQ(result.status, 2) << in;
    EXPECT_EQ(result.out, "") << in;
    EXPECT_THAT(result.err, HasSubstr("ended with status 0 before its work was done")) << in;
  }
}

TEST(PluginProgram, NamesWhatIsNoEstimate) {
  for (const std::string wrong : {"state=4", "latency=nan", "stuck=7"}) {
    const ChildResult result = run_own("wrong", wrong);
    EXPECT_THAT(result.status, AnyOf(1, 2)) << wrong;
    EXPECT_THAT(result.err + result.out, AllOf(HasSubstr("trial 0: "), HasSubstr("wrong.so'"))) << wrong;
  }
}

}  // namespace
}  // namespace slipbench
