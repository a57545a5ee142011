#include "tools/dataset/trial_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "tests/tools/dataset/record/test_records.h"

namespace slipbench {
namespace {

using Change = std::function<void(TrialRecord&)>;

// Returns the difference that a change of the second of two equal trials causes.
std::string found(const std::string& libraries, const Change& change) {
  TrialRecord one = testing::make_record(3, 20);
  one.libraries = libraries;
  one.sensors.front().labels.slip_direction.assign(20, std::numbers::pi_v<float>);
  TrialRecord other = one;
  change(other);
  return trial_difference(one, other);
}

void scale_force(TrialRecord& record, float factor) {
  for (float& force : record.sensors.front().labels.force) force *= factor;
}

TEST(TrialDifference, OurOwnCodeAloneIsComparedBitByBit) {
  EXPECT_EQ(found("", [](TrialRecord& record) { scale_force(record, 1.0F + 1.2e-7F); }), "their digests differ");
}

TEST(TrialDifference, LibrariesOfOthersMayRound) {
  EXPECT_EQ(found("MuJoCo",
                  [](TrialRecord& record) {
                    for (float& force : record.sensors.front().labels.force) force = std::nextafter(force, INFINITY);
                  }),
            "");
  EXPECT_EQ(found("MuJoCo", [](TrialRecord& record) { record.sensors.front().labels.k_normal.front() *= 1.0 + 5e-10; }), "");
  EXPECT_EQ(found("FFTW",
                  [](TrialRecord& record) {
                    for (float& angle : record.sensors.front().labels.slip_direction) angle = -angle;
                  }),
            "");
}

// Rounding is 1e-9 of the larger number or of the array's scale: a value near zero has the rounding of
// the largest one.
TEST(TrialDifference, RoundingIsRelativeToTheArray) {
  EXPECT_TRUE(agree(0.0, 0.5e-9, 1.0));
  EXPECT_FALSE(agree(0.0, 2e-9, 1.0));
  EXPECT_FALSE(agree(0.0, 0.5e-9, 1e-3));
}

TEST(TrialDifference, AllElseDiffers) {
  const std::string labels = "labels/" + testing::make_record(3, 20).sensors.front().name;
  EXPECT_EQ(found("MuJoCo", [](TrialRecord& record) { scale_force(record, 1.0F + 1e-5F); }).substr(0, labels.size() + 6),
            labels + "/force");
  EXPECT_NE(found("MuJoCo", [](TrialRecord& record) { record.sensors.front().labels.k_normal.front() *= 1.0 + 1e-8; }), "");
  EXPECT_NE(found("MuJoCo", [](TrialRecord& record) { record.sensors.front().labels.slip_direction.back() -= 1e-4F; }), "");
  EXPECT_NE(found("MuJoCo", [](TrialRecord& record) { record.sensors.front().labels.state.back() ^= 1; }), "");
  for (const double wrong : {INFINITY, -INFINITY, NAN})
    EXPECT_NE(found("MuJoCo", [&](TrialRecord& record) { record.sensors.front().labels.k_normal.front() = wrong; }), "");
  EXPECT_NE(found("MuJoCo", [](TrialRecord& record) { record.params = R"({"motion.speed":0.5})"; }), "");
}

}  // namespace
}  // namespace slipbench
