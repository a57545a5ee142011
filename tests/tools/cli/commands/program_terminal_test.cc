// The built program on a terminal: colours and a progress bar.

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench::program_terminal_test {
namespace {

const std::string stage = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";

TEST(ProgramOnATerminal, UsesColours) {
  const ChildResult result = run_program_terminal({"list", "materials"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("acrylic"), HasSubstr("\033[1;36mmaterials\033[0m")));
}

TEST(ProgramOnATerminal, HonoursNoColor) {
  EXPECT_THAT(run_program_terminal({"list", "materials"}, {"NO_COLOR=1"}).out,
              AllOf(HasSubstr("acrylic"), Not(HasSubstr("\033"))));
  EXPECT_THAT(run_program_terminal({"list", "materials"}, {"TERM=dumb"}).out, Not(HasSubstr("\033")));
  EXPECT_THAT(run_program_terminal({"swep"}, {"NO_COLOR=1"}).out, AllOf(HasSubstr("unknown command"), Not(HasSubstr("\033"))));
}

TEST(ProgramOnATerminal, AnEmptyNoColorCountsAsUnset) {
  EXPECT_THAT(run_program_terminal({"list", "materials"}, {"NO_COLOR="}).out, HasSubstr("\033"));
}

TEST(ProgramOnATerminal, DrawsAProgressBar) {
  const ChildResult result = run_program_terminal({"sweep", stage, "--trials", "20"});
  EXPECT_EQ(result.status, 0);
  // At the end the bar is full: 30 marks.
  EXPECT_THAT(result.out, HasSubstr("\r\033[K[" + std::string(30, '#') + "] 100 % 20/20"));
}

TEST(ProgramOnATerminal, NoBarWithJsonOrQuiet) {
  EXPECT_THAT(run_program_terminal({"sweep", stage, "--trials", "20", "--json"}).out, Not(HasSubstr("\033")));
  EXPECT_EQ(run_program_terminal({"sweep", stage, "--trials", "20", "--quiet"}).out, "");
}

}  // namespace
}  // namespace slipbench::program_terminal_test
