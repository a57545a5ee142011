// Grids and random draws.

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench::sweep_test {
namespace {

const std::string head = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

struct SweepTest : testing::Test {
  [[nodiscard]] TrialPlan plan(const std::string& text, std::size_t draws = 0, std::uint64_t seed = 1) const {
    return {SceneFile::from_text(head + text, "s.yaml"), catalogues_, draws, seed};
  }

  [[nodiscard]] static std::map<std::string, std::string> drawn(const TrialPlan& plan, std::size_t index) {
    const TrialPlan::Trial trial = plan.trial(index);
    return {trial.drawn.begin(), trial.drawn.end()};
  }

  const Catalogues catalogues_ = test_catalogues();
};

// The head has two lines.
TEST_F(SweepTest, AnEntryOfAListIsFoundByItsName) {
  const TrialPlan effects = plan("effects:\n  - stribeck\n  - ageing:\n      rate: 0.1\n");
  EXPECT_EQ(effects.where(0, "effects"), effects.where(0, "effects.absent"));
  EXPECT_EQ(effects.where(0, "effects.stribeck.speed"), "s.yaml:4");
  EXPECT_EQ(effects.where(0, "effects.ageing.rate"), "s.yaml:6");
  EXPECT_EQ(effects.where(0, "effects.1.ageing.rate"), "s.yaml:6");
}

TEST_F(SweepTest, WithoutOneThereIsOneTrialOrAsManyAsAskedFor) {
  EXPECT_EQ(plan("").size(), 1u);
  EXPECT_EQ(plan("", 5).size(), 5u);
  EXPECT_TRUE(plan("", 5).trial(4).drawn.empty());
  EXPECT_THROW(static_cast<void>(plan("").trial(1)), std::out_of_range);
}

TEST_F(SweepTest, TheLastAxisVariesFastest) {
  const TrialPlan grid = plan("sweep: {motion.speed: [1 mm/s, 2 mm/s], surface.material: [ptfe, felt, paper], trials: 2}\n");
  ASSERT_EQ(grid.size(), 12u);
  const char* materials[] = {"ptfe", "felt", "paper"};
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const TrialPlan::Trial trial = grid.trial(i);
    EXPECT_EQ(trial.scene.motion.parameters.number("speed"), i < 6 ? 0.001 : 0.002);
    EXPECT_EQ(trial.scene.material, materials[i / 2 % 3]);
    ASSERT_EQ(trial.drawn.size(), 2u);
    EXPECT_EQ(trial.drawn[0], std::pair(std::string("motion.speed"), std::string(i < 6 ? "0.001" : "0.002")));
    EXPECT_EQ(trial.drawn[1].second, "\"" + std::string(materials[i / 2 % 3]) + "\"");
  }
}

// Trials that differ only in a name are not a sweep: ptfe and rubber would give equal results.
TEST_F(SweepTest, NamesWhoseFiguresTheSceneReplacesAreRefused) {
  const std::string friction = "friction: {static: 0.5, kinetic: 0.4}\n";
  const auto refusal = [&](const std::string& text) -> std::string { return refusal_of([&] { static_cast<void>(plan(text)); }); };
  EXPECT_THAT(refusal(friction + "sweep: {surface.material: [ptfe, felt]}\n"),
              refused_at("s.yaml:4", {"sweep.surface.material", "friction.static", "friction.kinetic", "s.yaml:3"}));
  EXPECT_NE(refusal(friction + "sweep: {surface: [{material: ptfe}, {material: felt}], motion.speed: [1, 2]}\n"), "accepted");
  EXPECT_NE(refusal(friction + "sweep: {surface.material: {draw: choice, values: [ptfe, felt]}}\n"), "accepted");
  EXPECT_THAT(refusal("sweep: {description: [one, two], motion.speed: [1, 2]}\n"),
              refused_at("s.yaml:3", {"description", "sweep"}));
  EXPECT_EQ(refusal("sweep: {scene: [{description: slow, motion: {speed: 1}}, {description: fast, motion: {speed: 2}}]}\n"),
            "accepted");
  // The material's ratio still matters; a scale multiplies it; a single value of another axis does
  // not change it; other keys are combined with it.
  EXPECT_EQ(refusal("friction: {static: 0.3}\nsweep: {surface.material: [acrylic, felt]}\n"), "accepted");
  EXPECT_EQ(refusal("friction: {scale: 0.5}\nsweep: {surface.material: [ptfe, felt]}\n"), "accepted");
  EXPECT_EQ(
      refusal("sweep: {scene: [{friction: {static: 0.5, kinetic: 0.4}}, {duration: 4 s}], surface.material: [ptfe, felt]}\n"),
      "accepted");
  EXPECT_EQ(refusal(friction +
                    "sweep: {scene: [{surface: {material: ptfe}, duration: 1 s}, {surface: {material: felt}, duration: 2 s}]}\n"),
            "accepted");
  EXPECT_EQ(refusal(friction + "sweep: {surface.material: [ptfe]}\n"), "accepted");
}

// A parameter of one detector is null in the trials of another.
TEST_F(SweepTest, DetectorsOfAnAxisBringTheirOwnParameters) {
  const TrialPlan grid = plan(
      "detector: {type: trained}\nsweep: {detector: [{type: ratio, threshold: 0.3}, {type: trained}, {type: none}], motion.speed: [1, 2]}\n");
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid.trial(1).scene.detector->type, "ratio");
  EXPECT_EQ(grid.trial(1).scene.detector->parameters.number("threshold"), 0.3);
  EXPECT_EQ(drawn(grid, 1).at("detector.threshold"), "0.3");
  EXPECT_EQ(grid.trial(3).scene.detector->type, "trained");
  EXPECT_EQ(drawn(grid, 3).at("detector.threshold"), "null");
  EXPECT_FALSE(grid.trial(5).scene.detector.has_value());
}

TEST_F(SweepTest, TheCallersNumberOfDrawsReplacesTheScenes) {
  EXPECT_EQ(plan("sweep: {motion.speed: [1, 2], trials: 3}\n").size(), 6u);
  EXPECT_EQ(plan("sweep: {motion.speed: [1, 2], trials: 3}\n", 5).size(), 10u);
}

TEST_F(SweepTest, TheSeedReplacesTheScenesOwn) {
  EXPECT_EQ(plan("seed: 3\n", 0, 8).trial(0).scene.seed, 8u);
  EXPECT_EQ(parse_scene(SceneFile::from_text(head + "seed: 3\n", "s.yaml"), catalogues_).seed, 3u);
}

TEST_F(SweepTest, AMapOnAnAxisIsMergedIntoTheScene) {
  const TrialPlan grid =
      plan("motion: {speed: 5 mm/s, direction: 1}\nsweep: {motion: [{rotation: 2, pivot: [1 mm, 0]}, {speed: 3 mm/s}]}\n");
  ASSERT_EQ(grid.size(), 2u);
  const Parameters first = grid.trial(0).scene.motion.parameters;
  EXPECT_EQ(first.number("rotation"), 2.0);
  EXPECT_EQ(first.number("speed"), 0.005);
  EXPECT_EQ(first.number("direction"), 1.0);
  EXPECT_EQ(grid.trial(1).scene.motion.parameters.number("speed"), 0.003);
  EXPECT_EQ(grid.trial(1).scene.motion.parameters.number("rotation"), 0.0);
  // Every trial reports every path that some trial sets, in SI.
  const std::map<std::string, std::string> expected_first{
      {"motion.pivot", "[0.001,0]"}, {"motion.rotation", "2"}, {"motion.speed", "0.005"}};
  const std::map<std::string, std::string> expected_second{
      {"motion.pivot", "[0,0]"}, {"motion.rotation", "0"}, {"motion.speed", "0.003"}};
  EXPECT_EQ(drawn(grid, 0), expected_first);
  EXPECT_EQ(drawn(grid, 1), expected_second);
}

// Keys of several sections that belong together form one axis, and fixed keys leave it.
TEST_F(SweepTest, MapsOfTheAxisSceneAreMergedIntoTheSceneItself) {
  const std::string text =
      "friction: {static: 0.4}\nsweep: {scene: [{motion: {speed: 5 mm/s}, friction: {static: 0.6}}, {motion: {speed: 3 mm/s}}], motion.direction: [1, 2]}\n";
  const TrialPlan grid = plan(text);
  ASSERT_EQ(grid.size(), 4u);
  const Scene first = grid.trial(1).scene, second = grid.trial(2).scene;
  EXPECT_EQ(first.motion.parameters.number("speed"), 0.005);
  EXPECT_EQ(first.motion.parameters.number("direction"), 2.0);
  EXPECT_EQ(first.friction.static_coefficient, 0.6);
  EXPECT_EQ(second.motion.parameters.number("speed"), 0.003);
  EXPECT_EQ(second.friction.static_coefficient, 0.4);
  const std::map<std::string, std::string> expected{
      {"friction.static", "0.6"}, {"motion.direction", "2"}, {"motion.speed", "0.005"}};
  EXPECT_EQ(drawn(grid, 1), expected);

  SceneFile file = SceneFile::from_text(head + text, "s.yaml");
  file.apply({"friction.static", "0.5"});
  const TrialPlan fixed(file, catalogues_, 0, 1);
  EXPECT_EQ(fixed.trial(1).scene.friction.static_coefficient, 0.5);
  EXPECT_EQ(fixed.trial(1).scene.motion.parameters.number("speed"), 0.005);
}

TEST_F(SweepTest, ReportsAnyKindOfValueAsJson) {
  const TrialPlan grid = plan(
      "friction: {static: 0.5}\n"
      "sweep:\n"
      "  effects: [[], [ageing, {stribeck: {speed: 2 mm/s}}]]\n"
      "  sensors.pad: [{bias: false, bristles: 3, electronics: typical}]\n"
      "  description: ['say \"x\"']\n"
      "  motion.stop: [inf]\n"
      "  time_step: [auto]\n"
      "  friction.scale: [0.5]\n");
  const std::map<std::string, std::string> expected{{"description", "\"say \\\"x\\\"\""},
                                                    {"effects", R"(["ageing",{"stribeck":{"speed":"2 mm/s"}}])"},
                                                    {"friction.scale", "0.5"},
                                                    {"motion.stop", "\"inf\""},
                                                    {"sensors.pad.bias", "false"},
                                                    {"sensors.pad.bristles", "3"},
                                                    {"sensors.pad.electronics", "\"typical\""},
                                                    {"time_step", "\"auto\""}};
  EXPECT_EQ(drawn(grid, 1), expected);
  EXPECT_EQ(drawn(grid, 0).at("effects"), "[]");
  EXPECT_EQ(grid.trial(1).scene.effects.size(), 2u);
}

TEST_F(SweepTest, ADrawDependsOnItsOwnKeyOnly) {
  const std::string speed = "  motion.speed: {draw: uniform, min: 1 mm/s, max: 9 mm/s}\n";
  const std::string scale = "  friction.scale: {draw: lognormal, median: 1, sd: 0.1}\n";
  const TrialPlan alone = plan("sweep:\n" + speed, 20);
  const TrialPlan after = plan("sweep:\n" + scale + speed, 20);
  const TrialPlan before = plan("sweep:\n" + speed + scale, 20);
  std::set<std::string> values;
  for (std::size_t i = 20; i-- > 0;) {  // in reverse order
    const std::string value = drawn(alone, i).at("motion.speed");
    EXPECT_EQ(drawn(after, i).at("motion.speed"), value);
    EXPECT_EQ(drawn(before, i).at("motion.speed"), value);
    EXPECT_EQ(drawn(alone, i).at("motion.speed"), value);
    values.insert(value);
  }
  EXPECT_EQ(values.size(), 20u);
  EXPECT_NE(drawn(plan("sweep:\n" + speed, 20, 2), 0), drawn(alone, 0)) << "another seed, other draws";
  // Trial i draws the same for any number of trials.
  EXPECT_EQ(drawn(plan("sweep:\n" + speed, 5), 4), drawn(alone, 4));
}

// n draws of mean m and standard deviation s: the sample mean is within 5 s / sqrt(n) of m.
constexpr std::size_t n = 4000;

double mean_of(const TrialPlan& plan, const std::string& parameter, double (*f)(double)) {
  double sum = 0.0;
  for (std::size_t i = 0; i < plan.size(); ++i) sum += f(plan.trial(i).scene.motion.parameters.number(parameter));
  return sum / static_cast<double>(plan.size());
}

double same(double x) { return x; }
double square(double x) { return x * x; }

TEST_F(SweepTest, DrawsHaveTheirDistributions) {
  const double root_n = std::sqrt(static_cast<double>(n));
  const TrialPlan uniform = plan("sweep: {motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}}\n", n);
  const double turn = 2.0 * std::numbers::pi;
  EXPECT_NEAR(mean_of(uniform, "direction", same), turn / 2, 5 * turn / std::sqrt(12.0) / root_n);

  const TrialPlan log_uniform = plan("sweep: {motion.speed: {draw: log_uniform, min: 1 mm/s, max: 100 mm/s}}\n", n);
  const double decades = std::log(100.0);
  const auto logarithm = [](double x) { return std::log(x / 0.01); };  // uniform about 0 between 1 and 100 mm/s
  EXPECT_NEAR(mean_of(log_uniform, "speed", logarithm), 0.0, 5 * decades / std::sqrt(12.0) / root_n);

  const TrialPlan normal = plan("sweep: {motion.rotation: {draw: normal, mean: 2, sd: 0.5 rad/s}}\n", n);
  EXPECT_NEAR(mean_of(normal, "rotation", same), 2.0, 5 * 0.5 / root_n);
  // E((2 + z/2)^2) = 4.25; its variance is 4 m^2 s^2 + 2 s^4 = 4.125.
  EXPECT_NEAR(mean_of(normal, "rotation", square), 4.25, 5 * std::sqrt(4.125) / root_n);

  const TrialPlan lognormal = plan("sweep: {motion.compression: {draw: lognormal, median: 2 mm, sd: 0.1}}\n", n);
  const auto relative_log = [](double x) { return std::log(x / 0.002) / 0.1; };
  EXPECT_NEAR(mean_of(lognormal, "compression", relative_log), 0.0, 5 / root_n);
}

TEST_F(SweepTest, ATruncatedNormalDrawStaysWithinItsBounds) {
  const TrialPlan cut = plan("sweep: {motion.rotation: {draw: normal, mean: 0, sd: 1, min: -1, max: 0.5}}\n", n);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = cut.trial(i).scene.motion.parameters.number("rotation");
    ASSERT_GE(value, -1.0);
    ASSERT_LE(value, 0.5);
    sum += value;
  }
  // Mean of a standard normal cut to [a, b]: (phi(a) - phi(b)) / (Phi(b) - Phi(a)). Its deviation
  // is below that of the uniform distribution over [a, b], because its density is more
  // concentrated.
  const auto phi = [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); };
  const auto cdf = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  const double mean = (phi(-1.0) - phi(0.5)) / (cdf(0.5) - cdf(-1.0));
  EXPECT_NEAR(sum / n, mean, 5 * 1.5 / std::sqrt(12.0 * n));
}

// Half of a normal distribution, z >= 0, has the mean sqrt(2 / pi) and the variance 1 - 2 / pi.
TEST_F(SweepTest, ATruncatedLognormalDrawStaysWithinItsBounds) {
  const TrialPlan cut = plan("sweep: {motion.compression: {draw: lognormal, median: 2 mm, sd: 0.1, min: 2 mm, max: 1 m}}\n", n);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = cut.trial(i).scene.motion.parameters.number("compression");
    ASSERT_GE(value, 0.002);
    sum += std::log(value / 0.002) / 0.1;
  }
  EXPECT_NEAR(sum / n, std::sqrt(2 / std::numbers::pi), 5 * std::sqrt((1 - 2 / std::numbers::pi) / n));
}

TEST_F(SweepTest, AChoiceTakesEveryValueEquallyOften) {
  const TrialPlan choice =
      plan("sweep: {surface: {draw: choice, values: [{material: ptfe}, {material: felt, shape: cylinder}]}}\n", n);
  int felt = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Scene scene = choice.trial(i).scene;
    EXPECT_EQ(scene.material == "felt", scene.surface.name == "cylinder");
    felt += scene.material == "felt" ? 1 : 0;
  }
  EXPECT_NEAR(felt, n / 2.0, 5 * std::sqrt(n / 4.0));  // binomial
}

TEST_F(SweepTest, ADrawThatDoesNotFitTheSceneIsRefusedWhenItIsMade) {
  // Half of the draws are negative speeds; the plan checks the first trial of a cell only.
  const std::string text = "sweep: {motion.speed: {draw: uniform, min: -1 mm/s, max: 1 mm/s}}\n";
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::string refusal = refusal_of([&] {
      const TrialPlan draws = plan(text, 50, seed);
      for (std::size_t i = 0; i < draws.size(); ++i) EXPECT_GE(draws.trial(i).scene.motion.parameters.number("speed"), 0.0);
    });
    EXPECT_THAT(refusal, StartsWith("s.yaml:3 (drawn): motion.speed: '-"));
  }
}

TEST_F(SweepTest, EveryCellOfTheGridIsChecked) {
  EXPECT_THAT(refusal_of([&] { static_cast<void>(plan("sweep: {motion.speed: [1, 2], motion.compression: [1 mm, 0 mm]}\n")); }),
              refused_at("s.yaml:3", {"motion.compression", "0 mm", "> 0 mm"}));
}

}  // namespace
}  // namespace slipbench::sweep_test
