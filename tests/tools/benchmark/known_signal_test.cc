// A detector that knows the signal of a slip, against the closed form of a step in white noise.
#include "tools/benchmark/known_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sim/core/random.h"

namespace slipbench::benchmark {
namespace {

constexpr std::size_t rows = 2000, touches = 500, slips = 1500;
constexpr double rate = 1000.0, deviation = 0.1;

TrialRecord recorded(double step) {
  RandomStream random(7, 0, "known signal");
  TrialRecord record;
  SensorRecord& sensor = record.sensors.emplace_back();
  sensor.rate = rate;
  SensorColumn& column = sensor.channels.emplace_back(SensorColumn{.name = "signal", .unit = "V", .shape = {1}, .values = {}});
  for (std::size_t row = 0; row < rows; ++row) {
    sensor.time.push_back(static_cast<double>(row) / rate);
    column.values.push_back(static_cast<float>(deviation * random.normal() + (row >= slips ? step : 0.0)));
  }
  return record;
}

eval::Truth truth_of(const TrialRecord& record) {
  eval::Truth truth;
  truth.time = record.sensors[0].time;
  truth.state.assign(rows, PadState::no_contact);
  for (std::size_t row = touches; row < rows; ++row) truth.state[row] = row < slips ? PadState::non_slip : PadState::gross;
  truth.first_slip = static_cast<double>(slips) / rate;
  return truth;
}

// A step of half a deviation adds 1/4 a sample, so the 9 of three deviations are reached by 36
// samples. Both estimates scatter. The deviation of n independent values scatters by 1.17/sqrt(n)
// [rousseeuw1993]; 1,500 second differences, which correlate by -2/3 and 1/6, by some
// sqrt(1 + 2 (4/9 + 1/36)) times that, which is 4.2 %. The correlation of 500 samples, which is 0,
// scatters by 0.045, so that up to (1 - 0.09)^2 of the energy is left: 36 (1 - 0.084) to
// 36 (1 + 0.084)/0.83, which are 33 to 47 samples.
TEST(SignalKnown, SeesAStepWhenItsEnergyIsThatOfThreeDeviations) {
  const TrialRecord record = recorded(0.5 * deviation), stuck = recorded(0.0);
  const eval::Truth truth = truth_of(record);
  const eval::Replayed seen = signal_known(record, stuck, 0, truth);
  std::size_t first = 0;
  while (first < rows && seen.seen[first] != PadState::gross) ++first;
  EXPECT_GE(first, slips + 33 - 1);
  EXPECT_LE(first, slips + 47 - 1);
}

// A ramp of 500 deviations and a level of 50 on both trials are the load, not noise: the slip is
// seen in the same sample.
TEST(SignalKnown, DoesNotTakeTheLoadForNoise) {
  const auto first_of = [](double ramp, double level) {
    TrialRecord record = recorded(0.5 * deviation), stuck = recorded(0.0);
    for (TrialRecord* one : {&record, &stuck}) {
      std::vector<float>& values = one->sensors[0].channels[0].values;
      for (std::size_t row = touches; row < rows; ++row)
        values[row] += static_cast<float>(level + ramp * static_cast<double>(row - touches) / static_cast<double>(rows));
    }
    const eval::Replayed seen = signal_known(record, stuck, 0, truth_of(record));
    return static_cast<double>(std::ranges::find(seen.seen, PadState::gross) - seen.seen.begin());
  };
  EXPECT_NEAR(first_of(500.0 * deviation, 50.0 * deviation), first_of(0.0, 0.0), 1);
}

TEST(SignalKnown, SaysNothingWhereTheSlipChangesNothing) {
  const TrialRecord record = recorded(0.0);
  for (const PadState state : signal_known(record, record, 0, truth_of(record)).seen) EXPECT_EQ(state, PadState::non_slip);
}

// The signal that an earlier slip has left, here 5 deviations from the middle of the contact on,
// does not count as the signal of the judged slip.
TEST(SignalKnown, LeavesOutWhatAnEarlierSlipHasLeft) {
  TrialRecord record = recorded(0.0);
  std::vector<float>& values = record.sensors[0].channels[0].values;
  for (std::size_t row = (touches + slips) / 2; row < rows; ++row) values[row] += static_cast<float>(5.0 * deviation);
  for (const PadState state : signal_known(record, recorded(0.0), 0, truth_of(record)).seen) EXPECT_EQ(state, PadState::non_slip);
}

}  // namespace
}  // namespace slipbench::benchmark
