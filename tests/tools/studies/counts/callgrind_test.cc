#include "tools/studies/counts/callgrind.h"

#include <string>

#include <fmt/format.h>

#include "tests/expect.h"
#include "tests/tools/studies/counts/sample.h"

namespace slipbench::counts {
namespace {

// The sample with `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to) { return replaced(sample_profile, from, to); }

std::string profile_refusal(const std::string& text) {
  return refusal_of([&] { parse_callgrind(text, "profile"); });
}

TEST(Callgrind, OwnInstructionsOfEachFunctionAndTheSteps) {
  const InstructionProfile profile = parse_callgrind(sample_profile, "profile");
  EXPECT_EQ(profile.instructions, 100U);
  EXPECT_EQ(profile.steps, 40U);
  EXPECT_THAT(profile.self, ElementsAre(Pair("slipbench::Field::step", 30), Pair("slipbench::StageSimulation::step", 60),
                                        Pair("slipbench::run_trial", 10)));
}

// A grasp's bench steps the bench below it: one step, not two.
TEST(Callgrind, AStepWithinAStepIsOne) {
  EXPECT_EQ(parse_callgrind(changed("slipbench::Field::step(double) [clone .cold]\n", "slipbench::DynamicSimulation::step()\n"),
                            "profile")
                .steps,
            40U);
}

TEST(Callgrind, ACostOfZeroMayBeLeftOut) {
  EXPECT_EQ(parse_callgrind(changed("+3 2\n", "+3\n+1 2\n"), "profile").instructions, 100U);
}

TEST(Callgrind, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(profile_refusal(""), HasSubstr("profile:0: not what callgrind writes: the total is missing"));
  EXPECT_THAT(profile_refusal(changed("totals: 100\n", "")), HasSubstr("the total is missing"));
  EXPECT_THAT(profile_refusal(changed("totals: 100", "totals: 101")), HasSubstr("add up to 100 instructions, the total is 101"));
  EXPECT_THAT(profile_refusal(changed("events: Ir", "events: Ir Dr")),
              HasSubstr("profile:13: not what callgrind writes: events are 'Ir Dr'"));
  EXPECT_THAT(profile_refusal(changed("positions: line", "positions: instr line")), HasSubstr("positions are 'instr line'"));
  EXPECT_THAT(profile_refusal(changed("fn=(13)\n", "fn=(14)\n")), HasSubstr("function (14) has no name"));
  EXPECT_THAT(profile_refusal(changed("fn=(10) ", "fn=10 ")), HasSubstr("a function without its number"));
  EXPECT_THAT(profile_refusal(changed("fn=(10) slipbench::run_trial(slipbench::Scene const&, unsigned long)\n", "")),
              HasSubstr("a cost that belongs to no function"));
  EXPECT_THAT(profile_refusal(changed("0 8", "0 8 9")), HasSubstr("'8 9' is no count"));
  EXPECT_THAT(profile_refusal(changed("0 8", "<html>")), HasSubstr("found '<html>'"));
  EXPECT_THAT(profile_refusal(sample_profile.substr(0, sample_profile.find("* 90"))), HasSubstr("a call without its cost"));
}

TEST(Callgrind, NamesWithoutWhatVaries) {
  EXPECT_EQ(function_name("mj_rne"), "mj_rne");
  EXPECT_EQ(function_name("a::f(int, g (*)(char)) const"), "a::f");
  EXPECT_EQ(function_name("a::f(int) [clone .arch_x86_64_v3] [clone .cold]'2"), "a::f");
  EXPECT_EQ(function_name("a::(anonymous namespace)::f(int) &&"), "a::(anonymous namespace)::f");
  EXPECT_EQ(function_name("a::operator()(int) const"), "a::operator()");
  EXPECT_EQ(function_name("a::operator()"), "a::operator()");
  EXPECT_EQ(function_name("a::f(int)::{lambda(int)#1}::operator()(int) const'12"), "a::f(int)::{lambda(int)#1}::operator()");
  EXPECT_EQ(function_name("int a::f<char>(char)"), "int a::f<char>");
  EXPECT_EQ(function_name("(below main)"), "(below main)");
  EXPECT_EQ(function_name("0x00000000000cafe0"), "0x00000000000cafe0");
}

}  // namespace
}  // namespace slipbench::counts
