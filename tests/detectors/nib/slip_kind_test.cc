// No slip, linear, rotational: what the features say, and the state that the detector makes of it.
#include "detectors/nib/slip_detectors.h"

#include <gtest/gtest.h>

#include "detectors/detector_kinds.h"
#include "tests/detectors/nib/nib_frames.h"

namespace slipbench::nib {
namespace {

TEST(SlipKind, IsReadOffThreeFeatures) {
  const KindBounds bounds{40.0, 50.0, 0.9};
  const auto kind = [&](double fl, double fr, double curl) { return slip_kind({.fl = fl, .fr = fr, .curl = curl}, bounds); };
  EXPECT_EQ(kind(40.0, 50.0, 1.8), SlipKind::none);
  EXPECT_EQ(kind(41.0, 0.0, 0.89), SlipKind::linear);
  EXPECT_EQ(kind(0.0, 51.0, -0.89), SlipKind::linear);
  EXPECT_EQ(kind(0.0, 51.0, 0.9), SlipKind::rotational);
  EXPECT_EQ(kind(41.0, 0.0, -0.9), SlipKind::rotational);  // either way round
}

// 4 counts at 4 Hz are a mean of 75 in their mode, above the bound of 40; seen when the first window is full.
TEST(SlipKind, IsSlipForTheLoopWhateverItsKind) {
  for (const bool linear : {true, false}) {
    const auto detector = nib_slip_kind_detector().create(defaults_of(nib_slip_kind_detector().about.parameters), nib_source());
    NibFrames frames;
    frames.vibrate(linear ? 4.0 : 0.0, linear ? 0.0 : 4.0);
    PadState state{};
    for (int n = 1; n < 150; ++n) {
      if (n == 92) frames.load({10, 10, 10, 10});
      state = detector->update(frames.next()).state;
      EXPECT_EQ(state, n < 92 ? PadState::no_contact : PadState::non_slip) << n;
    }
    EXPECT_EQ(detector->update(frames.next()).state, PadState::gross);
  }
}

}  // namespace
}  // namespace slipbench::nib
