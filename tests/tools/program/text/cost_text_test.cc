#include "tools/program/text/eval_text.h"

#include "tests/expect.h"
#include "tests/tools/program/cost/example.h"

namespace slipbench {
namespace {

using ::testing::ContainsRegex;

std::string text_of(const cost::Exploration& exploration) { return cost_text(exploration, Style(false), 120); }

TEST(CostText, SaysFirstWhatAnErrorCosts) {
  cost::Exploration exploration = cost::example();
  exploration.description = "a slide";
  EXPECT_THAT(text_of(exploration), StartsWith("a slide\n  1 % slip onset error costs 1/500 of real time"));
}

// 2 s in 4 ms: 500 times real time; 0.005 is 0.5 %.
TEST(CostText, EverySettingHasALineBelowItsSeries) {
  const std::string text = text_of(cost::example());
  EXPECT_THAT(text, ContainsRegex("setting +x real time +CPU ms +\\+- +onset \\[%\\]\n"));
  EXPECT_THAT(text, ContainsRegex("    5 ms +500 +4 +0 % +0\\.5\n"));
  EXPECT_LT(text.find("element field"), text.find("MuJoCo's own contact\n"));
}

TEST(CostText, WhatDidNotRunSaysWhyOnce) {
  cost::Exploration exploration = cost::example();
  exploration.rows.push_back(exploration.rows.back());
  exploration.rows.back().setting.label = "stiffer";
  EXPECT_THAT(text_of(exploration), HasSubstr("  contact stiff; contact stiffer: MuJoCo warned\n"));
}

TEST(CostText, ARunInWhichOtherThingsHappenHasNoNumber) {
  cost::Exploration exploration = cost::example();
  exploration.rows[1].errors = cost::onset_error(0.05, true);
  EXPECT_THAT(text_of(exploration), ContainsRegex("    10 ms +1000 +2 +0 % +other\n"));
}

TEST(CostText, PricesStandBelow) {
  cost::Exploration exploration = cost::example();
  EXPECT_THAT(text_of(exploration), Not(HasSubstr("what each effect")));
  exploration.prices = {
      {.name = "ageing", .without = cost::CpuTime{0.015, 0.014, 0.016, 9}, .share = 0.25, .low = 0.2, .high = 0.3}};
  EXPECT_THAT(text_of(exploration), HasSubstr("  ageing      25.0 %  20.0 to 30.0"));
}

}  // namespace
}  // namespace slipbench
