// From dents to counts: the electrodes' law, their spatial response, the pressure of the fluid, and
// the electronics.
#include "sensors/biotac_sp/biotac_sp.h"

#include <algorithm>
#include <set>

#include "sensors/biotac_sp/skin.h"
#include "tests/expect.h"
#include "tests/sensors/biotac_sp/rig.h"

namespace slipbench::biotac_sp_test {
namespace {

// Impedance [kOhm] and counts of the manual's divider of 10 kOhm.
double impedance(double counts) { return (4095.0 / counts - 1.0) * 10.0; }
double counts(double kilo_ohm) { return 4095.0 / (1.0 + kilo_ohm / 10.0); }

float read(Sensor& sensor, const ContactFrame& truth, std::size_t value) { return sensor.measure(truth).values[value]; }

TEST(BioTacSp, AtRestReadsTheRestOfTheRecordings) {
  const auto sensor = make(at_once_and({{"common", 0.0}}));
  const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, 0.0));
  for (std::size_t e = 0; e < electrodes; ++e) EXPECT_EQ(frame.values[e], static_cast<float>(rest[e])) << e;
  EXPECT_EQ(frame.values[pdc], 2600.0F);
  EXPECT_EQ(frame.values[pac], 2048.0F);
  // 0.1 kOhm in series: E1 has 1.4067 kOhm at 3590 counts, so 4095/(1 + 0.15067) = 3558.8.
  const auto usual = make(at_once());
  EXPECT_EQ(read(*usual, evenly_dented(*usual, 0.0), 0), 3559.0F);
  EXPECT_NEAR(counts(impedance(3590.0) + 0.1), 3558.8, 0.05);
}

TEST(BioTacSp, ADentOfTheWholeSkinIsFeltInFullByOneElectrode) {
  // Without tail and swell w = d sum_i G_ei <= d, with equality for the electrode with the largest
  // sum: Z = Zrest exp(d/g) + Zc. Rounding to a count of some 1500 is a relative error of 3e-4, and
  // dE/E = (1 - E/4095) dw/g.
  const auto sensor = make(at_once_and({{"far_share", 0.0}, {"swell", 0.0}}));
  const auto felt = [&](double d) {
    std::array<double, electrodes> w{};
    const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, d));
    for (std::size_t e = 0; e < electrodes; ++e) {
      w[e] = 0.52e-3 * std::log((impedance(static_cast<double>(frame.values[e])) - 0.1) / impedance(rest[e]));
    }
    return w;
  };
  for (const double d : {0.3e-3, 1e-3}) {
    const auto w = felt(d);
    EXPECT_NEAR(*std::ranges::max_element(w), d, 1e-3 * d);
    // Over a closed ellipsoid sum_i A_i exp(-r^2/(2 l^2)) = 2 pi l^2 (1 + l^2 (k1 - k2)^2/8 ..),
    // with the curvatures k1 and k2 over the electrode; they differ by some 0.05/mm, so the sum is
    // the same everywhere within 1 %. The skin is half an ellipsoid, and an electrode inside the
    // half is nearer to this half than to the other: it has at least half of the sum, minus 1 % for
    // the curvature and 1 % for the mesh.
    EXPECT_GT(*std::ranges::min_element(w), 0.49 * d) << "that at the end of the finger feels half of it";
  }
  // Swell subtracts B times the mean dent from all.
  const auto swollen = make(at_once_and({{"far_share", 0.0}, {"swell", 1.0}}));
  const SensorFrame& frame = swollen->measure(evenly_dented(*swollen, 1e-3));
  double highest = -1.0;
  for (std::size_t e = 0; e < electrodes; ++e) {
    highest = std::max(highest, std::log((impedance(static_cast<double>(frame.values[e])) - 0.1) / impedance(rest[e])));
  }
  EXPECT_NEAR(highest, 0.0, 1e-3);
}

TEST(BioTacSp, StopsAtTheRailsOfItsConverter) {
  const auto sensor = make(at_once_and({{"swell", 0.0}}));
  for (int e = 0; e < 24; ++e) EXPECT_EQ(read(*sensor, evenly_dented(*sensor, 10e-3), static_cast<std::size_t>(e)), 0.0F);
  EXPECT_EQ(read(*sensor, evenly_dented(*sensor, 10e-3), pdc), 4095.0F);
  EXPECT_EQ(sensor->saturated(), 25U)
      << "the pressure is beyond pdc's range in each; an electrode that reads 0 is within its own";
  // A skin that swells far above its unloaded shape: Z falls to Zc alone, 4095/1.01 = 4054.5.
  const auto swollen = make(at_once_and({{"swell", 100.0}}));
  for (int e = 0; e < 24; ++e)
    EXPECT_NEAR(read(*swollen, evenly_dented(*swollen, 1e-3), static_cast<std::size_t>(e)), 4054.5, 0.51);
}

TEST(BioTacSp, FeelsByTheDistanceFromTheSkinOverAnElectrode) {
  // For a dent of one element: w_e/w_f = exp(-(r_e^2 - r_f^2)/(2 l^2)) of the near kernel,
  // exp(-(r_e - r_f)/L) of the far one.
  const biotac_sp::Skin skin = biotac_sp::make_skin({300, radii, 37e3, 0.5}, "sensors.finger");
  ContactFrame frame;
  frame.element_depth.setZero(300);
  frame.element_depth[100] = 1e-3;
  frame.element_shear.setZero(300, 3);
  const std::array<Eigen::Index, 1> one{100};
  const auto distance = [&](std::size_t e) { return (skin.layout.elements[100].tip - skin.above[e]).norm(); };
  const biotac_sp::Dents near(skin, {.near = 3.5e-3, .far = 9e-3, .far_share = 0.0, .swell = 0.0, .stretch = 0.0},
                              "sensors.finger");
  const biotac_sp::Dents far(skin, {.near = 3.5e-3, .far = 9e-3, .far_share = 1.0, .swell = 0.0, .stretch = 0.0},
                             "sensors.finger");
  for (std::size_t e = 1; e < electrodes; ++e) {
    const double r = distance(e), r0 = distance(0);
    EXPECT_NEAR(std::log(near.dent(e, frame, one) / near.dent(0, frame, one)), -(r * r - r0 * r0) / (2.0 * 3.5e-3 * 3.5e-3),
                1e-9);
    EXPECT_NEAR(std::log(far.dent(e, frame, one) / far.dent(0, frame, one)), -(r - r0) / 9e-3, 1e-9);
  }
}

TEST(BioTacSp, ADentThatIsDraggedTowardsAnElectrodeIsFeltMore) {
  // A dent dragged along the skin by q changes w by S d q dG/dr cos: to first order the kernel's
  // change for a dent moved there. Towards the electrode the near kernel exp(-r^2/2l^2) gains the
  // share r q/l^2, times the cosine between the skin's tangent and the line to the electrode.
  const biotac_sp::Skin skin = biotac_sp::make_skin({300, radii, 37e3, 0.5}, "sensors.finger");
  constexpr double l = 3.5e-3, q = 1e-5, stretch = 0.3;
  const biotac_sp::Dents dents(skin, {.near = l, .far = 9e-3, .far_share = 0.0, .swell = 0.0, .stretch = stretch},
                               "sensors.finger");
  for (const std::size_t e : {4U, 20U}) {
    const std::size_t i = skin.layout.units[e].first;
    const Element& element = skin.layout.elements[i];
    const Eigen::Vector3d towards = skin.above[e] - element.tip;
    const Eigen::Vector3d tangent = (towards - element.axis * element.axis.dot(towards)).normalized();
    const std::array<Eigen::Index, 1> one{static_cast<Eigen::Index>(i)};
    const auto dragged = [&](const Eigen::Vector3d& by) {
      ContactFrame frame;
      frame.element_depth.setZero(300);
      frame.element_depth[static_cast<Eigen::Index>(i)] = 1e-3;
      frame.element_shear.setZero(300, 3);
      frame.element_shear.row(static_cast<Eigen::Index>(i)) = by.transpose().array();
      return dents.dent(e, frame, one);
    };
    const double still = dragged(Eigen::Vector3d::Zero());
    EXPECT_NEAR(dragged(q * tangent) / still - 1.0, stretch * q * towards.dot(tangent) / (l * l), 1e-12);
  }
}

TEST(BioTacSp, RefusesAKernelThatReachesNoElement) {
  // exp(-r^2/(2 l^2)) and exp(-r/L) for elements that are fractions of a millimetre away.
  for (const char* const reach : {"near", "far"}) {
    // 786 mm2 over 300 elements: the root of 2.62 mm2.
    EXPECT_THAT(scene_refusal_of([&] {
                  make({{reach, 1e-9}});
                }),
                refused_at(std::string("sensors.finger.") + reach, {"1 nm", "1.6 mm"}));
  }
}

TEST(BioTacSp, SamplesAtRatesThatItsConverterCouldServe) {
  for (const ParameterSpec& spec : biotac_sp_sensor().about.parameters) {
    if (spec.name != "rate" && spec.name != "cycle_rate") continue;
    EXPECT_EQ(spec.range.min, 1.0) << spec.name;
    EXPECT_EQ(spec.range.max, 10e3) << spec.name;
  }
  // One sample per second of 10,000 cycles: each cycle's readings are its own, from the first to
  // the last.
  const auto slow = make({{"rate", 1.0}, {"cycle_rate", 10e3}});
  ASSERT_EQ(slow->scans(), 10000U);
  std::vector<float> values;
  for (std::size_t n = 0; n < slow->scans(); ++n) {
    const SensorFrame& frame = slow->measure(evenly_dented(*slow, 0.0));
    values.assign(frame.values.begin() + static_cast<std::ptrdiff_t>(n == 9999 ? pac : frame.values.size()), frame.values.end());
  }
  ASSERT_EQ(values.size(), 20000U);
  EXPECT_EQ(std::ranges::count(values, 2048.0F), 20000);
}

TEST(BioTacSp, PressureIsThatOfTheFluidDrivenAwayUntilTheSkinMeetsTheCore) {
  // Half a sphere of 10 mm: 628.3 mm2. A dent of 0.1 mm displaces 62.8 mm3: at 0.01 kPa/mm3 628.3
  // Pa, 17.2 counts of 36.5 Pa. Beyond core_gap, here 0.4 mm and 68.9 counts, the pressure stays
  // constant.
  const auto sensor =
      make(at_once_and({{"radii", std::vector{10e-3, 10e-3, 10e-3}}, {"fluid_stiffness", 0.01}, {"core_gap", 0.4e-3}}));
  EXPECT_EQ(read(*sensor, evenly_dented(*sensor, 0.1e-3), pdc), 2617.0F);
  EXPECT_EQ(read(*sensor, evenly_dented(*sensor, 0.4e-3), pdc), 2669.0F);
  EXPECT_EQ(read(*sensor, evenly_dented(*sensor, 0.9e-3), pdc), 2669.0F);
}

TEST(BioTacSp, VibrationIsTheRateOfThePressureBelowTenHertz) {
  // Half a sphere of 10 mm, dented at 0.2 mm/s: 628.3 mm2 * 0.2 mm/s * 0.01 kPa/mm3 = 1256.6 Pa/s.
  // In the steady state the high-pass of 10 Hz gives p'/(2 pi 10 Hz) = 20 Pa, 54.05 counts of 0.37
  // Pa; after 0.3 s it is within 7e-9 of that.
  const auto sensor = make({{"radii", std::vector{10e-3, 10e-3, 10e-3}}, {"fluid_stiffness", 0.01}});
  const std::size_t readings = sensor->scans();
  ASSERT_EQ(readings, 10U);
  std::size_t n = 0;
  for (int row = 0; row < 40; ++row) {
    std::vector<float> values;
    for (std::size_t k = 0; k < readings; ++k, ++n) {
      const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, 0.2e-3 * static_cast<double>(n) / 1000.0));
      values.assign(frame.values.begin(), frame.values.end());
    }
    for (std::size_t k = 0; k < 20 && row >= 30; ++k) EXPECT_EQ(values[pac + k], 2102.0F) << row << ' ' << k;
    if (row == 0) {
      EXPECT_EQ(values[pac], 2048.0F) << "settled at the beginning";
    }
  }
}

TEST(BioTacSp, IsTheSameWhateverOtherSensorsThereAre) {
  const auto one = make({}, {"typical"}, 3), again = make({}, {"typical"}, 3), other = make({}, {"typical"}, 3, "other");
  std::size_t different = 0;
  for (int k = 0; k < 100; ++k) {
    const ContactFrame truth = evenly_dented(*one, 0.2e-3);
    const SensorFrame &a = one->measure(truth), &b = again->measure(truth), &c = other->measure(truth);
    for (std::size_t v = 0; v < a.values.size(); ++v) {
      ASSERT_EQ(a.values[v], b.values[v]);
      different += a.values[v] != c.values[v] ? 1U : 0U;
    }
  }
  EXPECT_GT(different, 1000U) << "another finger has its own gains and noise";
}

TEST(BioTacSp, TypicalElectronicsSpreadRestAndSensitivityByFingerAndTrial) {
  // offset: sd 0.02 of ln Z, new in each trial; gain: sd 0.1 of g, one device for all. The standard
  // error over 24 electrodes and 40 trials is 2.3 %.
  const auto rest_of = [](std::uint64_t trial) {
    const auto sensor = make(at_once_and({{"common", 0.0}}), {"offset"}, trial);
    std::vector<double> logs;
    const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, 0.0));
    for (std::size_t e = 0; e < electrodes; ++e)
      logs.push_back(std::log(impedance(static_cast<double>(frame.values[e])) / impedance(rest[e])));
    return logs;
  };
  double square = 0.0;
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    for (const double log : rest_of(trial)) square += log * log / (24.0 * 40.0);
  }
  EXPECT_NEAR(std::sqrt(square), 0.02, 5.0 * 0.023 * 0.02);

  const auto first = make(at_once(), {"gain"}, 0), second = make(at_once(), {"gain"}, 1), ideal = make(at_once());
  std::set<int> differences;
  for (std::size_t e = 0; e < electrodes; ++e) {
    EXPECT_EQ(read(*first, evenly_dented(*first, 0.5e-3), e), read(*second, evenly_dented(*second, 0.5e-3), e)) << "one device";
    differences.insert(
        static_cast<int>(read(*first, evenly_dented(*first, 0.5e-3), e) - read(*ideal, evenly_dented(*ideal, 0.5e-3), e)));
  }
  EXPECT_GT(differences.size(), 10U);
  const auto redrawn = make(at_once_and({{"device", std::string("redrawn")}}), {"gain"}, 1);
  std::size_t other = 0;
  for (std::size_t e = 0; e < electrodes; ++e) {
    other += read(*redrawn, evenly_dented(*redrawn, 0.5e-3), e) != read(*first, evenly_dented(*first, 0.5e-3), e) ? 1U : 0U;
  }
  EXPECT_GT(other, 15U);
}

TEST(BioTacSp, GoesOnFromItsMemory) {
  const auto lasting = make({}, {"typical"}), fresh = make({}, {"typical"});
  const auto truth = [&](int k) {
    ContactFrame frame = evenly_dented(*lasting, 0.3e-3 + 0.2e-3 * std::sin(0.01 * k));
    frame.stage_position = {1e-5 * (k / 150), 0.0, 0.0};
    return frame;
  };
  for (int k = 0; k < 333; ++k) lasting->measure(truth(k));
  const auto saved = lasting->memory(), loaded = fresh->memory();
  ASSERT_EQ(saved.size(), loaded.size());
  for (std::size_t m = 0; m < saved.size(); ++m) std::ranges::copy(saved[m], loaded[m].begin());
  for (int k = 333; k < 700; ++k) {
    const SensorFrame &a = lasting->measure(truth(k)), &b = fresh->measure(truth(k));
    // A sample is complete with cycle 9 of 10 and is then equal; the electrodes and pdc are equal
    // at any time.
    for (std::size_t v = 0; v < (k % 10 == 9 ? a.values.size() : pac); ++v) ASSERT_EQ(a.values[v], b.values[v]) << k << ' ' << v;
    ASSERT_EQ(lasting->paper_label(truth(k), false), fresh->paper_label(truth(k), false)) << k;
  }
}

TEST(PaperLabelOfTheBioTac, IsTheMotionOfTheBench) {
  // The stage moves at 1.8 mm/s from 25 to 55 ms. Its 9 um from 20 to 30 ms are not more than 10
  // um; its 18 um to 40 and to 50 ms are; its 9 um to 60 ms are not. The row that ends with cycle
  // 10 r + 9 reports this until the next row has ended.
  const auto sensor = make();
  for (int k = 0; k < 100; ++k) {
    const double t = (k + 1) / 1000.0;
    ContactFrame truth = evenly_dented(*sensor, 0.1e-3);
    truth.stage_position = {1.8e-3 * (std::clamp(t, 0.025, 0.055) - 0.025), 0.0, 0.0};
    sensor->measure(truth);
    ASSERT_EQ(sensor->paper_label(truth, false), k >= 39 && k < 59 ? PadState::gross : PadState::non_slip) << k;
    ASSERT_EQ(sensor->paper_label(truth, true), PadState::gross) << "a bench that turns";
    truth.state = PadState::no_contact;
    ASSERT_EQ(sensor->paper_label(truth, true), PadState::no_contact);
  }
}

TEST(BioTacScan, ReadsEachElectrodeInItsSlotAndHoldsIt) {
  // Cycle n has the slots 2n and 2n + 1, modulo 28. The skin sinks by 1 um per cycle, so that each
  // value shows when it was read: it equals the value of a finger that reads all electrodes at once
  // at that depth.
  const auto depth = [](std::size_t n) { return 1e-6 * static_cast<double>(n); };
  const auto sensor = make(), all = make(at_once());
  std::array<std::vector<float>, 71> at_once_at;
  for (std::size_t n = 0; n < at_once_at.size(); ++n) {
    const SensorFrame& frame = all->measure(evenly_dented(*all, depth(n)));
    at_once_at[n].assign(frame.values.begin(), frame.values.end());
  }
  ASSERT_EQ(sensor->scans(), 10U);
  std::size_t refreshed = 0;
  for (std::size_t n = 0; n < 70; ++n) {
    const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, depth(n)));
    if (n % 10 != 9) continue;
    for (std::size_t e = 0; e <= electrodes; ++e) {  // and pdc, in slot 24
      // The last cycle up to n with slot e; before the first one, the beginning of the trial.
      const std::size_t since = (n + 14 - e / 2) % 14;
      EXPECT_EQ(frame.values[e], since > n ? at_once_at[0][e] : at_once_at[n - since][e]) << n << ' ' << e;
      refreshed += e < electrodes && since < 10 ? 1U : 0U;
    }
  }
  // 7 rows are 5 rounds: 120 of 168 values are new, as in the recordings; 2/7 = 0.29 repeat, and
  // more if a new value happens to be equal.
  EXPECT_EQ(refreshed, 120U);
}

TEST(BioTacScan, SaysHowOldItsValuesAreInTheMean) {
  // Rows end with cycle 9, 5, 1, 11, 7, 3, 13 of a round, all odd: electrodes read in even cycles
  // are 1, 3 .. 13 ms old, those in odd cycles 0, 2 .. 12 ms, equally many of each: 6.5 ms. pdc in
  // cycle 12: 7 ms. pac: the middle of 20 readings, 9.5 times 0.5 ms before the last.
  const auto sensor = make();
  ASSERT_EQ(sensor->channels().size(), 3u);
  EXPECT_NEAR(sensor->channels()[0].age, 6.5e-3, 1e-12);
  EXPECT_NEAR(sensor->channels()[1].age, 7e-3, 1e-12);
  EXPECT_NEAR(sensor->channels()[2].age, 4.75e-3, 1e-12);
  EXPECT_EQ(sensor->channels()[0].size(), 24u);
  EXPECT_EQ(sensor->channels()[1].size(), 1u);
  EXPECT_EQ(sensor->channels()[2].size(), 20u);
  const auto ideal = make({{"scan", std::string("ideal")}});
  EXPECT_EQ(ideal->channels()[0].age, 0.0);
  EXPECT_EQ(ideal->channels()[1].age, 0.0);
  EXPECT_EQ(ideal->scans(), 10u) << "pac goes on";
}

TEST(BioTacScan, IdealReadsAllInTheLastCycleOfARow) {
  const auto ideal = make({{"scan", std::string("ideal")}}), all = make(at_once());
  for (std::size_t n = 0; n < 10; ++n) {
    const SensorFrame& frame = ideal->measure(evenly_dented(*ideal, 1e-5 * static_cast<double>(n)));
    const SensorFrame& expected = all->measure(evenly_dented(*all, n == 9 ? 0.9e-4 : 0.0));
    for (std::size_t e = 0; e <= electrodes; ++e) EXPECT_EQ(frame.values[e], expected.values[e]) << n << ' ' << e;
  }
}

TEST(BioTacScan, ATrialThatBeginsInContactBeginsWithItsValues) {
  // Row 0 ends before the turn of E21 to E24 and of pdc. Under a constant dent rows differ only by
  // noise, and row 0 has the noise of its round: held values equal those read in the next cycles.
  for (const std::vector<std::string>& electronics : {std::vector<std::string>{}, {"skewed_noise"}}) {
    const auto sensor = make({}, electronics);
    const ContactFrame truth = evenly_dented(*sensor, 0.2e-3);
    std::vector<float> row;
    for (std::size_t n = 0; n < 14; ++n) {
      const SensorFrame& frame = sensor->measure(truth);
      if (n == 0) row.assign(frame.values.begin(), frame.values.end());
      for (std::size_t v = 0; v <= pdc; ++v) ASSERT_EQ(frame.values[v], row[v]) << n << ' ' << v;
    }
    const auto all = make(at_once());
    const SensorFrame& expected = all->measure(truth);
    for (std::size_t v = 0; v <= pdc && electronics.empty(); ++v) EXPECT_EQ(row[v], expected.values[v]) << v;
  }
}

TEST(BioTacScan, NoiseIsDrawnOnceARefresh) {
  // Under a constant dent two rows differ only in the values refreshed in between.
  const auto sensor = make({}, {"skewed_noise"});
  const ContactFrame truth = evenly_dented(*sensor, 0.2e-3);
  std::vector<float> before;
  std::size_t changed = 0, kept = 0;
  for (std::size_t n = 0; n < 14 * 20 * 10; ++n) {
    const SensorFrame& frame = sensor->measure(truth);
    if (n % 10 != 9) continue;
    for (std::size_t e = 0; e < electrodes && n > 50; ++e) {
      if ((n + 14 - e / 2) % 14 < 10) {
        changed += frame.values[e] != before[e] ? 1U : 0U;
      } else {
        EXPECT_EQ(frame.values[e], before[e]) << n << ' ' << e;
        ++kept;
      }
    }
    before.assign(frame.values.begin(), frame.values.end());
  }
  // Two draws of sd 4 are equal after rounding with a probability of about 1/(2 sqrt(pi) 3.6) = 8 %
  // (8 to 12 % in the recordings). So 88 to 95 % of 4560 refreshed values change, with a standard
  // error of 0.4 %.
  const double share = static_cast<double>(changed) / static_cast<double>(24 * 275 - kept);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.95);
}

TEST(BioTacScan, NeedsAWholeNumberOfCyclesARow) {
  EXPECT_NO_THROW(make({{"rate", 500.0}}));
  EXPECT_NO_THROW(make({{"rate", 1000.0}}));
  for (const double rate : {300.0, 2000.0}) {
    const std::string said = refusal_of<SceneValueError>([&] { make({{"rate", rate}}); });
    EXPECT_THAT(said, HasSubstr("sensors.finger.cycle_rate: "));
    EXPECT_THAT(said, HasSubstr("the rate times a whole number"));
  }
}

}  // namespace
}  // namespace slipbench::biotac_sp_test
