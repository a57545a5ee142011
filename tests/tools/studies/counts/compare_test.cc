#include "tools/studies/counts/results.h"

#include <string>

#include "tests/expect.h"
#include "tests/tools/studies/counts/sample.h"
#include "tools/studies/counts/count.h"

namespace slipbench::counts {
namespace {

SceneChange change_to(std::uint64_t instructions, std::vector<FunctionCount> functions) {
  Results now = sample_results();
  now.scenes[0].instructions = instructions;
  now.scenes[0].functions = std::move(functions);
  return compare(sample_results(), now).at(0);
}

TEST(BenchCompare, TwoPercentAreAllowedAndNoMore) {
  EXPECT_FALSE(change_to(1020, {{"a::step", 620}}).grew());
  EXPECT_TRUE(change_to(1021, {{"a::step", 621}}).grew());
  EXPECT_FALSE(change_to(980, {{"a::step", 580}}).shrank());
  EXPECT_TRUE(change_to(979, {{"a::step", 579}}).shrank());
  EXPECT_FALSE(change_to(979, {{"a::step", 579}}).grew());
  EXPECT_DOUBLE_EQ(change_to(1500, {{"a::step", 1100}}).growth(), 0.5);
}

// Before: a::step 600, b::step 300, any other at most 300. Now: a::step + 50, b::step gone, - 300, new ones 310, at least + 10,
// and 299, which may have been there before.
TEST(BenchCompare, FunctionsThatChangedMostComeFirst) {
  const SceneChange change = change_to(1300, {{"a::step", 650}, {"c::step", 310}, {"d::step", 299}});
  ASSERT_EQ(change.functions.size(), 3U);
  EXPECT_EQ(change.functions[0].name, "b::step");
  EXPECT_EQ(change.functions[0].difference(), -300);
  EXPECT_EQ(change.functions[1].name, "a::step");
  EXPECT_EQ(change.functions[1].difference(), 50);
  EXPECT_EQ(change.functions[2].name, "c::step");
  EXPECT_EQ(change.functions[2].difference(), 10);
  EXPECT_FALSE(change.functions[2].listed);
  EXPECT_TRUE(change.functions[1].listed);
}

TEST(BenchCompare, NothingChanged) {
  const SceneChange change = change_to(1000, sample_results().scenes[0].functions);
  EXPECT_EQ(change.growth(), 0.0);
  EXPECT_TRUE(change.functions.empty());
}

std::string comparability(const Results& before, const Facts& build) {
  return refusal_of([&] { check_comparable(before, build, "ci.json"); });
}

TEST(BenchCompare, OnlyResultsOfTheSameBuildAndScenes) {
  Results before = sample_results();
  before.scenes.clear();
  for (const std::string_view scene : reference_scenes()) {
    before.scenes.push_back(sample_results().scenes[0]);
    before.scenes.back().scene = scene;
  }
  Facts build = before.build;
  EXPECT_EQ(comparability(before, build), "accepted");
  build[1].second = "x86_64";
  EXPECT_THAT(
      comparability(before, build),
      HasSubstr(
          "ci.json: counts of another build cannot be compared: it is of another instruction set ('x86_64 with AVX2' there, 'x86_64' here)"));
  before.scenes.pop_back();
  EXPECT_THAT(comparability(before, before.build), HasSubstr("to count again: slipbench bench -o ci.json"));
}

}  // namespace
}  // namespace slipbench::counts
