#include "detectors/hd/features.h"

#include <cmath>
#include <limits>
#include <vector>

#include "tests/detectors/hd/published.h"
#include "tests/expect.h"

namespace slipbench::hd {
namespace {

// A frame [m] with a single value other than zero.
std::vector<float> frame_with(std::size_t pillar, std::size_t axis, float value) {
  std::vector<float> displacement(27);
  displacement[3 * pillar + axis] = value;
  return displacement;
}

std::string refusal(std::size_t pillar, std::size_t axis, float value) {
  for (const Quantiser quantiser : {Quantiser::exact, Quantiser::unrounded}) {
    EXPECT_THROW(quantise(frame_with(pillar, axis, value), quantiser), InputError);
  }
  return refusal_of([&] { to_fixed(frame_with(pillar, axis, value)); });
}

// The nearest of the 21 levels as defined by the paper, in floating point.
int nearest_level(const FixedVector& d) {
  const double t = std::hypot(d[0], d[1]), all = std::hypot(t, d[2]);
  return all == 0.0 ? 0 : static_cast<int>(std::lround(20.0 * t / all));
}

TEST(Features, PublishedCodesGiveThePublishedLevelsAndContexts) {
  for (const PublishedRow& row : published_rows()) {
    const Frame expected = published_frame(row);
    for (std::size_t p = 0; p < pillar_count; ++p) {
      const auto code = static_cast<std::uint8_t>(row.at("raw" + std::to_string(p)));
      ASSERT_EQ(level_of_code(code), expected.level[p]) << "step " << row.at("n") << ", code " << int(code);
    }
    ASSERT_EQ(context_of(static_cast<std::int16_t>(row.at("z_press"))), expected.context) << "step " << row.at("n");
  }
}

TEST(Features, LevelsStartWhereTheHardwareStartsThem) {
  const std::vector<int> starts{0, 4, 8, 16, 24, 32, 36, 40, 48, 56, 64, 68, 72, 80, 88, 96, 100, 104, 112, 120, 128};
  ASSERT_EQ(starts.size(), level_count);
  for (std::size_t level = 0; level < level_count; ++level) {
    EXPECT_EQ(level_of_code(static_cast<std::uint8_t>(starts[level])), level);
    if (level == 0) continue;
    EXPECT_EQ(level_of_code(static_cast<std::uint8_t>(starts[level] - 1)), level - 1);
  }
  EXPECT_EQ(level_of_code(255), 20);
}

TEST(Features, ContextsAreThePapersIntervals) {
  // [0, 0.75], (0.75, 1], (1, 1.125] mm and above, on a grid of 1/8 mm; a pulled pillar is in the
  // first.
  const std::vector<std::pair<int, int>> expected{{-32768, 0}, {-1, 0}, {0, 0},  {6, 0},    {7, 1},
                                                  {8, 1},      {9, 2},  {10, 3}, {32767, 3}};
  for (const auto& [compression, context] : expected) {
    EXPECT_EQ(context_of(static_cast<std::int16_t>(compression)), context) << compression;
  }
}

// floor(128 |t| / |d|) is the largest c with c^2 |d|^2 <= 128^2 |t|^2.
TEST(Features, RatioIsTheFloorOfTheExactRatioUpToTheLimitsOfTheFormat) {
  const std::vector<int> values{-32768, -32767, -20000, -4097, -129, -17, -8,  -3,   -2,    -1,   0,
                                1,      2,      5,      7,     12,   100, 255, 3333, 16384, 32767};
  for (const int x : values) {
    for (const int y : values) {
      for (const int z : values) {
        const FixedVector d{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), static_cast<std::int16_t>(z)};
        const std::uint64_t code = ratio_code(d);
        const auto square = [](std::int64_t v) { return static_cast<std::uint64_t>(v * v); };
        const std::uint64_t t2 = square(x) + square(y), d2 = t2 + square(z);
        if (d2 == 0) {
          ASSERT_EQ(code, 0U);
          continue;
        }
        ASSERT_LE(code * code * d2, 16384 * t2) << x << " " << y << " " << z;
        ASSERT_GT((code + 1) * (code + 1) * d2, 16384 * t2) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(Features, KnownRatios) {
  EXPECT_EQ(ratio_code({3, 0, 4}), 76);    // 0.6 * 128 = 76.8
  EXPECT_EQ(ratio_code({0, -4, 3}), 102);  // 0.8 * 128 = 102.4
  EXPECT_EQ(ratio_code({5, 5, 0}), 128);
  EXPECT_EQ(ratio_code({0, 0, -9}), 0);
  EXPECT_EQ(ratio_code({-32768, -32768, -32768}), 104);  // sqrt(2 / 3) * 128 = 104.5
}

TEST(Features, RoundsToEighthsOfAMillimetreHalvesAwayFromZero) {
  const auto fixed = [](float metres) { return to_fixed(frame_with(5, 1, metres))[5][1]; };
  EXPECT_EQ(fixed(0.001F), 8);
  EXPECT_EQ(fixed(0.00106F), 8);     // 8.48
  EXPECT_EQ(fixed(-0.00107F), -9);   // -8.56
  EXPECT_EQ(fixed(1.0F / 128), 63);  // 62.5 units, exact in binary
  EXPECT_EQ(fixed(-1.0F / 128), -63);
}

TEST(Features, WhatLeavesTheFormatIsRefusedAndNeverClamped) {
  EXPECT_EQ(to_fixed(frame_with(0, 0, 4.095875F))[0][0], 32767);
  EXPECT_EQ(to_fixed(frame_with(0, 0, -4.096F))[0][0], -32768);
  // The nearest float32, to the nine digits that tell it apart.
  EXPECT_THAT(refusal(0, 0, 4.096F), mentions({"displacement", "pillar 0", "4.09600019 m", "4.095875 m"}));
  EXPECT_THAT(refusal(8, 1, -4.0962F), mentions({"pillar 8", "along y", "-4.09619999 m"}));
  EXPECT_THAT(refusal(2, 2, std::numeric_limits<float>::quiet_NaN()), mentions({"pillar 2", "along z", "NaN"}));
  EXPECT_THAT(refusal(4, 0, std::numeric_limits<float>::infinity()), mentions({"pillar 4", "along x", "infinite"}));
  EXPECT_THAT(refusal(4, 0, -std::numeric_limits<float>::infinity()), mentions({"pillar 4", "along x", "infinite"}));
  EXPECT_THAT(refusal(1, 1, std::numeric_limits<float>::max()), HasSubstr("Q13.3"));
  EXPECT_THROW(to_fixed(std::vector<float>(26)), std::out_of_range);
}

TEST(Features, NothingMovedIsLevelZero) {
  for (const Quantiser quantiser : {Quantiser::fixed_point, Quantiser::exact, Quantiser::unrounded}) {
    EXPECT_EQ(quantise(std::vector<float>(27), quantiser), Frame{});
  }
}

TEST(Features, AFrameOfThePad) {
  // Centre pressed by 1 mm with its tip dragged by 0.75 mm: 8 and 6 units, ratio 0.6, context
  // (0.75, 1].
  std::vector<float> displacement(27);
  displacement[12] = 0.75e-3F;  // values 12 to 14 are the centre's
  displacement[14] = 1e-3F;
  displacement[22] = -0.25e-3F;  // an edge pillar that is dragged but not pressed
  Frame expected;
  expected.level[4] = 12;  // code 76 lies in 72 to 79; 0.6 = 12 * 0.05
  expected.level[7] = 20;
  expected.context = 1;
  for (const Quantiser quantiser : {Quantiser::fixed_point, Quantiser::exact, Quantiser::unrounded}) {
    EXPECT_EQ(quantise(displacement, quantiser), expected);
  }
}

TEST(Features, ExactIsTheNearestLevelOfTheRoundedDisplacement) {
  for (int x = 0; x <= 40; ++x) {
    for (int y = -3; y <= 3; ++y) {
      for (int z = -40; z <= 40; ++z) {
        const FixedVector d{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), static_cast<std::int16_t>(z)};
        std::vector<float> metres(27);
        for (std::size_t axis = 0; axis < 3; ++axis) metres[axis] = static_cast<float>(d[axis]) / 8000;
        ASSERT_EQ(quantise(metres, Quantiser::exact).level[0], nearest_level(d)) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(Features, UnroundedSeesWhatTheGridLoses) {
  std::vector<float> displacement(27);
  displacement[0] = displacement[2] = 0.05e-3F;  // 0.4 units each: zero on the grid, and a ratio of sqrt(1/2) = 14.1 * 0.05
  EXPECT_EQ(quantise(displacement, Quantiser::exact).level[0], 0);
  EXPECT_EQ(quantise(displacement, Quantiser::unrounded).level[0], 14);
}

}  // namespace
}  // namespace slipbench::hd
