// Windows, splits and figures of the Myrmex networks, of made-up trials.
#include "tools/studies/myrmex_tactile_cnn/myrmex_networks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "sim/simulation/stage_setup.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce::myrmex_networks_test {
namespace {

using train::masked;

MyrmexWindow window(double time, double to_onset, std::uint8_t label, bool drawn = true) {
  MyrmexWindow one;
  one.time = time;
  one.to_onset = to_onset;
  one.label.fill(label);
  one.drawn.fill(drawn);
  return one;
}

// Six trials, two of an object: one slips, with ten stable windows up to 0.1 s before its onset at 1 s and three that slip, and one holds, with
// eight stable windows. Of the stable ones of the first the latest five are late.
std::vector<MyrmexTrial> trials() {
  std::vector<MyrmexTrial> all;
  for (const char* object : {"cylinder", "remote", "glass"}) {
    const bool rotational = std::string(object) == "remote";
    MyrmexTrial slips{object, rotational, true, {}};
    for (int k = 0; k < 10; ++k) slips.windows.push_back(window(0.1 * k, 1.0 - 0.1 * k, 0, k % 2 == 0));
    for (int k = 0; k < 3; ++k) slips.windows.push_back(window(1.0 + 0.1 * k, -0.1 * k, rotational ? 2 : 1));
    all.push_back(slips);
    MyrmexTrial holds{object, rotational, false, {}};
    for (int k = 0; k < 8; ++k) holds.windows.push_back(window(0.1 * k, std::nan(""), 0));
    all.push_back(holds);
  }
  return all;
}

std::uint8_t label_at(const std::vector<MyrmexTrial>& all, const WindowPlace& place) {
  return all[place.trial].windows[place.window].label[0];
}

TEST(KindAt, IsStableThenTheKindThenNothing) {
  const SlipSpan falls{2.0, 3.0}, holds{{}, 3.0};
  EXPECT_EQ(kind_at(1.999, falls, 2), 0);
  EXPECT_EQ(kind_at(2.0, falls, 2), 2);
  EXPECT_EQ(kind_at(3.0, falls, 1), 1);
  EXPECT_EQ(kind_at(3.001, falls, 1), masked);
  EXPECT_EQ(kind_at(2.5, holds, 1), 0);
}

TEST(Windows, LateOnesAreThoseOfTheLastHalfSecond) {
  EXPECT_TRUE(window(0.0, 0.5, 0).late());
  EXPECT_FALSE(window(0.0, 0.501, 0).late());
  EXPECT_FALSE(window(0.0, 0.0, 1).late()) << "the onset itself slips";
  EXPECT_FALSE(window(0.0, std::nan(""), 0).late()) << "a trial that holds";
}

// Two objects translate, one turns: 6 and 3 windows, so three of each.
TEST(BalancedWindows, AreAsManyOfEachClass) {
  const std::vector<MyrmexTrial> all = trials();
  const std::vector<WindowPlace> places = balanced_windows(all, SlipWord::truth, false, 1);
  std::map<int, int> count;
  for (const WindowPlace& place : places) {
    ++count[label_at(all, place)];
    EXPECT_TRUE(all[place.trial].windows[place.window].drawn[0]);
  }
  EXPECT_EQ(count, (std::map<int, int>{{0, 3}, {1, 3}, {2, 3}}));
}

TEST(BalancedWindows, AreLateWhereTheyAreAskedToBe) {
  const std::vector<MyrmexTrial> all = trials();
  std::size_t stable = 0;
  for (const WindowPlace& place : balanced_windows(all, SlipWord::truth, true, 1)) {
    if (label_at(all, place) != 0) continue;
    ++stable;
    EXPECT_TRUE(all[place.trial].windows[place.window].late());
  }
  EXPECT_EQ(stable, 3U);
}

TEST(BalancedWindows, LeaveOutTurnedCopies) {
  std::vector<MyrmexTrial> all = trials();
  for (MyrmexWindow& turned : all[2].windows) turned.turn = 3;  // the only trial that turns, which is then of no class
  EXPECT_THAT(balanced_windows(all, SlipWord::truth, false, 1), SizeIs(0));
}

// By window each class is dealt out in turn; by trial and by object no trial is on both sides.
TEST(WindowFolds, LeakByWindowAlone) {
  const std::vector<MyrmexTrial> all = trials();
  const std::vector<WindowPlace> places = balanced_windows(all, SlipWord::truth, false, 1);
  const std::vector<std::size_t> by_window = window_folds(all, places, SlipWord::truth, MyrmexSplit::window, 3, 1);
  std::map<std::pair<int, std::size_t>, int> dealt;  // class and fold
  for (std::size_t k = 0; k < places.size(); ++k) ++dealt[{label_at(all, places[k]), by_window[k]}];
  EXPECT_THAT(dealt, SizeIs(9));
  for (const auto& [which, count] : dealt) EXPECT_EQ(count, 1);
  for (const MyrmexSplit split : {MyrmexSplit::trial, MyrmexSplit::object}) {
    const std::vector<std::size_t> fold_of = window_folds(all, places, SlipWord::truth, split, 2, 1);
    std::map<std::size_t, std::set<std::size_t>> of_trial;
    for (std::size_t k = 0; k < places.size(); ++k) of_trial[places[k].trial].insert(fold_of[k]);
    for (const auto& [trial, folds] : of_trial) EXPECT_THAT(folds, SizeIs(1)) << trial;
  }
  const std::vector<std::size_t> by_object = window_folds(all, places, SlipWord::truth, MyrmexSplit::object, 0, 1);
  for (std::size_t k = 0; k < places.size(); ++k) EXPECT_EQ(by_object[k], places[k].trial / 2) << "two trials of an object";
}

// Taxel i has 100 i + k in bin k: its static value is 100 i, the mean over 144 of them 100 x 143/2.
TEST(Told, IsWhatTheInputSays) {
  MyrmexTrial trial{"remote", true, true, {}};
  MyrmexWindow one = window(1.25, 0.5, 0);
  for (int i = 0; i < 144; ++i) {
    for (int k = 0; k < 32; ++k) one.spectra.push_back(static_cast<float>(100 * i + k));
  }
  for (const MyrmexInput input : {MyrmexInput::spectra, MyrmexInput::high_pass, MyrmexInput::static_image, MyrmexInput::load,
                                  MyrmexInput::clock, MyrmexInput::placement, MyrmexInput::clock_placement})
    EXPECT_EQ(told(trial, one, input).size(), inputs_of(input)) << static_cast<int>(input);
  EXPECT_EQ(told(trial, one, MyrmexInput::spectra), one.spectra);
  const std::vector<float> passed = told(trial, one, MyrmexInput::high_pass);
  EXPECT_EQ(passed[0], 4.0F) << "bin 4 of 15.625 Hz is 62.5 Hz";
  EXPECT_EQ(passed[28], 104.0F);
  EXPECT_EQ(told(trial, one, MyrmexInput::static_image)[2], 200.0F);
  EXPECT_THAT(told(trial, one, MyrmexInput::load), ElementsAre(7150.0F));
  EXPECT_THAT(told(trial, one, MyrmexInput::clock_placement), ElementsAre(1.25F, 1.0F, 0.0F, 1.0F, 0.0F));
}

// conv 3x3 of 32 channels on 32 bins has (9 x 32 + 1) 32 parameters, on 28 bins (9 x 28 + 1) 32: 1,152 fewer.
TEST(Shapes, AreTheRecipesWithAsManyBinsAsAreTold) {
  const auto parameters = [](MyrmexInput input) {
    return train::parameter_count(shape_of(network_row(3, input, SlipWord::truth)));
  };
  EXPECT_EQ(parameters(MyrmexInput::spectra) - parameters(MyrmexInput::high_pass), 9U * 4U * 32U);
  MyrmexRow clock;
  clock.input = MyrmexInput::clock;
  EXPECT_EQ(train::parameter_count(shape_of(clock)), 2U * 32U + 33U * 3U);
}

// 3 of 4 stable, 1 of 2 translations: mean 5/8; no rotation is judged.
TEST(KindCounts, AccuracyIsTheMeanOfTheClassesThatOccur) {
  KindCounts counts;
  for (const auto called : std::initializer_list<std::uint8_t>{0, 0, 0, 2}) counts.add(0, called);
  for (const auto called : std::initializer_list<std::uint8_t>{1, 0}) counts.add(1, called);
  EXPECT_EQ(counts.accuracy(), 0.625);
  EXPECT_EQ(counts.share(0, 2), 0.25);
  EXPECT_TRUE(std::isnan(counts.share(2, 0)));
  EXPECT_TRUE(std::isnan(KindCounts{}.accuracy()));
  EXPECT_TRUE(std::isnan(WrongCount{}.share()));
}

TEST(Sizes, OneTrialOfACellIsRefused) {
  if (!train::networks_available()) GTEST_SKIP() << "built without libtorch";
  ReproduceOptions options;
  options.trials = 1;
  EXPECT_THAT(refusal_of([&] { myrmex_size(options); }), mentions({"--trials 1", "2"}));
  options.trials = 2;
  options.full = true;
  EXPECT_EQ(myrmex_size(options).turned, 11U) << "with the image as recorded the paper's 12 angles";
}

// Three classes at -1, 0 and 1 of one value.
TEST(CalledKinds, AreThoseThatCanBeTold) {
  if (!train::networks_available()) GTEST_SKIP() << "built without libtorch";
  train::FrameSequence learnt, judged;
  for (int k = 0; k < 60; ++k) {
    learnt.features.push_back(static_cast<float>(k % 3 - 1));
    learnt.label.push_back(static_cast<std::uint8_t>(k % 3));
  }
  judged.features = {1.0F, -1.0F, 0.0F};
  judged.label = {0, 0, 0};  // asked for, and not looked at
  train::TrainingOptions training;
  training.steps = 300;
  training.clip = 1;
  training.optimiser = train::Optimiser::adam;
  training.learning_rate = 1e-2;
  MyrmexRow row;
  row.input = MyrmexInput::clock;
  EXPECT_THAT(called_kinds(shape_of(row), learnt, judged, training), ElementsAre(2, 0, 1));
}

// A clock tells slip from hold in these trials: all before 1 s is stable. Of object left out it judges all three, of the trials all six.
TEST(MyrmexValidations, JudgeEveryWindowOfTheFoldsThatAreAskedFor) {
  if (!train::networks_available()) GTEST_SKIP() << "built without libtorch";
  const std::vector<MyrmexTrial> all = trials();
  ReproduceOptions options;
  options.jobs = 1;
  MyrmexSize size;
  size.steps = 100;
  MyrmexRow row;
  row.text = "a clock";
  row.input = MyrmexInput::clock;
  MyrmexValidations validations(options, size, all);
  const std::size_t one = validations.queue(row, MyrmexSplit::window, 3, 1),
                    none = validations.queue(row, MyrmexSplit::object, 0, 0),
                    every = validations.queue(row, MyrmexSplit::window, 3, 3);
  validations.run();
  const auto judged = [&](std::size_t validation) {
    std::uint64_t sum = 0;
    for (const auto& row_of : validations.figures(validation).all().windows) {
      for (const std::uint64_t count : row_of) sum += count;
    }
    return sum;
  };
  EXPECT_EQ(judged(one), 3U);
  EXPECT_EQ(judged(none), 0U);
  EXPECT_EQ(judged(every), 9U);
  EXPECT_EQ(validations.figures(every).late.all, 0U) << "the windows before the onset are judged where whole trials judge";
}

// The third sensor's rule and the true onset, of made-up recordings.

// 500 Hz for 4 s.
std::vector<double> times() {
  std::vector<double> time;
  for (int k = 0; k < 2000; ++k) time.push_back(k / 500.0);
  return time;
}

// A sum of 100 that falls from 3 s on by 50 a second.
std::vector<double> falling(const std::vector<double>& time) {
  std::vector<double> sums;
  for (const double t : time) sums.push_back(t < 3.0 ? 100.0 : 100.0 - 50.0 * (t - 3.0));
  return sums;
}

TEST(DecreaseOnset, IsWhereTheSumLeavesItsLevelForGood) {
  const std::vector<double> t = times();
  // At once without a threshold: the first sample below 100 is at 3.002 s. By 10 it lies below after 0.2 s.
  EXPECT_NEAR(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 4.0).value(), 3.002, 1e-9);
  EXPECT_NEAR(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 4.0, 9.99).value(), 3.2, 1e-9);
  EXPECT_FALSE(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 2.9).has_value()) << "not before the end";
  std::vector<double> dips = falling(t);
  dips[1200] = 0.0;
  EXPECT_NEAR(decrease_onset(t, dips, {0.0, 0.0}, 1.0, 2.0, 4.0).value(), 3.002, 1e-9) << "a dip is no onset";
}

TEST(DecreaseOnset, ThresholdCountsTheNoiseOfTheRest) {
  // +1 and -1 by turns: sd 1, by n - 1 of 500 samples sqrt(500/499). Three of them below 100 - 50 (t - 3) +- 1 for good: on the upper samples, 4.003
  // below the line, so from 3.0801 s on; an even sample is an upper one, 3.082 s (k = 1541) a lower one before the next upper.
  const std::vector<double> t = times();
  std::vector<double> sum = falling(t);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += k % 2 == 0 ? 1.0 : -1.0;
  EXPECT_NEAR(decrease_onset(t, sum, {0.0, 3.0}, 1.0, 2.0, 4.0).value(), 3.082, 1e-9);
  // A mean over two samples (3 ms hold two) is without noise, and that of a ramp is that of its middle: 1 ms late.
  EXPECT_NEAR(decrease_onset(t, sum, {0.003, 3.0}, 1.0, 2.0, 4.0, 10.0).value(), 3.202, 1e-9);
}

// A pad of two taxels that carry 3 N and 1 N.
SensorRecord pad(const std::vector<std::array<UnitState, 2>>& states) {
  SensorRecord sensor;
  sensor.type = "myrmex";
  sensor.labels.k_normal = {1.0, 1.0};
  SensorColumn taxels{"taxels", "counts", {1, 2}, {}, {}};
  for (std::size_t k = 0; k < states.size(); ++k) {
    sensor.time.push_back(static_cast<double>(k));
    const bool touches = states[k][0] != UnitState::detached;
    for (std::size_t u = 0; u < 2; ++u) {
      sensor.labels.unit_state.push_back(static_cast<std::uint8_t>(states[k][u]));
      sensor.labels.force.insert(sensor.labels.force.end(), {0.0F, 0.0F, !touches ? 0.0F : u == 0 ? 3.0F : 1.0F});
      taxels.values.push_back(touches ? 3000.0F : 4095.0F);
    }
    sensor.labels.state.push_back(static_cast<std::uint8_t>(touches ? PadState::non_slip : PadState::no_contact));
  }
  sensor.channels.push_back(taxels);
  return sensor;
}

constexpr UnitState stick = UnitState::stick, slip = UnitState::slip, apart = UnitState::detached;

TEST(TrueSlip, BeginsWhereHalfOfTheLoadSlipsForGoodOnBothPads) {
  const std::vector<std::array<UnitState, 2>> one{{stick, slip}, {slip, stick}, {stick, slip}, {slip, stick},
                                                  {slip, slip},  {slip, slip},  {apart, apart}};
  const std::vector<std::array<UnitState, 2>> other{{stick, stick}, {slip, slip}, {slip, slip}, {stick, slip},
                                                    {slip, stick},  {slip, slip}, {slip, slip}};
  // Both carry half or more on what slips at 1 s, and from 4 s on; contact is lost at 6 s.
  const TrueSlip found = true_slip(pad(one), pad(other), 0.0);
  EXPECT_EQ(found.onset.value(), 4.0);
  EXPECT_EQ(found.end, 5.0);
  EXPECT_FALSE(true_slip(pad({{stick, stick}}), pad({{slip, slip}}), 0.0).onset.has_value());
  EXPECT_EQ(slipping_share(pad(one))[0], 0.25);
  EXPECT_EQ(slipping_share(pad(one))[6], 0.0);
  // The other pad touches to the end, with 1,095 counts missing of each of its two taxels.
  EXPECT_EQ(contact_end(pad(one), pad(other), {false, 0.0, 205.0}), 6.0);
  EXPECT_EQ(contact_end(pad(one), pad(one), {false, 0.0, 205.0}), 5.0);
  EXPECT_EQ(contact_end(pad(one), pad(other), {false, 0.0, 1100.0}), 0.0) << "no taxel misses so much";
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 0.0, 1100.0}), 5.0) << "but both together";
  // A mean of two samples: at 6 s of 2,190 and 0.
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 2.0, 1090.0}), 6.0);
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 2.0, 1100.0}), 5.0);
  EXPECT_EQ(sum_of_contacts(pad(one))[0], 2.0 * 1095.0);
}

TEST(SideOfMass, IsWhereTheBodyIsHeldAndHowItsMassLies) {
  const auto shape = std::ranges::find(body_catalogue(), "cylinder", &Entry::name);
  BodyScene body{.name = "object", .shape = {"cylinder", defaults_of(shape->parameters)}};
  body.shape.parameters.set("position", std::vector<double>{0.0, 15e-3, 0.0});
  body.shape.parameters.set("rotation", std::vector<double>{-0.5 * std::numbers::pi, 0.0, 0.0});
  body.shape.parameters.set("centre_of_mass", std::vector<double>{0.0, 0.0, 10e-3});
  EXPECT_NEAR(side_of_mass(body), 25e-3, 1e-15) << "Z of a cylinder turned by -90 degrees about X is Y of the world";
}

}  // namespace
}  // namespace slipbench::reproduce::myrmex_networks_test
