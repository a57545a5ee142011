// The curve of slip against hold from end to end, with few recordings.

#include <cmath>
#include <string>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/studies/piezo_fft_gru/piezo_networks.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::piezo_slip_against_hold_test {
namespace {

TEST(SlipAgainstHold, PrintsACurveWhosePartsAddUp) {
  ReproduceOptions options;
  options.trials = 4;
  options.jobs = 2;
  const Result result = find_reproduction("piezo-fft-gru/slip_against_hold").run(options);
  ASSERT_THAT(result.tables, SizeIs(5));
  for (const ResultTable& table : result.tables) {
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.head.size()) << table.title;
  }
  ASSERT_THAT(result.charts, SizeIs(1));
  for (const ResultCurve& curve : result.charts[0].curves) EXPECT_EQ(curve.points.size(), result.charts[0].places.size());

  const Json& levels = result.figures.at("curve").at("paper");
  ASSERT_THAT(levels, SizeIs(6));
  for (const auto& [level, areas] : levels.items()) {
    const Json &all = areas.at("pooled"), &contact = areas.at("contact"), &air = areas.at("air");
    // Slip is in each of the three, and a hold is in contact or in the air: the pooled area is the mean of both by their frames.
    EXPECT_EQ(all.at("slip_frames"), contact.at("slip_frames"));
    const double n = contact.at("hold_frames").get<double>(), m = air.at("hold_frames").get<double>();
    EXPECT_EQ(all.at("hold_frames").get<double>(), n + m);
    EXPECT_NEAR(all.at("auc").get<double>(), (n * contact.at("auc").get<double>() + m * air.at("auc").get<double>()) / (n + m),
                1e-12);
  }
  for (const char* causes : {"hold_causes", "slip_causes"}) {
    double frames = 0.0, share = 0.0, missing = 0.0, missing_hann = 0.0;
    for (const auto& [name, cause] : result.figures.at(causes).items()) {
      frames += cause.at("frames").get<double>();
      share += cause.at("share").get<double>();
      missing += cause.at("paper").at("share_of_missing").get<double>();
      missing_hann += cause.at("hann").at("share_of_missing").get<double>();
    }
    const char* counted = std::string(causes) == "hold_causes" ? "hold_frames" : "slip_frames";
    EXPECT_EQ(frames, levels.at("0").at("contact").at(counted).get<double>()) << causes;
    EXPECT_NEAR(share, 1.0, 1e-9) << causes;
    EXPECT_NEAR(missing, 1.0, 1e-9) << causes;
    EXPECT_NEAR(missing_hann, 1.0, 1e-9) << causes;
  }
}

TEST(SlipAgainstHold, NeedsTwoRecordingsOfEachKindAndAsManyOfBoth) {
  ReproduceOptions options;
  for (const std::size_t trials : {2U, 5U}) {  // of five, four would be run
    options.trials = trials;
    EXPECT_THAT(refusal_of([&] { find_reproduction("piezo-fft-gru/slip_against_hold").run(options); }),
                EndsWith("allowed: even numbers, 4 or more"))
        << trials;
  }
}

const double nan = std::nan("");
const std::vector<double> time{0.01, 0.02, 0.03, 0.04, 0.05, 0.06};  // s
using Calls = std::vector<std::uint8_t>;

TEST(AlarmDelay, IsOfTheAlarmThatIsOnOrTheNext) {
  EXPECT_NEAR(alarm_delay(time, Calls{1, 0, 0, 0, 1, 1}, 0.025), 0.025, 1e-12) << "the one of 0.01 is over";
  EXPECT_NEAR(alarm_delay(time, Calls{0, 1, 1, 1, 0, 1}, 0.042), -0.022, 1e-12) << "on since 0.02";
  EXPECT_NEAR(alarm_delay(time, Calls{1, 1, 1, 1, 0, 1}, 0.042), -0.032, 1e-12) << "on since the first frame";
  EXPECT_NEAR(alarm_delay(time, Calls{0, 0, 0, 1, 0, 0}, 0.04), 0.0, 1e-12);
  EXPECT_NEAR(alarm_delay(time, Calls{0, 1, 0, 0, 0, 0}, 0.001), 0.019, 1e-12) << "no frame is complete yet";
  EXPECT_TRUE(std::isnan(alarm_delay(time, Calls{1, 1, 0, 0, 0, 0}, 0.03)));
  EXPECT_TRUE(std::isnan(alarm_delay(time, Calls{0, 0, 0, 0, 0, 0}, 0.03)));
}

TEST(Alarms, AreCountedByBothRules) {
  Alarms alarms;
  alarms.add(time, Calls{1, 0, 0, 0, 1, 1}, 0.025);  // early by its first alarm, 25 ms by the next
  alarms.add(time, Calls{0, 0, 0, 1, 1, 1}, 0.025);  // 15 ms by both
  alarms.add(time, Calls{0, 0, 0, 0, 0, 0}, 0.025);  // missed, silent
  alarms.add(time, Calls{0, 0, 1, 0, 0, 0}, nan);    // a false alarm
  EXPECT_EQ(alarms.first.early, 1U);
  EXPECT_EQ(alarms.first.missed, 1U);
  EXPECT_EQ(alarms.first.false_alarms, 1U);
  EXPECT_EQ(alarms.first.slipping, 3U);
  EXPECT_EQ(alarms.silent, 1U);
  EXPECT_THAT(alarms.first.delay, ElementsAre(DoubleNear(0.015, 1e-12)));
  EXPECT_THAT(alarms.near, ElementsAre(DoubleNear(0.025, 1e-12), DoubleNear(0.015, 1e-12)));
}

// Of 0 to 10 ms the 10 % quantile is 1 ms and the 90 % one 9 ms; the variance of n = 11 whole numbers is n (n + 1)/12 = 11.
TEST(DelaySpread, IsInClosedForm) {
  std::vector<double> times;
  for (int k = 10; k >= 0; --k) times.push_back(1e-3 * k);
  const DelaySpread spread = delay_spread(times);
  EXPECT_NEAR(spread.mean, 5e-3, 1e-12);
  EXPECT_NEAR(spread.sd, 1e-3 * std::sqrt(11.0), 1e-12);
  EXPECT_NEAR(spread.median, 5e-3, 1e-12);
  EXPECT_NEAR(spread.p10, 1e-3, 1e-12);
  EXPECT_NEAR(spread.p90, 9e-3, 1e-12);
  EXPECT_NEAR(spread.greatest, 10e-3, 1e-12);
  EXPECT_EQ(cell(spread), "5 (1 to 9)");
  EXPECT_EQ(cell(delay_spread({})), "-");
}

}  // namespace

}  // namespace slipbench::reproduce::piezo_slip_against_hold_test
