#include "tests/expect.h"
#include "tools/program/calibrate/model.h"

namespace slipbench::calibrate {
namespace {

FitKey key(const std::string& text) { return parse_fit_keys(text).at(0); }

std::string refusal(const std::string& text) {
  return refusal_of([&] { parse_fit_keys(text); });
}

TEST(FitKey, HasItsBoundsInSi) {
  const FitKey stiffness = key("sensors.pad.k_normal: {min: 2 N/mm, max: 6000}");
  EXPECT_EQ(stiffness.path, "sensors.pad.k_normal");
  EXPECT_EQ(stiffness.min, 2000.0);
  EXPECT_EQ(stiffness.max, 6000.0);
  EXPECT_EQ(stiffness.quantity, Quantity::stiffness);
  EXPECT_FALSE(stiffness.each);
  EXPECT_EQ(stiffness.value(0.25), 3000.0);
  EXPECT_EQ(stiffness.place(5000.0), 0.75);
  EXPECT_EQ(stiffness.text(3210.0), "3.21 N/mm");
}

// The middle of 1 and 100 by their logarithms is 10.
TEST(FitKey, IsSearchedByItsLogarithm) {
  const FitKey friction = key("friction.scale: {draw: log_uniform, min: 1, max: 100, each: true}");
  EXPECT_TRUE(friction.each);
  EXPECT_DOUBLE_EQ(friction.value(0.5), 10.0);
  EXPECT_DOUBLE_EQ(friction.place(10.0), 0.5);
}

TEST(FitKey, SeveralStandInOneMap) {
  EXPECT_EQ(parse_fit_keys("{motion.tilt.0: {min: -1 deg, max: 1 deg}, lag: {min: 0 s, max: 1 ms}}").size(), 2U);
}

TEST(FitKey, RefusesWhatIsNoBound) {
  EXPECT_THAT(refusal("friction.scale"), HasSubstr("allowed: a map of KEY: {min: .., max: ..}"));
  EXPECT_THAT(refusal("friction.scale: 0.5"), HasSubstr("friction.scale is '0.5'; allowed: a map of {min: .., max: ..}"));
  EXPECT_THAT(refusal("friction.scale: {min: 0.5}"), HasSubstr("no key 'max' in friction.scale"));
  EXPECT_THAT(refusal("friction.scale: {min: 0.5, mox: 1}"), HasSubstr("did you mean 'max'"));
  EXPECT_THAT(refusal("friction.scale: {min: 1, max: 0.5}"),
              HasSubstr("min is 1 and max is 0.5; allowed: finite bounds, min below max"));
  EXPECT_THAT(refusal("motion.compression: {min: 1 mm, max: 2 N}"),
              HasSubstr("motion.compression.max is '2 N'; allowed: a number in m"));
  EXPECT_THAT(refusal("motion.compression: {min: one, max: 2 mm}"), HasSubstr("motion.compression.min: "));
  EXPECT_THAT(refusal("friction.scale: {min: 0, max: 1, draw: log_uniform}"),
              HasSubstr("min is 0; allowed with draw: log_uniform: above 0"));
  EXPECT_THAT(refusal("friction.scale: {min: 0, max: 1, draw: normal}"), HasSubstr("allowed: uniform or log_uniform"));
}

}  // namespace
}  // namespace slipbench::calibrate
