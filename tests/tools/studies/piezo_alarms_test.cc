// Delays of frames that were called by hand.
#include "tools/studies/piezo_fft_gru/piezo_delay.h"

#include <cmath>

#include "tests/expect.h"

namespace slipbench::reproduce::piezo_alarms_test {
namespace {

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
}  // namespace slipbench::reproduce::piezo_alarms_test
