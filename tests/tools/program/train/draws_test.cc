#include "tools/program/train/draws.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

namespace slipbench::testing {
namespace {

// 20 conditions of 10 items each, mixed.
std::vector<std::size_t> mixed_conditions() {
  std::vector<std::size_t> conditions(200);
  for (std::size_t i = 0; i < conditions.size(); ++i) conditions[i] = 7 * i % 20;
  return conditions;
}

CommandedMotion moving(double speed, double rotation, double compression) { return {speed, rotation, compression}; }

TEST(Conditions, CompressionHasThePapersFourBands) {
  const auto band = [](double compression) { return condition_of(moving(1e-3, 0.0, compression)); };
  EXPECT_EQ(band(0.1e-3), band(0.75e-3));
  EXPECT_EQ(band(0.76e-3), band(1e-3));
  EXPECT_EQ(band(1.01e-3), band(1.125e-3));
  EXPECT_EQ(band(1.13e-3), band(5e-3));
  EXPECT_EQ((std::set{band(0.6e-3), band(0.9e-3), band(1.05e-3), band(1.3e-3)}.size()), 4U);
}

TEST(Conditions, ATurnCountsByTheSpeedOfACornerPillar) {
  // 2.9 deg/s at 9.9 mm are 0.501 mm/s.
  const double turn = 2.9 * std::numbers::pi / 180.0;
  EXPECT_EQ(condition_of(moving(0.0, -turn, 1e-3)), condition_of(moving(0.5e-3, 0.0, 1e-3)));
  EXPECT_EQ(condition_of(moving(0.5e-3, turn, 1e-3)), condition_of(moving(0.5e-3, 0.0, 1e-3)));
  std::set<std::size_t> different;
  for (const double speed : {0.0, 0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 16e-3})
    different.insert(condition_of(moving(speed, 0.0, 1e-3)));
  EXPECT_EQ(different.size(), 7U);
}

TEST(Bootstrap, EveryConditionTrainsAsOftenAsItHasItems) {
  const std::vector<std::size_t> conditions = mixed_conditions();
  for (std::size_t draw = 0; draw < draw_count; ++draw) {
    const BootstrapDraw drawn = bootstrap(conditions, 3, draw);
    std::map<std::size_t, std::size_t> times;
    for (std::size_t i = 0; i < conditions.size(); ++i) times[conditions[i]] += drawn.times[i];
    for (const auto& [condition, sum] : times) EXPECT_EQ(sum, 10U) << condition;
    EXPECT_EQ(drawn.training_size(), 200U);
  }
}

TEST(Bootstrap, LeavesTheShareOfTheClosedForm) {
  // Each of 10 items is missed by 10 draws with probability 0.9^10 = 0.34868. 300 draws of 200 items: the standard error is at most
  // sqrt(0.349 0.651 / 60,000) = 0.0019.
  const std::vector<std::size_t> conditions = mixed_conditions();
  std::size_t tested = 0;
  for (std::size_t draw = 0; draw < 300; ++draw) tested += 200 - bootstrap(conditions, 1, draw).distinct();
  EXPECT_NEAR(static_cast<double>(tested) / 60000.0, std::pow(0.9, 10), 4 * 0.0019);
}

TEST(Bootstrap, AnOnlyItemOfItsConditionAlwaysTrains) {
  const std::vector<std::size_t> conditions{5, 1, 2};
  for (std::size_t draw = 0; draw < 10; ++draw)
    EXPECT_EQ(bootstrap(conditions, 1, draw).times, (std::vector<std::uint32_t>{1, 1, 1}));
}

TEST(Bootstrap, DependsOnSeedAndDrawAlone) {
  const std::vector<std::size_t> conditions = mixed_conditions();
  const std::vector<std::uint32_t> first = bootstrap(conditions, 1, 0).times;
  EXPECT_EQ(bootstrap(conditions, 1, 0).times, first);
  EXPECT_NE(bootstrap(conditions, 1, 1).times, first);
  EXPECT_NE(bootstrap(conditions, 2, 0).times, first);
}

}  // namespace
}  // namespace slipbench::testing
