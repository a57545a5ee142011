// Algorithm 1 replayed by hand, and the detector around it; then the kinds of slip and the
// resulting state.
#include "detectors/nib/slip_detectors.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "detectors/detector_kinds.h"
#include "tests/detectors/nib/nib_frames.h"

namespace slipbench::nib {
namespace {

// M 4, alpha 10, TIME_THRES 0.25 s.
constexpr FlagCounter::Settings by_hand{40.0, 4.0, 10.0, 0.25};

TEST(FlagCounter, CountsAsAlgorithmOneDoes) {
  FlagCounter counter(by_hand);
  struct Row {
    double time, magnitude, ratio;
    int count;
    bool detected;
  };
  for (const Row& row : {
           Row{0.1, 50.0, 0.1, 1, false},   // a flag; the limit is 3
           Row{0.2, 40.0, 0.1, 1, false},   // not above the threshold; the last flag is 0.1 s ago
           Row{0.3, 10.0, 0.1, 1, false},   // 0.2 s ago
           Row{0.4, 10.0, 0.1, 0, false},   // 0.3 s ago: minus one
           Row{0.5, 10.0, 0.9, 0, false},   // not below 0; the limit is at least 1, otherwise this were slip
           Row{0.6, 50.0, 0.1, 1, false},   //
           Row{0.7, 50.0, 0.1, 2, false},   //
           Row{0.8, 50.0, 0.05, 3, false},  // the limit is 3.5
           Row{0.9, 10.0, 0.1, 3, true},    // no flag, but the limit has fallen to 3
           Row{2.0, 10.0, 0.0, 2, true},    // once detected, slip stays detected
       }) {
    EXPECT_EQ(counter.update(row.time, row.magnitude, row.ratio), row.detected) << row.time;
    EXPECT_EQ(counter.count(), row.count) << row.time;
  }
}

std::unique_ptr<Detector> detector(const char* ratio) {
  Parameters parameters = defaults_of(nib_linear_slip_detector().about.parameters);
  parameters.set("ratio", std::string(ratio));
  parameters.set("threshold", 40.0);
  parameters.set("normal_gain", 2.0);
  parameters.set("shear_gain", 6.0);
  return nib_linear_slip_detector().create(parameters, nib_source());
}

// Returns the frame in which slip is first reported for a pad that vibrates with `amplitude` counts
// and is loaded after the tare, at frame 91.
int detection(Detector& detector, double amplitude, const std::array<float, electrodes>& load) {
  NibFrames frames;
  frames.vibrate(amplitude, 0.0);
  for (int n = 0; n < 600; ++n) {
    if (n == 91) frames.load(load);
    const SlipEstimate& estimate = detector.update(frames.next());
    EXPECT_EQ(estimate.state == PadState::no_contact, n < 91 || load[0] == 0.0F) << n;
    if (estimate.state == PadState::gross) return frames.frames();
  }
  return 0;
}

// 4 counts at 4 Hz have a mean of 75, above 40. Spectra end at frames 150, 180, ...; so the k-th
// flag is at 150 + 30 (k - 1).
TEST(LinearSlip, WaitsForAsManyFlagsAsTheRatioAsks) {
  // Without shear: nine flags.
  EXPECT_EQ(detection(*detector("forces"), 4.0, {10, 10, 10, 10}), 150 + 30 * 8);
  // 9*(18 - 2) counts along y over 9*40: 0.4, which leaves 5. In newtons a third of that, 0.1333:
  // 7.67, so 8.
  EXPECT_EQ(detection(*detector("counts"), 4.0, {10, 18, 10, 2}), 150 + 30 * 4);
  EXPECT_EQ(detection(*detector("forces"), 4.0, {10, 18, 10, 2}), 150 + 30 * 7);
  // The pull may have either sign.
  EXPECT_EQ(detection(*detector("counts"), 4.0, {10, 2, 10, 18}), 150 + 30 * 4);
  // Shear across the pull does not count.
  EXPECT_EQ(detection(*detector("counts"), 4.0, {2, 10, 18, 10}), 150 + 30 * 8);
  // 2 counts have a mean of 37.5: no flag.
  EXPECT_EQ(detection(*detector("forces"), 2.0, {10, 10, 10, 10}), 0);
  // A pad without contact does not slip.
  EXPECT_EQ(detection(*detector("forces"), 4.0, {0, 0, 0, 0}), 0);
}

TEST(LinearSlip, BeginsAnewWhenThePadHasLetGo) {
  const auto detected = detector("forces");
  NibFrames frames;
  const auto state = [&] { return detected->update(frames.next()).state; };
  for (int n = 0; n < 99; ++n) state();
  frames.vibrate(4.0, 0.0);
  frames.load({10, 10, 10, 10});
  EXPECT_EQ(state(), PadState::non_slip);
  for (int n = 0; n < 400; ++n) state();
  EXPECT_EQ(state(), PadState::gross);
  frames.load({0, 0, 0, 0});
  EXPECT_EQ(state(), PadState::no_contact);
  frames.load({10, 10, 10, 10});
  EXPECT_EQ(state(), PadState::non_slip);
}

TEST(SlipKind, IsReadOffThreeFeatures) {
  const KindBounds bounds{40.0, 50.0, 0.9};
  const auto kind = [&](double fl, double fr, double curl) { return slip_kind({.fl = fl, .fr = fr, .curl = curl}, bounds); };
  EXPECT_EQ(kind(40.0, 50.0, 1.8), SlipKind::none);
  EXPECT_EQ(kind(41.0, 0.0, 0.89), SlipKind::linear);
  EXPECT_EQ(kind(0.0, 51.0, -0.89), SlipKind::linear);
  EXPECT_EQ(kind(0.0, 51.0, 0.9), SlipKind::rotational);
  EXPECT_EQ(kind(41.0, 0.0, -0.9), SlipKind::rotational);  // either way round
}

// 4 counts at 4 Hz have a mean of 75 in their mode, above the bound of 40; seen when the first
// window is full.
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
