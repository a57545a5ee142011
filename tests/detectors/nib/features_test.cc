// What is read from frames: tare, touch, bands, and what is refused.
#include "detectors/nib/features.h"

#include <algorithm>

#include "tests/detectors/nib/nib_frames.h"
#include "tests/expect.h"

namespace slipbench::nib {
namespace {

FeatureReader reader(const FrameSource& source = nib_source(), const char* name = "", double value = 0.0) {
  Parameters parameters = defaults_of(feature_specs());
  if (*name != '\0') parameters.set(name, value);
  return {parameters, source, "a test"};
}

std::string refusal(const FrameSource& source, const char* name = "", double value = 0.0) {
  return refusal_of([&] { reader(source, name, value); });
}

// 300 ms are 90 frames. Taxels with changes W 1, N 7, E 3, S 2: normal 13, shear (2, 5), nine of them.
TEST(Features, AreChangesAgainstTheUnloadedPad) {
  FeatureReader features = reader();
  NibFrames frames;
  for (int n = 0; n < 90; ++n) {
    EXPECT_FALSE(features.touching());
    features.update(frames.next());
  }
  features.update(frames.next());
  EXPECT_FALSE(features.touching());  // tared, and nothing there
  EXPECT_EQ(features.features().normal, 0.0);
  frames.load({1, 7, 3, 2});
  features.update(frames.next());
  EXPECT_TRUE(features.touching());
  EXPECT_EQ(features.features().normal, 9.0 * 13.0);
  EXPECT_EQ(features.features().shear, Eigen::Vector2d(9.0 * 2.0, 9.0 * 5.0));
  EXPECT_NEAR(features.features().curl, 0.0, 1e-15);
}

// Of a channel that is new every ninth sample the first eight are no image yet.
TEST(Features, WaitForTheFirstWholeImage) {
  FrameSource source = nib_source();
  source.channels[0].every = 9;
  FeatureReader features = reader(source);
  NibFrames frames;
  frames.load({-6960, -6960, -6960, -6960});
  for (int n = 0; n < 8; ++n) features.update(frames.next());
  frames.load({0, 0, 0, 0});
  for (int n = 0; n < 91; ++n) features.update(frames.next());
  EXPECT_EQ(features.features().normal, 0.0);
}

// A tone of A counts at 4 Hz: means of 0.25 N A/2 over 0 to 6 Hz and 0.115 N A/2 over 6 to 8 Hz (stft_test), N = 150; what the line
// takes of a cosine that is not even about the window's middle is at most some percent.
TEST(Features, HaveTheBandsOfBothModes) {
  FeatureReader features = reader();
  NibFrames frames;
  frames.vibrate(8.0, 4.0);
  int due = 0;
  for (int n = 0; n < 150; ++n) due += features.update(frames.next()) ? 1 : 0;
  EXPECT_EQ(due, 1);
  EXPECT_NEAR(features.features().fl, 0.25 * 75.0 * 8.0, 0.1 * 150.0);
  EXPECT_NEAR(features.features().fl_fast, 0.115 * 75.0 * 8.0, 0.1 * 69.0);
  EXPECT_NEAR(features.features().fr, 0.5 * features.features().fl, 1e-2);  // frames are floats: 6960 to 5e-4
  EXPECT_NEAR(features.features().fr_fast, 0.5 * features.features().fl_fast, 1e-2);
}

// Gains of 2 and 5 counts/N, taxels 7.6 mm apart. Nine taxels with N + E + S + W = 20: 90 N. The shear of each taxel is 5 counts, 1 N, and
// turns about the centre: 4 at 7.6 mm, 4 at 7.6 sqrt 2 mm, and the centre's own. With the capacitor's law, 1/(1 - x): an electrode of C = 100
// counts whose gap closes by the share x counts 100 x/(1 - x) more, which must be undone: without that 5 counts would be 5.3 and more.
TEST(Features, HandOnForcesAndTheMoment) {
  FrameSource source = nib_source();
  Parameters parameters = defaults_of(feature_specs());
  parameters.set("normal_gain", 2.0);
  parameters.set("shear_gain", 5.0);
  parameters.set("capacitance", 100.0);
  FeatureReader features(parameters, source, "a test");
  std::vector<float> values(40, 6960.0F);
  std::vector<double> told;
  features.update({0.0, values});
  features.hand_on(told);
  ASSERT_EQ(told.size(), handed_on().size());
  for (const double value : told) EXPECT_TRUE(std::isnan(value));
  for (int n = 1; n < 90; ++n) features.update({0.0, values});
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const double x = static_cast<double>(taxel % 3) - 1.0, y = 1.0 - static_cast<double>(taxel / 3),
                 r = std::max(std::hypot(x, y), 1.0);
    const double shear_x = taxel == 4 ? 5.0 : -5.0 * y / r, shear_y = 5.0 * x / r;
    const double closed[] = {5.0 - shear_x / 2, 5.0 + shear_y / 2, 5.0 + shear_x / 2, 5.0 - shear_y / 2};  // 100 x
    for (std::size_t k = 0; k < electrodes; ++k) {
      values[electrodes * taxel + k] += static_cast<float>(closed[k] / (1.0 - closed[k] / 100.0));
    }
  }
  features.update({0.0, values});
  features.hand_on(told);
  EXPECT_TRUE(std::isnan(told[0]));  // no window is full yet
  EXPECT_NEAR(told[5], 90.0, 1e-3);
  EXPECT_NEAR(told[6], 1.0, 1e-3);  // the turn cancels, and the centre's is left
  EXPECT_NEAR(told[7], 7.6e-3 * (4.0 + 4.0 * std::sqrt(2.0)), 1e-5);
}

TEST(Features, RefuseWhatTheyCannotBeMadeOf) {
  FrameSource other = nib_source();
  other.channels[1].name = "force";
  EXPECT_NE(refusal(other).find("reads the channel 'fl' of a nib pad"), std::string::npos) << refusal(other);
  EXPECT_NE(refusal(nib_source(), "window", 0.501).find("no whole number"), std::string::npos);
  EXPECT_NE(refusal(nib_source(), "hop", 1e-3).find("no whole number"), std::string::npos);
  EXPECT_NE(refusal(nib_source(), "window", 0.3).find("wider than the band"), std::string::npos);
  EXPECT_NE(refusal(nib_source(10.0)).find("at least twice"), std::string::npos);
}

}  // namespace
}  // namespace slipbench::nib
