// Frames of signals with known features.

#include <cmath>
#include <cstdlib>
#include <new>
#include <numbers>
#include <vector>

#include "detectors/network/frames.h"
#include "tests/expect.h"

namespace {

thread_local bool counting = false;
thread_local std::size_t allocations = 0;

}  // namespace

// Not inlined, because GCC would otherwise see memory of `new` freed by free().
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (counting) ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace slipbench::network {
namespace {

constexpr double rate = 1000.0;  // Hz

// A sensor of two channels: "force" {2, 3} and "temperature" {1}.
std::vector<Channel> channels() {
  return {{.name = "force", .unit = "N", .shape = {2, 3}, .channel_names = {}},
          {.name = "temperature", .unit = "K", .shape = {1}, .channel_names = {}}};
}

Input input_of(std::vector<ChannelPick> picks) {
  Input input;
  input.sensor = "papillarray";
  input.rate = rate;
  input.channels = std::move(picks);
  return input;
}

// The transform of windows of 10 samples, in the bins from `low` to `high` [Hz].
Input spectrum_of(std::vector<ChannelPick> picks, double low, double high, Transform transform = Transform::amplitude) {
  Input input = input_of(std::move(picks));
  input.window = 10;
  input.transform = transform;
  input.low = low;
  input.high = high;
  return input;
}

Frames frames_of(const Input& input) { return Frames(input, "papillarray", rate, channels()); }

// A sample whose value i is first + i.
std::vector<float> sample(float first) {
  std::vector<float> values;
  for (int i = 0; i < 7; ++i) values.push_back(first + static_cast<float>(i));
  return values;
}

// A sample whose first value is x, the others 0.
std::vector<float> only(double x) { return {static_cast<float>(x), 0, 0, 0, 0, 0, 0}; }

std::vector<float> latest(const Frames& frames) { return {frames.latest().begin(), frames.latest().end()}; }

std::string refusal(const Input& input, const std::string& type = "papillarray", double hertz = rate) {
  return refusal_of([&] { Frames(input, type, hertz, channels()); });
}

TEST(Frames, PickValuesInTheOrderOfThePicks) {
  Frames frames = frames_of(input_of({{"temperature", {}}, {"force", {4, 1}}}));
  EXPECT_EQ(frames.size(), 3u);
  EXPECT_THAT(latest(frames), ElementsAre(0.0F, 0.0F, 0.0F));
  EXPECT_TRUE(frames.push(sample(10.0F)));
  EXPECT_THAT(latest(frames), ElementsAre(16.0F, 14.0F, 11.0F));
}

TEST(Frames, AreCompleteAfterTheWindowAndThenEveryStride) {
  Input input = input_of({{"force", {0}}});
  input.window = 4;
  input.stride = 3;
  Frames frames = frames_of(input);
  std::vector<int> complete;
  for (int n = 1; n <= 11; ++n) {
    if (frames.push(only(n))) complete.push_back(n);
  }
  EXPECT_THAT(complete, ElementsAre(4, 7, 10));
  EXPECT_THAT(latest(frames), ElementsAre(7.0F, 8.0F, 9.0F, 10.0F));
}

TEST(Frames, AStrideBeyondTheWindowLeavesSamplesOut) {
  Input input = input_of({{"force", {0}}});
  input.window = 2;
  input.stride = 5;
  Frames frames = frames_of(input);
  for (int n = 1; n <= 7; ++n) frames.push(only(n));
  EXPECT_THAT(latest(frames), ElementsAre(6.0F, 7.0F));
}

TEST(Frames, HoldTheSamplesOfAWindowOneAfterTheOther) {
  Input input = input_of({{"force", {0, 1}}});
  input.window = 2;
  Frames frames = frames_of(input);
  EXPECT_FALSE(frames.push(sample(0.0F)));
  EXPECT_TRUE(frames.push(sample(10.0F)));
  EXPECT_THAT(latest(frames), ElementsAre(0.0F, 1.0F, 10.0F, 11.0F));
}

TEST(Frames, TheMedianIsOfThoseSamplesThatThereAre) {
  Input input = input_of({{"force", {0}}});
  input.median = 3;
  Frames frames = frames_of(input);
  std::vector<float> medians;
  for (const double x : {5.0, 1.0, 9.0, 2.0, 2.0}) {
    ASSERT_TRUE(frames.push(only(x)));
    medians.push_back(frames.latest()[0]);
  }
  // Medians of 5; 5 1 (the mean of the two); 5 1 9; 1 9 2; 9 2 2.
  EXPECT_THAT(medians, ElementsAre(5.0F, 3.0F, 5.0F, 2.0F, 2.0F));
}

TEST(Frames, AMedianOutlivesASampleThatIsNoNumber) {
  Input input = input_of({{"force", {0}}});
  input.median = 3;
  Frames frames = frames_of(input);
  for (const double x : {1.0, std::nan(""), 2.0, 3.0, 4.0}) frames.push(only(x));
  EXPECT_EQ(frames.latest()[0], 3.0F);  // of 2 3 4
}

TEST(Frames, CentreTakesTheWindowsMeanOff) {
  Input input = input_of({{"force", {0, 1}}});
  input.window = 3;
  input.centre = true;
  Frames frames = frames_of(input);
  for (const float x : {100.0F, 1.0F, 2.0F, 6.0F}) frames.push(sample(x));
  // 1 2 6 minus 3; the second value, 1 more than the first, has the same deviations.
  EXPECT_THAT(latest(frames), ElementsAre(-2.0F, -2.0F, -1.0F, -1.0F, 3.0F, 3.0F));
}

TEST(Frames, OffsetAndScaleAreOfEachFeature) {
  Input input = input_of({{"force", {0, 1}}});
  input.offset = {1.0, 2.0};
  input.scale = {10.0};
  Frames frames = frames_of(input);
  frames.push(sample(4.0F));
  EXPECT_THAT(latest(frames), ElementsAre(30.0F, 30.0F));  // (4 - 1) 10, (5 - 2) 10
}

TEST(Frames, APixelIsTheMeanOfItsValues) {
  Input input = input_of({{"force", {0, 1, 2}}});
  input.window = 2;
  input.pixels = {{0, 2}, {}, {1}, {0, 1, 2}};
  Frames frames = frames_of(input);
  EXPECT_EQ(frames.size(), 8u);
  frames.push(sample(0.0F));
  frames.push(std::vector<float>{3.0F, 6.0F, 12.0F, 0, 0, 0, 0});
  EXPECT_THAT(latest(frames), ElementsAre(1.0F, 0.0F, 1.0F, 1.0F, 7.5F, 0.0F, 6.0F, 7.0F));
}

// A sine of 3 in bin 2 of 10 samples at 1 kHz (100 Hz bins), on top of 40.
double sine(int n) { return 40.0 + 3.0 * std::sin(2.0 * std::numbers::pi * 2.0 * n / 10.0); }

TEST(Frames, AmplitudeIsTheMagnitudeOfTheTransform) {
  Input input = spectrum_of({{"force", {0}}}, 0.0, 300.0);
  Frames frames = frames_of(input);
  for (int n = 0; n < 17; ++n) frames.push(only(sine(n)));  // a window that does not begin with the sine works as well
  // |X_0| = N 40, |X_2| = N 3/2.
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_NEAR(frames.latest()[0], 400.0, 1e-4);
  EXPECT_NEAR(frames.latest()[1], 0.0, 1e-4);
  EXPECT_NEAR(frames.latest()[2], 15.0, 1e-4);
  EXPECT_NEAR(frames.latest()[3], 0.0, 1e-4);
}

TEST(Frames, HannHalvesALineAndGivesAQuarterToEachNeighbour) {
  Input input = spectrum_of({{"force", {0}}}, 100.0, 300.0);
  input.centre = true;  // removes 40, which would leak into bin 1
  input.hann = true;
  Frames frames = frames_of(input);
  for (int n = 0; n < 10; ++n) frames.push(only(sine(n)));
  EXPECT_NEAR(frames.latest()[0], 3.75, 1e-4);
  EXPECT_NEAR(frames.latest()[1], 7.5, 1e-4);
  EXPECT_NEAR(frames.latest()[2], 3.75, 1e-4);
}

TEST(Frames, LogPsdOfASineIsItsPowerOverTheBin) {
  Input input = spectrum_of({{"force", {1, 0}}}, 100.0, 300.0, Transform::log_psd);
  input.floor = 1e-3;
  Frames frames = frames_of(input);
  for (int n = 0; n < 10; ++n) frames.push(only(sine(n)));
  // 3^2/2 over 100 Hz is 0.045 per Hz in bin 2 of the second value; the first is 0.
  const double nothing = std::log10(1e-3);
  ASSERT_EQ(frames.size(), 6u);
  for (const std::size_t bin : {0u, 1u, 2u, 3u, 5u}) EXPECT_NEAR(frames.latest()[bin], nothing, 1e-6);
  EXPECT_NEAR(frames.latest()[4], std::log10(0.045 + 1e-3), 1e-6);
}

Input moving(Transform transform, std::vector<std::size_t> spans, double floor, std::vector<ChannelPick> channels) {
  Input input = input_of(std::move(channels));
  input.window = 2;
  input.transform = transform;
  input.spans = std::move(spans);
  input.floor = floor;
  return input;
}

// Values 3 k + 1 and 5 at sample k. The variance of 0 to n - 1 is (n^2 - 1)/12, and the
// least-squares slope of a line is its own: spreads 3 sqrt((n^2 - 1)/12) and 0, drifts 3 n and 0.
// The first frame has two samples, fewer than either span; the third has four.
TEST(Frames, SpreadsAreOfTheLatestSamplesThereAreWhateverTheLevel) {
  const Input input = moving(Transform::spreads, {3, 4}, 0.5, {{"force", {0, 1}}});
  Frames frames = frames_of(input);
  const auto push = [&](int k) { return frames.push(std::vector<float>{3.0F * static_cast<float>(k) + 1.0F, 5, 0, 0, 0, 0, 0}); };
  const auto expected = [](double first, double second) {
    const auto spread = [](double n) { return static_cast<float>(std::log(3.0 * std::sqrt((n * n - 1.0) / 12.0) + 0.5)); };
    const auto still = static_cast<float>(std::log(0.5));
    return std::vector<float>{
        still, spread(first), still, spread(second), spread(second), still, static_cast<float>(std::asinh(3.0 * second / 0.5)),
        0.0F};
  };
  EXPECT_FALSE(push(0));
  ASSERT_TRUE(push(1));
  EXPECT_THAT(frames.latest(), ::testing::Pointwise(::testing::FloatNear(1e-6F), expected(2.0, 2.0)));
  push(2);
  for (int k = 3; k < 9; ++k) {
    ASSERT_TRUE(push(k));
    EXPECT_THAT(frames.latest(), ::testing::Pointwise(::testing::FloatNear(1e-6F), expected(3.0, 4.0)));
  }
}

// Values 3 - 2 k and 5 at sample k: the mean of the latest two is 3 - 2 (k - 1/2), and over n
// samples they change by -2 n and 0. The first frame has two samples, fewer than the longer span.
TEST(Frames, LevelsAreMeansAndChangesWithTheirSigns) {
  Frames frames = frames_of(moving(Transform::levels, {2, 5}, 0.5, {{"force", {0, 1}}}));
  const auto squash = [](double x) { return static_cast<float>(std::asinh(x / 0.5)); };
  for (int k = 0; k < 10; ++k) {
    const bool whole = frames.push(std::vector<float>{3.0F - 2.0F * static_cast<float>(k), 5, 0, 0, 0, 0, 0});
    ASSERT_EQ(whole, k > 0);
    if (!whole) continue;
    const std::vector<float> expected{squash(3.0 - 2.0 * (k - 0.5)),     squash(5.0), squash(-4.0), 0.0F,
                                      squash(-2.0 * std::min(k + 1, 5)), 0.0F};
    EXPECT_THAT(frames.latest(), ::testing::Pointwise(::testing::FloatNear(1e-6F), expected));
  }
}

// Unit 0 is pulled by 0.3 k along (3, 4)/5 while z falls by 0.1 per sample: over the latest two of
// 9 samples the mean shear is 0.3 x 8.5 and the mean z is 2 - 0.85. Over n samples the pull changes
// by 0.3 n, all of it along the shear, and z by -0.1 n. Unit 1 is constant at (0, 0, 1).
TEST(Frames, UnitsAreLevelsAndRatesOfEachUnitsForce) {
  Input input = moving(Transform::units, {2, 5}, 0.01, {{"force", {}}});
  Frames frames = frames_of(input);
  for (int k = 0; k < 10; ++k) {
    const auto n = static_cast<float>(k);
    frames.push(std::vector<float>{0.18F * n, 0.24F * n, 2.0F - 0.1F * n, 0, 0, 1, 0});
  }
  const auto squash = [](double x) { return static_cast<float>(std::asinh(x / 0.01)); };
  const std::vector<float> expected{squash(1.15), 2.55F / 1.16F, squash(0.6), squash(0.6), squash(-0.2), squash(1.5),
                                    squash(1.5),  squash(-0.5),  squash(1.0), 0.0F,        0.0F,         0.0F,
                                    0.0F,         0.0F,          0.0F,        0.0F};
  EXPECT_THAT(frames.latest(), ::testing::Pointwise(::testing::FloatNear(1e-4F), expected));
  input.channels = {{"force", {0, 1}}};
  EXPECT_THAT(refusal_of([&] { frames_of(input); }), mentions({"units", "2 values"}));
}

// Without a unit in the description a force is in N and a displacement in m, as every simulated
// sensor has them, and a channel of a simulated sensor has the unit of that sensor. Other channels
// have any unit unless the description states one.
TEST(Frames, RefuseAChannelInAnotherUnit) {
  const auto read = [](const std::string& channel, const std::string& trained, const std::string& found) {
    Input input = input_of({{channel, {}, trained}});
    const std::vector<Channel> channels{{channel, found, {1, 3}, {}}};
    Frames(input, input.sensor, input.rate, channels);
  };
  EXPECT_NO_THROW(read("force", "", "N"));
  EXPECT_NO_THROW(read("force", "mN", "mN"));
  EXPECT_NO_THROW(read("signal", "", "counts"));
  EXPECT_THAT(refusal_of([&] { read("force", "", "mN"); }), mentions({"'force'", "'N'", "'mN'"}));
  EXPECT_THAT(refusal_of([&] { read("displacement", "", "mm"); }), mentions({"'displacement'", "'m'", "'mm'"}));
  EXPECT_THAT(refusal_of([&] { read("signal", "counts", "V"); }), mentions({"'signal'", "'counts'", "'V'"}));
  const auto read_usual = [](const std::string& usual, const std::string& found) {
    const Input input = input_of({{"signal", {}}});
    std::vector<Channel> channels{{"signal", found, {1, 3}, {}}};
    channels[0].usual_unit = usual;
    Frames(input, input.sensor, input.rate, channels);
  };
  EXPECT_NO_THROW(read_usual("uT", "uT"));
  EXPECT_THAT(refusal_of([&] { read_usual("uT", "counts"); }),
              mentions({"'signal'", "'uT'", "'counts'", "what one count is, for example scale: 0.01 uT"}));
  EXPECT_THAT(refusal_of([&] { read_usual("counts", "V"); }), mentions({"'counts'", "'V'"}));
  EXPECT_NO_THROW(read_usual("", "V")) << "the scene of taxels chooses their unit";
}

TEST(Frames, APixelOfSpectraIsTheirMeanBinByBin) {
  Input input = spectrum_of({{"force", {0, 1}}}, 200.0, 300.0);
  input.pixels = {{0, 1}, {1}};
  Frames frames = frames_of(input);
  for (int n = 0; n < 10; ++n) frames.push(only(sine(n)));
  EXPECT_NEAR(frames.latest()[0], 7.5, 1e-4);  // half of 15
  EXPECT_NEAR(frames.latest()[1], 0.0, 1e-4);
  EXPECT_NEAR(frames.latest()[2], 0.0, 1e-4);
  EXPECT_NEAR(frames.latest()[3], 0.0, 1e-4);
}

TEST(Frames, ResetForgetsEverySample) {
  Input input = input_of({{"force", {0}}});
  input.median = 3;
  input.window = 2;
  input.centre = true;
  Frames frames = frames_of(input);
  for (const double x : {7.0, 8.0, 3.0}) frames.push(only(x));
  frames.reset();
  EXPECT_THAT(latest(frames), ElementsAre(0.0F, 0.0F));
  EXPECT_FALSE(frames.push(only(5.0)));
  EXPECT_TRUE(frames.push(only(1.0)));
  EXPECT_THAT(latest(frames), ElementsAre(1.0F, -1.0F));  // medians 5 and 3
}

TEST(Frames, ASampleCostsNoMemory) {
  Input input = input_of({{"force", {}}});
  input.median = 5;
  input.window = 8;
  input.centre = true;
  input.transform = Transform::log_psd;
  input.low = 125.0;
  input.high = 500.0;
  input.floor = 1e-3;
  input.pixels = {{0, 1}, {2}};
  Frames frames = frames_of(input);
  const std::vector<float> values = sample(1.0F);
  counting = true;
  for (int n = 0; n < 40; ++n) frames.push(values);
  frames.reset();
  counting = false;
  EXPECT_EQ(allocations, 0u);
}

// 1004 us between samples: a recorder's clock.
TEST(Frames, TakeARateWithinOnePerCent) {
  for (const double hertz : {990.0, 1e6 / 1004.0, 999.001, 1000.0, 1010.0})
    EXPECT_EQ(refusal(input_of({{"force", {0}}}), "papillarray", hertz), "accepted") << hertz;
}

TEST(Frames, SayWhatDoesNotFitTheSensor) {
  const Input good = input_of({{"force", {0}}});
  EXPECT_THAT(refusal(good, "biotac"), mentions({"papillarray", "biotac"}));
  EXPECT_THAT(refusal(good, "papillarray", 500.0), mentions({"1 kHz", "500 Hz", "1 %"}));
  EXPECT_THAT(refusal(good, "papillarray", 989.0), mentions({"1 kHz", "989 Hz"}));
  EXPECT_THAT(refusal(good, "papillarray", 1011.0), mentions({"1 kHz", "1011 Hz"}));
  EXPECT_THAT(refusal(input_of({{"forces", {}}})), mentions({"forces", "force", "force_ratio reads forces", "deviation"}));
  // A missing channel is reported before the rate, which resampling can change.
  EXPECT_THAT(refusal(input_of({{"displacement", {}}}), "papillarray", 100.0), mentions({"'displacement'", "force"}));
  EXPECT_THAT(refusal(input_of({{"force", {6}}})), mentions({"force", "6", "0", "5"}));
  Input input = good;
  input.offset = {1.0, 2.0};
  EXPECT_THAT(refusal(input), mentions({"offset", "2", "1"}));
  input = good;
  input.pixels = {{1}};
  EXPECT_THAT(refusal(input), mentions({"pixel", "1", "0"}));
  input = good;
  input.transform = Transform::amplitude;
  input.low = 1.0;
  input.high = 2.0;
  EXPECT_THAT(refusal(input), mentions({"frame", "empty"}));
}

}  // namespace
}  // namespace slipbench::network
