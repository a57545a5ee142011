// The patch: its contact, its charge amplifier against closed forms, its electronics, and the
// paper's label.
#include "sensors/piezo_skin/piezo_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "sensors/electronics/band_pass.h"
#include "sim/api/sensor.h"
#include "tests/expect.h"

namespace slipbench::piezo_skin_test {
namespace {

constexpr double pi = std::numbers::pi, inf = std::numeric_limits<double>::infinity();

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

std::unique_ptr<Sensor> skin(const Changes& changes = {}, bool typical = false, std::uint64_t trial = 0) {
  Parameters parameters = defaults_of(piezo_skin_sensor().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  std::vector<Named> parts;
  for (const Entry& entry : piezo_skin_sensor().electronics) {
    if (typical) parts.push_back({entry.name, defaults_of(entry.parameters)});
  }
  return piezo_skin_sensor().create(parameters, parts, 7, trial, "pad");
}

// One sticking unit under this force [N], on a stage at x [m].
ContactFrame contact(const Eigen::Array3d& force, double x = 0.0) {
  ContactFrame truth;
  truth.force = force;
  truth.unit_state = {UnitState::stick};
  truth.state = PadState::non_slip;
  truth.stage_position = {x, 0.0, 0.0};
  return truth;
}

float read(Sensor& sensor, const ContactFrame& truth) { return sensor.measure(truth).values[0]; }

TEST(PiezoSkinPad, SharesItsStiffnessEquallyOnTheDisc) {
  const auto sensor = skin({{"elements", std::int64_t{37}}, {"radius", 4e-3}});
  double k_normal = 0.0, k_tangential = 0.0, square = 0.0;
  for (const Element& element : sensor->layout().elements) {
    k_normal += element.k_normal;
    k_tangential += element.k_tangential;
    square += element.tip.head<2>().squaredNorm() / 37.0;
    EXPECT_LE(element.tip.head<2>().norm(), 4e-3);
    EXPECT_EQ(element.tip.z(), 0.0) << "a flat tip";
  }
  ASSERT_EQ(sensor->layout().units.size(), 1u);
  EXPECT_EQ(sensor->layout().units[0].count, 37u);
  EXPECT_NEAR(k_normal, 20e3, 1e-9);
  EXPECT_NEAR(k_tangential, 6e3, 1e-9);
  EXPECT_NEAR(square, 0.5 * 16e-6, 1e-18) << "as on an even disc";
}

TEST(PiezoSkinPad, CarriesTheForceOfAnElasticFoundation) {
  // R = 100 mm, a = 5 mm: from the deepest point to the rim a^2/2R = 125 um; the mean is half of
  // that above the deepest point. Pressed by d below the mean, all elements touch from d = 62.5 um
  // on and carry k d; for smaller d a disc of r^2 = 2R (d + 62.5 um) touches and carries (k/2)(d +
  // 62.5 um)^2/125 um.
  const auto sensor = skin({{"elements", std::int64_t{1000}}, {"tip_radius", 0.1}});
  const auto force = [&](double depth) {
    double sum = 0.0;
    for (const Element& element : sensor->layout().elements) sum += element.k_normal * std::max(0.0, depth - element.tip.z());
    return sum;
  };
  EXPECT_NEAR(force(62.5e-6), 20e3 * 62.5e-6, 1e-9);
  EXPECT_NEAR(force(0.25e-3), 5.0, 1e-9);
  EXPECT_NEAR(force(0.5e-3), 10.0, 1e-9);
  // The sum over n rings of equal area differs from the integral by less than k 125 um/(8 n^2).
  EXPECT_NEAR(force(0.0), 0.5 * 20e3 * 62.5e-6 * 62.5e-6 / 125e-6, 20e3 * 125e-6 / 8e6);
}

TEST(BandPass, OfAStepDecaysByItsCorner) {
  // x rises by 1 linearly over one sample, then is constant: y = (1 - E)/a at the end of the rise,
  // and decays by E per sample.
  std::array<double, BandPass::memory_size> memory{};
  BandPass amplifier(3.0, inf, 1e4, memory);
  const double a = 2.0 * pi * 3.0 / 1e4;
  EXPECT_EQ(amplifier.next(5.0), 0.0) << "settled at the beginning";
  for (int k = 1; k <= 2000; ++k) {
    ASSERT_NEAR(amplifier.next(6.0), -std::expm1(-a) / a * std::exp(-a * (k - 1)), 1e-14) << k;
  }
}

// A ramp of 1/s gives (1 - exp(-w t))/w at any sampling rate: in the end the rate of the force over
// w.
TEST(BandPass, OfARampTellsTheRate) {
  for (const double rate : {200.0, 10e3}) {
    std::array<double, BandPass::memory_size> memory{};
    BandPass amplifier(3.0, inf, rate, memory);
    const double w = 2.0 * pi * 3.0;
    for (int k = 0; k < static_cast<int>(rate); ++k) {
      const double t = k / rate;
      ASSERT_NEAR(amplifier.next(t), -std::expm1(-w * t) / w, 1e-13) << t;
    }
  }
}

TEST(BandPass, AntiAliasingIsALowPass) {
  // With a corner near 0 the high-pass passes the ramp, and the low-pass turns it into t - (1 -
  // exp(-w t))/w.
  std::array<double, BandPass::memory_size> memory{};
  BandPass amplifier(1e-9, 100.0, 1e4, memory);
  const double w = 2.0 * pi * 100.0;
  for (int k = 0; k < 1000; ++k) {
    const double t = k / 1e4;
    ASSERT_NEAR(amplifier.next(t), t + std::expm1(-w * t) / w, 1e-9) << t;
  }
}

TEST(PiezoSkin, HearsNormalAndTangentialForce) {
  // Into the second sample: gain (1 - E)/a of the change.
  const double a = 2.0 * pi * 3.0 / 1e4, passed = -std::expm1(-a) / a;
  const auto change = [&](const Eigen::Array3d& force) {
    const auto sensor = skin({{"shear", std::vector{0.35, -0.5}}});
    EXPECT_EQ(read(*sensor, contact({0.0, 0.0, 1.0})), 0.0F);
    return static_cast<double>(read(*sensor, contact(Eigen::Array3d(0.0, 0.0, 1.0) + force)));
  };
  EXPECT_NEAR(change({0.0, 0.0, 0.01}), 2000.0 * passed * 0.01, 1e-5);
  EXPECT_NEAR(change({0.01, 0.0, 0.0}), 2000.0 * passed * 0.35 * 0.01, 1e-5);
  EXPECT_NEAR(change({0.0, 0.01, 0.0}), -2000.0 * passed * 0.5 * 0.01, 1e-5);
}

TEST(PiezoSkin, TypicalElectronicsAreNoiseOfSeventyCountsInWholeCounts) {
  const auto sensor = skin({}, true);
  constexpr int n = 20000;
  double sum = 0.0, square = 0.0;
  for (int k = 0; k < n; ++k) {
    const double y = static_cast<double>(read(*sensor, contact({0.0, 0.0, 5.0})));
    ASSERT_EQ(y, std::round(y));
    sum += y / n;
    square += y * y / n;
  }
  // 35 mN at 2,000 counts/N: variance 70^2 + 1/12 counts^2; standard error of an sd 1/sqrt(2n) =
  // 0.5 %, of a mean 70/sqrt(n) = 0.49 counts.
  EXPECT_NEAR(std::sqrt(square - sum * sum) / std::sqrt(4900.0 + 1.0 / 12.0), 1.0, 5.0 * std::sqrt(0.5 / n));
  EXPECT_LE(std::abs(sum), 5.0 * std::hypot(3.0, 0.49)) << "the offset has an sd of 3 counts";
}

TEST(PiezoSkin, CountsWhatLiesBeyondItsConverter) {
  // A step of 20 N is 40,000 (1 - E)/a = 39,962 counts, a = 2 pi 3/10,000, and falls by E = exp(-a)
  // per sample: it stays above 32,767.5 for ln(39,962/32,767.5)/a = 105.3 more samples, 106 in all.
  // There it falls by 62 counts per sample with a noise of sd 70: each sample near the end
  // saturates with a probability p, so its variance is p (1 - p); their sum is 70/62/sqrt(pi) =
  // 0.64, an sd of 0.80. The offset shifts the end by 3/62.
  const auto sensor = skin({}, true);
  read(*sensor, contact({0.0, 0.0, 0.0}));
  for (int i = 0; i < 200; ++i) read(*sensor, contact({0.0, 0.0, 20.0}));
  EXPECT_NEAR(static_cast<double>(sensor->saturated()), 106.0, 5.0 * 0.80);
  const auto ideal = skin();
  for (const double force : {0.0, 20.0}) read(*ideal, contact({0.0, 0.0, force}));
  EXPECT_EQ(ideal->saturated(), 0u) << "it has no converter";
}

TEST(PiezoSkin, GoesOnFromItsMemory) {
  const auto lasting = skin({}, true), fresh = skin({}, true);
  const auto force = [](int k) { return contact({0.3 * k, 0.0, std::sin(0.1 * k)}, 1e-5 * (k / 150)); };
  for (int k = 0; k < 333; ++k) read(*lasting, force(k));
  const auto saved = lasting->memory(), loaded = fresh->memory();
  ASSERT_EQ(saved.size(), loaded.size());
  for (std::size_t m = 0; m < saved.size(); ++m) std::ranges::copy(saved[m], loaded[m].begin());
  for (int k = 333; k < 700; ++k) {
    ASSERT_EQ(read(*lasting, force(k)), read(*fresh, force(k))) << k;
    ASSERT_EQ(lasting->paper_label(force(k), false), fresh->paper_label(force(k), false)) << k;
  }
}

TEST(PaperLabelOfTheSkin, IsThatOfAPositionSensorAtAHundredHertz) {
  // The stage rests for 25 ms, moves at 1.8 mm/s and stops at 55 ms. Read at 0, 10, 20 ms ..., it
  // has moved by 9 um at 30 ms, which is not more than 10 um, by another 18 um at 40 and at 50 ms,
  // and by the last 9 um at 60 ms. So slip is reported from 40 to 60 ms, while it happens from 25
  // to 55 ms.
  const auto sensor = skin();
  for (int k = 0; k < 1000; ++k) {
    const double t = k * 1e-4;
    const ContactFrame truth = contact({0.0, 0.0, 1.0}, 1.8e-3 * (std::clamp(t, 0.025, 0.055) - 0.025));
    read(*sensor, truth);
    ASSERT_EQ(sensor->paper_label(truth, false), k >= 400 && k < 600 ? PadState::gross : PadState::non_slip) << t;
    ContactFrame apart = truth;
    apart.state = PadState::no_contact;
    ASSERT_EQ(sensor->paper_label(apart, false), PadState::no_contact);
  }
}

TEST(PaperLabelOfTheSkin, NeedsAWholeNumberOfSamples) {
  EXPECT_NO_THROW(skin({{"label_rate", 200.0}}));
  for (const double rate : {300.0, 20e3}) {
    EXPECT_THAT(refusal_of<SceneValueError>([&] { skin({{"label_rate", rate}}); }), mentions({"rate", "whole number"}));
  }
}

TEST(PiezoSkin, SaysWhatItEmits) {
  const auto sensor = skin();
  EXPECT_EQ(sensor->rate(), 10e3);
  ASSERT_EQ(sensor->channels().size(), 1u);
  EXPECT_EQ(sensor->channels()[0].name, "signal");
  EXPECT_EQ(sensor->channels()[0].size(), 1u);
}

}  // namespace
}  // namespace slipbench::piezo_skin_test
