#include <array>
#include <vector>

#include "detectors/detector_kinds.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

std::unique_ptr<Detector> detector(const DetectorKind& kind) {
  const FrameSource gel{"gel", "gel_markers", 25.0, {{"displacement", "m", {4, 3}, {}}, {"pixel", "px", {4, 2}, {}}}};
  return kind.create(defaults_of(kind.about.parameters), gel);
}

// Four markers at the corners of a square of 100 px, 0.5 mm deep, that have moved along x and y by
// `moved` [um].
PadState state_after(Detector& detector, const std::array<float, 8>& moved, float depth = 5e-4F) {
  std::vector<float> values;
  for (std::size_t i = 0; i < 4; ++i) values.insert(values.end(), {1e-6F * moved[2 * i], 1e-6F * moved[2 * i + 1], depth});
  values.insert(values.end(), {100, 100, 200, 100, 100, 200, 200, 200});
  return detector.update({0.0, values}).state;
}

// A shift by (300, 100) um and a turn that moves the corners by 50 um along x and y each are
// rigid. Picture rows run down. With one marker 100 um less along x, its residual from the best
// motion is 100 (1 - 1/4 - 50^2/20,000) um = 62.5 um, and the others' are below 38 um; with 70 um
// less it is 44 um.
TEST(MarkerDeviation, TellsMarkersThatLeaveTheRigidMotion) {
  const auto deviation = detector(marker_deviation_detector());
  EXPECT_EQ(state_after(*deviation, {}, 0.5e-4F), PadState::no_contact);
  EXPECT_EQ(state_after(*deviation, {10, 20, 10, 20, 10, 20, 10, 20}), PadState::non_slip);
  EXPECT_EQ(state_after(*deviation, {260, 70, 260, 170, 360, 70, 360, 170}), PadState::non_slip);
  EXPECT_EQ(state_after(*deviation, {260, 70, 260, 170, 360, 70, 290, 170}), PadState::non_slip);
  EXPECT_EQ(state_after(*deviation, {260, 70, 260, 170, 360, 70, 260, 170}), PadState::incipient);
  EXPECT_EQ(state_after(*deviation, {300, 0, 0, 0, 0, 0, 300, 0}), PadState::gross);  // all 150 um off the mean
  EXPECT_EQ(state_after(*deviation, {}, 0.5e-4F), PadState::no_contact);
  EXPECT_EQ(state_after(*deviation, {300, 0, 0, 0, 0, 0, 300, 0}), PadState::non_slip);  // a new touch starts anew
}

// Bins of 30 um: four markers in two bins have 1 bit; in four bins 2 bits, the threshold.
TEST(MarkerEntropy, TellsUnevenMotion) {
  const auto entropy = detector(marker_entropy_detector());
  EXPECT_EQ(state_after(*entropy, {}), PadState::non_slip);
  EXPECT_EQ(state_after(*entropy, {100, 0, 0, 100, 10, 0, 0, 10}), PadState::non_slip);
  EXPECT_EQ(state_after(*entropy, {100, 0, 0, 70, 40, 0, 0, 40}), PadState::non_slip);  // 1.5 bits
  EXPECT_EQ(state_after(*entropy, {100, 0, 0, 70, 40, 0, 0, 10}), PadState::incipient);
}

TEST(MarkerEntropy, RefusesASensorWithoutMarkers) {
  const FrameSource pad{"pad", "papillarray", 1e3, {{"displacement", "m", {9, 3}, {}}}};
  const DetectorKind kind = marker_entropy_detector();
  EXPECT_THAT(refusal_of([&] { static_cast<void>(kind.create(defaults_of(kind.about.parameters), pad)); }),
              refused_at("detector.sensor", {"pixel", "papillarray", "pad"}));
}

}  // namespace
}  // namespace slipbench
