// When each electrode is read: the round of 28 slots, two a cycle, held, in a log of 10 cycles a row.

#include "tests/expect.h"
#include "tests/sensors/biotac_sp/rig.h"

namespace slipbench::biotac_sp_test {
namespace {

TEST(BioTacScan, ReadsEachElectrodeInItsSlotAndHoldsIt) {
  // Cycle n has the slots 2n and 2n + 1, modulo 28. The skin sinks by 1 um a cycle, so that each value tells when it was read: it is that of a finger which reads all
  // at once at that depth.
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
      // The last cycle up to n with slot e; before the first: as the trial began.
      const std::size_t since = (n + 14 - e / 2) % 14;
      EXPECT_EQ(frame.values[e], since > n ? at_once_at[0][e] : at_once_at[n - since][e]) << n << ' ' << e;
      refreshed += e < electrodes && since < 10 ? 1U : 0U;
    }
  }
  // 7 rows are 5 rounds: 120 of 168 values are new, as in the recordings; 2/7 = 0.29 repeat, and more where a new one happens to be equal.
  EXPECT_EQ(refreshed, 120U);
}

TEST(BioTacScan, SaysHowOldItsValuesAreInTheMean) {
  // Rows end with cycle 9, 5, 1, 11, 7, 3, 13 of a round, odd ones: electrodes in even cycles are 1, 3 .. 13 ms old, those in odd ones 0, 2 .. 12, and
  // there are as many of either: 6.5 ms. pdc in cycle 12: 7 ms. pac: the middle of 20 readings, 9.5 of 0.5 ms before the last.
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
  // Row 0 ends before the turn of E21 to E24 and of pdc; under a dent that stands still no row differs from the next but by noise, and row 0
  // has that of its round: what was held and what is read in the next cycles are the same.
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
  // Under a dent that stands still two rows differ in what has been refreshed in between, and in nothing else.
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
  // Two draws of sd 4 are equal when rounded with a probability of about 1/(2 sqrt(pi) 3.6) = 8 % (the recordings have 8 to 12 %): so 88 to 95 % of
  // 4560 refreshed values change, with a standard error of 0.4 %.
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
