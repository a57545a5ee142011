#include "sensors/papillarray/papillarray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "sim/api/sensor.h"
#include "sim/core/random.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

Parameters defaults() { return defaults_of(papillarray_sensor().about.parameters); }

std::vector<Named> typical() {
  std::vector<Named> parts;
  for (const Entry& entry : papillarray_sensor().electronics) parts.push_back({entry.name, defaults_of(entry.parameters)});
  return parts;
}

Named only(const std::string& name) {
  const auto parts = typical();
  return *std::find_if(parts.begin(), parts.end(), [&](const Named& part) { return part.name == name; });
}

std::unique_ptr<Sensor> make(const Parameters& parameters, const std::vector<Named>& electronics = {}, std::uint64_t trial = 0) {
  return papillarray_sensor().create(parameters, electronics, 7, trial, "pad");
}

// Nine detached pillars without load.
ContactFrame empty_frame() {
  ContactFrame frame;
  frame.force.setZero(3, 9);
  frame.displacement.setZero(3, 9);
  frame.slip_velocity.setZero(2, 9);
  frame.unit_state.assign(9, UnitState::detached);
  return frame;
}

std::vector<float> reading(Sensor& sensor, const ContactFrame& truth) {
  const auto& values = sensor.measure(truth).values;
  return {values.begin(), values.end()};
}

TEST(PapillArray, PillarsStandInTheVendorsOrder) {
  // Seen from the surface it touches, +X up and +Y right: P6 P3 P0 / P7 P4 P1 / P8 P5 P2, pitch 7
  // mm.
  const auto sensor = make(defaults());
  const PadLayout& layout = sensor->layout();
  ASSERT_EQ(layout.elements.size(), 9U);
  ASSERT_EQ(layout.units.size(), 9U);
  const double xy[9][2] = {{7, 7}, {0, 7}, {-7, 7}, {7, 0}, {0, 0}, {-7, 0}, {7, -7}, {0, -7}, {-7, -7}};  // mm
  for (std::size_t p = 0; p < 9; ++p) {
    EXPECT_EQ(layout.units[p].first, p);
    EXPECT_EQ(layout.units[p].count, 1U);
    EXPECT_DOUBLE_EQ(layout.elements[p].tip.x(), xy[p][0] * 1e-3) << "P" << p;
    EXPECT_DOUBLE_EQ(layout.elements[p].tip.y(), xy[p][1] * 1e-3) << "P" << p;
    EXPECT_EQ(layout.elements[p].axis, Eigen::Vector3d(0.0, 0.0, -1.0));
  }
}

TEST(PapillArray, HasThreeHeights) {
  // Compression is +Z and the pad is above the object: a shorter pillar's tip lies at larger z.
  Parameters parameters = defaults();
  const auto sensor = make(parameters);
  for (const std::size_t corner : {0U, 2U, 6U, 8U}) EXPECT_DOUBLE_EQ(sensor->layout().elements[corner].tip.z(), 0.45e-3);
  for (const std::size_t edge : {1U, 3U, 5U, 7U}) EXPECT_DOUBLE_EQ(sensor->layout().elements[edge].tip.z(), 0.20e-3);
  EXPECT_EQ(sensor->layout().elements[4].tip.z(), 0.0);

  parameters.set("edge_drop", 0.1e-3);
  parameters.set("corner_drop", 0.3e-3);
  const auto flatter = make(parameters);
  EXPECT_DOUBLE_EQ(flatter->layout().elements[1].tip.z(), 0.1e-3);
  EXPECT_DOUBLE_EQ(flatter->layout().elements[0].tip.z(), 0.3e-3);
}

TEST(PapillArray, ProfilesHaveTheirStiffness) {
  Parameters parameters = defaults();
  const auto gripper = make(parameters);
  for (const Element& element : gripper->layout().elements) {
    EXPECT_DOUBLE_EQ(element.k_normal, 7100.0);
    EXPECT_DOUBLE_EQ(element.k_tangential, 3900.0);
    EXPECT_EQ(element.c_normal, 0.0);
    EXPECT_EQ(element.c_tangential, 0.0);
  }
  parameters.set("profile", std::string("hexapod"));
  const auto hexapod = make(parameters);
  for (const Element& element : hexapod->layout().elements) {
    EXPECT_DOUBLE_EQ(element.k_normal, 1200.0);
    EXPECT_DOUBLE_EQ(element.k_tangential, 650.0);
  }
}

class Bristles : public testing::TestWithParam<std::int64_t> {};

TEST_P(Bristles, ShareThePillarsStiffness) {
  Parameters parameters = defaults();
  parameters.set("bristles", GetParam());
  const auto n = static_cast<std::size_t>(GetParam());
  const auto sensor = make(parameters);
  const PadLayout& layout = sensor->layout();
  ASSERT_EQ(layout.elements.size(), 9 * n);
  for (std::size_t p = 0; p < 9; ++p) {
    ASSERT_EQ(layout.units[p].first, p * n);
    ASSERT_EQ(layout.units[p].count, n);
    double k_normal = 0.0;
    double k_tangential = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      const Element& element = layout.elements[p * n + j];
      EXPECT_EQ(element.tip, layout.elements[p * n].tip);
      k_normal += element.k_normal;
      k_tangential += element.k_tangential;
      EXPECT_DOUBLE_EQ(element.k_tangential, 3900.0 / static_cast<double>(n));
    }
    EXPECT_NEAR(k_normal, 7100.0, 1e-9);  // rounding of up to 64 sums
    EXPECT_NEAR(k_tangential, 3900.0, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, Bristles, testing::Values(1, 2, 6, 64));

TEST(PapillArray, BristleWeightsAreLinear) {
  // n = 4, w = 0.4: from 1.6 to 0.4 in steps of 0.4, of 7100/4 = 1775 N/m each.
  Parameters parameters = defaults();
  parameters.set("bristles", std::int64_t{4});
  const auto sensor = make(parameters);
  const double weights[4] = {1.6, 1.2, 0.8, 0.4};
  for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(sensor->layout().elements[j].k_normal, 1775.0 * weights[j], 1e-9);

  parameters.set("bristle_spread", 1.0);
  const auto equal = make(parameters);
  for (const Element& element : equal->layout().elements) EXPECT_DOUBLE_EQ(element.k_normal, 1775.0);
}

TEST(PapillArray, StiffnessScattersAsAsked) {
  // 200 devices of nine pillars with sd 0.09: lognormal of mean 1, so the mean has the standard
  // error 0.09/sqrt(1800), and the sd a relative one of sqrt((3.13 - 1)/1800)/2 = 1.7 % (kurtosis
  // 3.13 from s^2 = ln(1.0081)). Five of them are allowed.
  Parameters parameters = defaults();
  parameters.set("stiffness_sd", 0.09);
  parameters.set("device", std::string("redrawn"));
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const auto sensor = make(parameters, {}, trial);
    for (const Element& element : sensor->layout().elements) {
      const double factor = element.k_normal / 7100.0;
      EXPECT_NEAR(element.k_tangential / 3900.0, factor, 1e-12);
      sum += factor - 1.0;
      squares += (factor - 1.0) * (factor - 1.0);
    }
  }
  EXPECT_NEAR(sum / 1800.0, 0.0, 5.0 * 0.09 / std::sqrt(1800.0));
  EXPECT_NEAR(std::sqrt(squares / 1800.0) / 0.09, 1.0, 5.0 * 0.017);
}

TEST(PapillArray, ADeviceIsTheSameInAllTrialsUnlessRedrawn) {
  Parameters parameters = defaults();
  parameters.set("stiffness_sd", 0.09);
  ContactFrame truth = empty_frame();
  truth.force.setOnes();
  const auto stiffness = [&](std::uint64_t trial) { return make(parameters, {}, trial)->layout().elements[0].k_normal; };
  const auto gains = [&](std::uint64_t trial) { return reading(*make(parameters, {only("gain")}, trial), truth); };
  const auto offsets = [&](std::uint64_t trial) { return reading(*make(parameters, {only("offset")}, trial), truth); };
  EXPECT_EQ(stiffness(1), stiffness(2));
  EXPECT_EQ(gains(1), gains(2));
  EXPECT_NE(offsets(1), offsets(2));  // new in each recording
  parameters.set("device", std::string("redrawn"));
  EXPECT_NE(stiffness(1), stiffness(2));
  EXPECT_NE(gains(1), gains(2));
}

TEST(PapillArray, DescribesItsChannels) {
  const auto sensor = make(defaults());
  const auto& channels = sensor->channels();
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0].name, "force");
  EXPECT_EQ(channels[0].unit, "N");
  EXPECT_THAT(channels[0].shape, ElementsAre(9, 3));
  EXPECT_EQ(channels[1].name, "displacement");
  EXPECT_EQ(channels[1].unit, "m");
  EXPECT_THAT(channels[1].shape, ElementsAre(9, 3));
  for (const Channel& channel : channels) EXPECT_EQ(channel.channel_names.size(), channel.size());
  EXPECT_EQ(channels[0].channel_names[0], "P0_FX");
  EXPECT_EQ(channels[0].channel_names[14], "P4_FZ");  // 3*4 + 2
  EXPECT_EQ(channels[1].channel_names[25], "P8_DY");  // 3*8 + 1
}

TEST(PapillArray, IdealReadingIsTheTruthInSinglePrecision) {
  const auto sensor = make(defaults());
  ContactFrame truth = empty_frame();
  truth.time = 0.125;
  for (Eigen::Index p = 0; p < 9; ++p) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      truth.force(axis, p) = 0.1 + static_cast<double>(p) - 0.37 * static_cast<double>(axis);
      truth.displacement(axis, p) = 1e-3 / (1.0 + static_cast<double>(3 * p + axis));
    }
  }
  const SensorFrame& frame = sensor->measure(truth);
  EXPECT_EQ(frame.time, 0.125);
  ASSERT_EQ(frame.values.size(), 54U);
  for (Eigen::Index p = 0; p < 9; ++p) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto v = static_cast<std::size_t>(3 * p + axis);
      EXPECT_EQ(frame.values[v], static_cast<float>(truth.force(axis, p)));
      EXPECT_EQ(frame.values[27 + v], static_cast<float>(truth.displacement(axis, p)));
    }
  }
}

TEST(PapillArray, RatesOfTheDeviceOnly) {
  Parameters parameters = defaults();
  EXPECT_EQ(make(parameters)->rate(), 1000.0);
  for (const double rate : {100.0, 250.0, 500.0, 1000.0}) {
    parameters.set("rate", rate);
    EXPECT_EQ(make(parameters)->rate(), rate);
  }
  parameters.set("rate", 300.0);
  EXPECT_THAT(refusal_of([&] { make(parameters); }),
              AllOf(HasSubstr("sensors.pad.rate"), HasSubstr("300 Hz"), HasSubstr("100 Hz, 250 Hz, 500 Hz, 1000 Hz")));
}

TEST(PapillArray, NoiseOfForceAndDisplacementIsOneProcess) {
  // Each force is its displacement times the ratio of their measured sd: 1.4 mN/0.4 um, 2.5/0.7,
  // 5.3/1.4, and with the softer pillars of the hexapod less by 0.65/3.9 and 1.2/7.1.
  const double gripper[3] = {1.4e-3 / 0.4e-6, 2.5e-3 / 0.7e-6, 5.3e-3 / 1.4e-6};
  const double softer[3] = {0.65 / 3.9, 0.65 / 3.9, 1.2 / 7.1};
  Parameters parameters = defaults();
  for (const bool hexapod : {false, true}) {
    parameters.set("profile", std::string(hexapod ? "hexapod" : "gripper"));
    const auto values = reading(*make(parameters, {only("noise")}), empty_frame());
    for (std::size_t v = 0; v < 27; ++v) {
      ASSERT_NE(values[v], 0.0F);
      const double ratio = gripper[v % 3] * (hexapod ? softer[v % 3] : 1.0);
      EXPECT_NEAR(static_cast<double>(values[v] / values[27 + v]) / ratio, 1.0, 1e-6);  // single precision
    }
  }
}

// Root mean square of one value's reading of an unloaded sensor over `trials` trials and nine
// pillars; axis 0 to 2.
double unloaded_rms(const std::string& name, std::size_t first_value, std::size_t axis, double time) {
  double sum = 0.0;
  ContactFrame truth = empty_frame();
  truth.time = time;
  for (std::uint64_t trial = 0; trial < 400; ++trial) {
    const auto values = reading(*make(defaults(), {only(name)}, trial), truth);
    for (std::size_t p = 0; p < 9; ++p) {
      const auto value = static_cast<double>(values[first_value + 3 * p + axis]);
      sum += value * value;
    }
  }
  return std::sqrt(sum / 3600.0);
}

TEST(PapillArray, DisturbancesHaveTheMeasuredSize) {
  // 3600 independent draws: the sd has a relative standard error of sqrt(1/7200) = 1.2 %.
  const double tolerance = 5.0 * std::sqrt(1.0 / 7200.0);
  EXPECT_NEAR(unloaded_rms("noise", 0, 2, 0.0) / 5.3e-3, 1.0, tolerance);
  EXPECT_NEAR(unloaded_rms("noise", 27, 2, 0.0) / 1.4e-6, 1.0, tolerance);
  // Offsets: medians of |FZ| of 9 and 15 mN (12 mN/0.6745 = 18 mN) and a 95th percentile of 45 mN
  // (/1.96 = 23 mN): 20 mN.
  EXPECT_NEAR(unloaded_rms("offset", 0, 2, 0.0) / 20e-3, 1.0, tolerance);
  EXPECT_NEAR(unloaded_rms("offset", 27, 2, 0.0) / 3e-6, 1.0, tolerance);
  // Drift: 90 % of slopes within 1.5 mN/s and 0.4 um/s: over 1.645.
  EXPECT_NEAR(unloaded_rms("drift", 0, 2, 2.0) / (2.0 * 1.5e-3 / 1.645), 1.0, tolerance + 0.01);  // the figure has two digits
  EXPECT_NEAR(unloaded_rms("drift", 27, 2, 2.0) / (2.0 * 0.4e-6 / 1.645), 1.0, tolerance + 0.02);
}

// The apparent stiffness K_ij = dF_i/dD_j of every pillar, with force and displacement of the
// gripper's springs, 3.9 and 7.1 N/mm.
std::array<Eigen::Matrix3d, 9> stiffness_read(const Parameters& parameters, const Named& coupling, std::uint64_t trial) {
  std::array<Eigen::Matrix3d, 9> force, displacement;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto sensor = make(parameters, {coupling}, trial);
    ContactFrame truth = empty_frame();
    truth.displacement.row(axis) = 1e-3;
    truth.force.row(axis) = axis == 2 ? 7.1 : 3.9;
    const auto values = reading(*sensor, truth);
    for (std::size_t p = 0; p < 9; ++p) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        const std::size_t v = 3 * p + static_cast<std::size_t>(i);
        force[p](i, axis) = static_cast<double>(values[v]);
        displacement[p](i, axis) = static_cast<double>(values[27 + v]);
      }
    }
  }
  for (std::size_t p = 0; p < 9; ++p) force[p] = force[p] * displacement[p].inverse();
  return force;
}

// Coefficients are uniform within 1, 0.15 and 0.22, so their rms are those over sqrt(3): of FZ over
// DX and DY 3.9/sqrt(3) = 2.252 N/mm, of FX and FY over DZ 0.15*7.1/sqrt(3) = 0.615, of FX over DY
// and back 0.22*3.9/sqrt(3) = 0.495. Over 300 devices of nine pillars with two each the mean square
// of a uniform has the relative standard error sqrt(4/5/5400) = 1.2 %, the rms half of it; five of
// them are allowed. Carried by displacement, F = diag(k) (I + E)^-1 D has the same to first order
// in E. At a tenth of the coupling the second order is largest for FX of DY: E_xz E_zy, rms
// 0.0158*0.0317, beside E_xy, rms 0.0127. These 4 % are not correlated with it, and add 0.08 % to
// the rms.
TEST(PapillArray, CouplingHasTheMeasuredStiffnessBetweenAxes) {
  constexpr double scale = 0.1;
  Parameters parameters = defaults();
  parameters.set("device", std::string("redrawn"));
  for (const auto& [carrier, tolerance] :
       {std::pair{"force", 5.0 * 0.006}, {"displacement", 5.0 * 0.006 + 0.001}, {"both", 5.0 * 0.006 + 0.001}}) {
    Named coupling = only("coupling");
    EXPECT_EQ(coupling.parameters.choice("carrier"), "force") << "the default";
    coupling.parameters.set("carrier", std::string(carrier));
    coupling.parameters.set("scale", scale);
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (std::uint64_t device = 0; device < 300; ++device) {
      for (const Eigen::Matrix3d& stiffness : stiffness_read(parameters, coupling, device))
        squares += stiffness.cwiseAbs2() / 2700.0;
    }
    const auto rms = [&](Eigen::Index i, Eigen::Index j, Eigen::Index k, Eigen::Index l) {
      return 1e-3 * std::sqrt(0.5 * (squares(i, j) + squares(k, l)));
    };
    EXPECT_NEAR(rms(2, 0, 2, 1) / (scale * 2.252), 1.0, tolerance) << carrier;
    EXPECT_NEAR(rms(0, 2, 1, 2) / (scale * 0.615), 1.0, tolerance) << carrier;
    EXPECT_NEAR(rms(0, 1, 1, 0) / (scale * 0.495), 1.0, tolerance) << carrier;
  }
}

// A coefficient belongs to a device: to its pillar and its pair of axes, whatever the profile.
TEST(PapillArray, CouplingLeavesTheCarrierAlone) {
  ContactFrame truth = empty_frame();
  truth.force.setConstant(2.0);
  truth.displacement.setConstant(0.3e-3);
  Named coupling = only("coupling");
  for (const std::size_t clean : {27U, 0U}) {
    coupling.parameters.set("carrier", std::string(clean == 27 ? "force" : "displacement"));
    const auto values = reading(*make(defaults(), {coupling}), truth);
    for (std::size_t v = 0; v < 27; ++v) {
      EXPECT_EQ(values[clean + v], clean == 27 ? 0.3e-3F : 2.0F);
      EXPECT_NE(values[27 - clean + v], clean == 27 ? 2.0F : 0.3e-3F);
    }
  }
}

// The coupling up to version 0.2: FX and FY of FZ alone, at most 0.3 N/mm over 7.1 N/mm, rounded to
// 0.042.
TEST(PapillArray, CouplingOfNormalForceAloneTurnsItIntoShear) {
  Named coupling = only("coupling");
  coupling.parameters.set("shear_to_normal", 0.0);
  coupling.parameters.set("normal_to_shear", 0.042);
  coupling.parameters.set("shear_to_shear", 0.0);
  const auto sensor = make(defaults(), {coupling});
  ContactFrame truth = empty_frame();
  truth.force.row(2) = 2.0;
  truth.displacement.row(2) = 0.3e-3;
  const auto values = reading(*sensor, truth);
  // The first two draws of the device's stream, which sensors of version 0.2 had.
  RandomStream stream(7, 0, "electronics.pad.coupling");
  for (std::size_t p = 0; p < 9; ++p) {
    for (const std::size_t axis : {0U, 1U}) {
      EXPECT_EQ(values[3 * p + axis], static_cast<float>(stream.uniform(-0.042, 0.042)) * 2.0F);
      EXPECT_EQ(values[27 + 3 * p + axis], 0.0F);
    }
    EXPECT_EQ(values[3 * p + 2], 2.0F);
    EXPECT_EQ(values[27 + 3 * p + 2], 0.3e-3F);
  }
}

// At 100 Hz a vibration of 130 Hz reads as one of 30 Hz. The filter is at work at every
// millisecond: 1/(1 + (130/365.1)^2) = 0.8875, and of a sine that goes straight between
// milliseconds sinc(0.13)^2 = 0.9456 is left: 0.8392. Its image at 870 Hz, sinc(0.87)^2 = 0.0211,
// passes by 1/(1 + (870/365.1)^2) = 0.1498 and folds to 30 Hz, too: 0.0032 more or less.
TEST(PapillArray, LowPassWorksBetweenTheSamplesOfASlowSensor) {
  Parameters parameters = defaults();
  parameters.set("rate", 100.0);
  const auto sensor = make(parameters, {only("low_pass")});
  ASSERT_TRUE(sensor->feels_every_tick());
  ContactFrame truth = empty_frame();
  std::complex<double> sum;  // over the 100 samples of the second second
  for (std::size_t tick = 0; tick < 2000; ++tick) {
    truth.time = 1e-3 * static_cast<double>(tick);
    truth.force.row(2) = std::sin(2.0 * std::numbers::pi * 130.0 * truth.time);
    if (tick % 10 != 0) {
      sensor->feel(truth);
      continue;
    }
    const auto values = reading(*sensor, truth);
    if (tick >= 1000) sum += static_cast<double>(values[2]) * std::polar(1.0, -2.0 * std::numbers::pi * 30.0 * truth.time);
  }
  EXPECT_NEAR(2.0 * std::abs(sum) / 100.0, 0.8392, 0.004);
  EXPECT_FALSE(make(parameters)->feels_every_tick()) << "without the part nothing happens between two samples";
}

// A slow sensor carries its memory from one sample to the next.
TEST(PapillArray, AMemoryThatIsTakenOverBetweenTwoSamplesGoesOnToTheSameBits) {
  Parameters parameters = defaults();
  parameters.set("rate", 250.0);
  const auto lasting = make(parameters, typical()), fresh = make(parameters, typical());
  ContactFrame truth = empty_frame();
  const auto at = [&](double tick) {
    truth.time = 1e-3 * tick;
    truth.force.setConstant(std::sin(100.0 * truth.time));
    truth.displacement.setConstant(1e-3 * std::sin(100.0 * truth.time));
    return truth;
  };
  for (int tick = 0; tick < 10; ++tick) {  // the sample of 8 ms, and one step after it
    if (tick % 4 == 0)
      lasting->measure(at(tick));
    else
      lasting->feel(at(tick));
  }
  const auto saved = lasting->memory(), loaded = fresh->memory();
  ASSERT_EQ(saved.size(), loaded.size());
  for (std::size_t k = 0; k < saved.size(); ++k) std::ranges::copy(saved[k], loaded[k].begin());
  for (int tick = 10; tick < 30; ++tick) {
    if (tick % 4 == 0) {
      ASSERT_EQ(reading(*lasting, at(tick)), reading(*fresh, at(tick))) << tick;
    } else {
      lasting->feel(at(tick));
      fresh->feel(at(tick));
    }
  }
}

// Force within 4 N along the surface and up to 15 N into it, displacement within 1 mm and up to 2.5
// mm; a pulled pillar is not judged.
TEST(PapillArray, CountsSamplesBeyondTheMakersRange) {
  const auto sensor = make(defaults(), {only("valid_range")});
  ContactFrame truth = empty_frame();
  const auto count = [&] {
    sensor->measure(truth);
    return sensor->saturated();
  };
  truth.force.col(3) << 4.0, -4.0, 15.0;
  truth.displacement.col(3) << -1e-3, 1e-3, 2.5e-3;
  EXPECT_EQ(count(), 0U);
  truth.force(2, 5) = -20.0;
  EXPECT_EQ(count(), 0U);
  truth.displacement(2, 5) = 2.51e-3;
  EXPECT_EQ(count(), 1U);
  truth.displacement(2, 5) = 0.0;
  truth.force(1, 8) = 4.01;
  EXPECT_EQ(count(), 2U);
  EXPECT_EQ(make(defaults())->saturated(), 0U);
}

// The flags follow the readings, which are bit-identical to those of a typical device without
// flags.
TEST(PapillArray, FlagsThePillarsBeyondTheMakersRange) {
  Parameters parameters = defaults();
  parameters.set("range_flag", true);
  for (const std::vector<Named>& electronics : {typical(), std::vector<Named>{only("valid_range")}}) {
    const auto plain = make(defaults(), electronics), flagged = make(parameters, electronics);
    ASSERT_EQ(flagged->channels().size(), 3U);
    const Channel& channel = flagged->channels()[2];
    EXPECT_EQ(channel.name, "out_of_range");
    EXPECT_EQ(channel.unit, "1");
    EXPECT_THAT(channel.shape, ElementsAre(9));
    EXPECT_EQ(channel.channel_names.size(), channel.size());
    EXPECT_EQ(channel.channel_names[7], "P7_OUT");
    EXPECT_EQ(plain->feels_every_tick(), flagged->feels_every_tick());
    ContactFrame truth = empty_frame();
    truth.force(2, 2) = 22.0;                // into the pad, beyond 15 N by three sd of its gain
    truth.displacement(0, 3) = -1.2e-3;      // along the surface
    truth.force(2, 5) = -10.0;               // a pulled pillar is not judged, and its shear is within 2 N
    for (int tick = 0; tick < 30; ++tick) {  // 30 ms, by which the low-pass has settled
      truth.time = 1e-3 * tick;
      const auto values = reading(*flagged, truth), without = reading(*plain, truth);
      ASSERT_EQ(values.size(), 63U);
      EXPECT_TRUE(std::equal(without.begin(), without.end(), values.begin()));
      EXPECT_THAT(std::vector<float>(values.begin() + 54, values.end()), ElementsAre(0, 0, 1, 1, 0, 0, 0, 0, 0)) << tick;
    }
    EXPECT_EQ(flagged->saturated(), plain->saturated());
    truth.force.setZero();
    truth.displacement.setZero();
    for (int tick = 30; tick < 60; ++tick) {
      truth.time = 1e-3 * tick;
      flagged->measure(truth);
    }
    const auto values = reading(*flagged, truth);
    EXPECT_THAT(std::vector<float>(values.begin() + 54, values.end()), Each(0.0F)) << "a flag is of one sample";
  }
}

TEST(PapillArray, AFlagNeedsTheRange) {
  Parameters parameters = defaults();
  parameters.set("range_flag", true);
  EXPECT_THAT(refusal_of([&] { make(parameters, {only("noise")}); }),
              AllOf(HasSubstr("sensors.pad.range_flag"), HasSubstr("valid_range"), HasSubstr("electronics: typical")));
}

TEST(PapillArray, GainChangesTheForceOnly) {
  const auto sensor = make(defaults(), {only("gain")});
  ContactFrame truth = empty_frame();
  truth.force.setOnes();
  truth.displacement.setConstant(1e-3);
  const auto values = reading(*sensor, truth);
  for (std::size_t v = 0; v < 27; ++v) {
    EXPECT_NE(values[v], 1.0F);
    EXPECT_EQ(values[27 + v], 1e-3F);
  }
}

TEST(PapillArray, EveryPartStatesWhatWasMeasured) {
  for (const Entry& entry : papillarray_sensor().electronics)
    EXPECT_THAT(entry.source, StartsWith("PapillArray: ")) << entry.name;
}

TEST(PaperLabel, CountsThePillarsInContactThatMoveFasterThanTheThreshold) {
  const auto sensor = make(defaults());  // threshold 0.1 mm/s
  ContactFrame truth = empty_frame();
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::no_contact);
  truth.unit_state[4] = UnitState::stick;
  truth.unit_state[1] = UnitState::slip;
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::non_slip);
  truth.slip_velocity.col(1) << 0.06e-3, 0.07e-3;  // 0.092 mm/s: not above the threshold
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::non_slip);
  truth.slip_velocity.col(1) << 0.06e-3, 0.09e-3;  // 0.108 mm/s
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::incipient);
  truth.slip_velocity.col(4) << -0.2e-3, 0.0;
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::gross);
}

TEST(PaperLabel, LeavesOutTheCentrePillarInRotation) {
  const auto sensor = make(defaults());
  ContactFrame truth = empty_frame();
  truth.unit_state[4] = UnitState::stick;
  truth.unit_state[0] = UnitState::slip;
  truth.slip_velocity.col(0) << 1e-3, 0.0;
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::incipient);
  EXPECT_EQ(sensor->paper_label(truth, true), PadState::gross);
  // With only the centre pillar in contact there is contact, and no judged pillar slips.
  truth.unit_state[0] = UnitState::detached;
  truth.slip_velocity.col(4) << 1e-3, 0.0;
  EXPECT_EQ(sensor->paper_label(truth, true), PadState::non_slip);
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::gross);
}

// A pillar is 4.2 mm high: none can be shorter by more.
TEST(PapillArray, NoPillarIsShorterThanNothing) {
  for (const ParameterSpec& spec : papillarray_sensor().about.parameters) {
    if (spec.name != "edge_drop" && spec.name != "corner_drop") continue;
    EXPECT_NO_THROW(parse_scalar(spec, "4.2 mm"));
    EXPECT_THROW(parse_scalar(spec, "4.21 mm"), std::invalid_argument);
    EXPECT_THROW(parse_scalar(spec, "-0.01 mm"), std::invalid_argument);
  }
}

}  // namespace
}  // namespace slipbench
