#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <algorithm>
#include <cmath>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce::piezo_recordings_test {
namespace {

using slipbench::testing::make_record;
using ::testing::FloatNear;

// 400 samples of a skin at 10 kHz, three frames. With a slip it is in contact, and slips from sample 250 on.
TrialRecord skin_record(std::size_t trial, bool slips, const std::string& params) {
  TrialRecord record = make_record(trial, 400);
  SensorRecord& sensor = record.sensors[0];
  sensor.type = "piezo_skin";
  sensor.rate = 10e3;
  sensor.channel_names = {"signal"};
  sensor.channels = {{"signal", "1", {1}, slipbench::testing::ramp(400, 5.0F)}};
  for (std::size_t i = 0; i < 400; ++i) sensor.time[i] = 1e-4 * static_cast<double>(i);
  for (auto* states : {&sensor.labels.state, &sensor.labels.state_micro, &sensor.labels.state_paper})
    states->assign(400, slips ? 1 : 0);
  if (slips) std::fill(sensor.labels.state_micro.begin() + 250, sensor.labels.state_micro.end(), std::uint8_t{3});
  if (slips) std::fill(sensor.labels.state_paper.begin() + 350, sensor.labels.state_paper.end(), std::uint8_t{3});
  std::ranges::fill(sensor.labels.micro_onset_time, slips ? 0.025 : std::nan(""));
  record.params = params;
  return record;
}

class PiezoRecordings : public slipbench::testing::FolderTest {};

TEST_F(PiezoRecordings, SayWhatWasSwept) {
  slipbench::testing::write_dataset(
      path("a.h5"), {"1", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"},
      {skin_record(0, true,
                   R"({"motion.vibration": 0.5, "friction.static": 0.9, "motion.speed": 0.01, "effects": ["asperities"]})"),
       skin_record(1, false, R"({"motion.vibration": 4.0})")});
  const std::vector<PiezoRecording> recordings = read_recordings(path("a.h5"), {published_spectra(), signal_at_100_hz()});
  ASSERT_THAT(recordings, SizeIs(2));
  EXPECT_EQ(recordings[0].level, 0.5);
  EXPECT_EQ(recordings[0].tip, R"(friction.static=0.9 effects=["asperities"])");
  EXPECT_FALSE(recordings[0].motors_only);
  ASSERT_THAT(recordings[0].inputs, SizeIs(2));
  const PiezoFrames &spectra = recordings[0].inputs[0], &signal = recordings[0].inputs[1];
  EXPECT_THAT(spectra.truth, ElementsAre(0, 1, 1));  // frames end with samples 199, 299, 399
  EXPECT_THAT(spectra.paper, ElementsAre(0, 0, 1));
  EXPECT_THAT(spectra.features, SizeIs(3 * 12));
  EXPECT_THAT(spectra.by(train::LabelRule::paper).label, ElementsAre(0, 0, 1));
  EXPECT_THAT(signal.truth, ElementsAre(0, 0, 0, 1));  // samples 0, 100, 200, 300
  EXPECT_THAT(signal.features, SizeIs(4));
  EXPECT_THAT(recordings[0].time, ElementsAre(DoubleNear(0.0199, 1e-9), DoubleNear(0.0299, 1e-9), DoubleNear(0.0399, 1e-9)));
  EXPECT_THAT(recordings[0].contact, ElementsAre(1, 1, 1));
  EXPECT_NEAR(recordings[0].slip_time, 0.025, 1e-9);
  EXPECT_NEAR(recordings[0].label_time, 0.035, 1e-9);
  EXPECT_EQ(recordings[1].level, 4.0);
  EXPECT_EQ(recordings[1].tip, "");
  EXPECT_TRUE(recordings[1].motors_only);
  EXPECT_THAT(recordings[1].inputs[0].truth, ElementsAre(0, 0, 0));
  EXPECT_THAT(recordings[1].contact, ElementsAre(0, 0, 0));
  EXPECT_TRUE(std::isnan(recordings[1].slip_time) && std::isnan(recordings[1].label_time));
}

// The bench moves by 3 mm/s along the surface and 1 mm/s along the normal; from 0.03 s on a motor of 20 mm/s that moves nothing runs, too.
TEST_F(PiezoRecordings, SayWhichMotorsRun) {
  TrialRecord record = skin_record(0, true, R"({"motion.idle_speed": 0.02, "motion.idle_start": 0.03})");
  record.bodies = {{"pad", std::vector<float>(400 * 7), std::vector<float>(400 * 6)}};
  record.body_time = record.sensors[0].time;
  for (std::size_t i = 0; i < 400; ++i) {
    record.bodies[0].velocity[6 * i] = -3e-3F;
    record.bodies[0].velocity[6 * i + 2] = 1e-3F;
  }
  EXPECT_THAT(make_recording(record, {published_spectra()}).motors,
              ElementsAre(FloatNear(4e-3F, 1e-8F), FloatNear(4e-3F, 1e-8F), FloatNear(24e-3F, 1e-8F)));
}

// At 0.89 s the tip stands still: it is pressed on by then (0.6 mm at 0.7 mm/s), and slides from 0.9 s on or later. What runs is another motor.
TEST_F(PiezoRecordings, OtherMotorsRunOnlyWhereTheyAreAskedFor) {
  ReproduceOptions options;
  options.seed = 1;
  const auto running = [&](Motors motors) {
    std::size_t count = 0;
    for (const PiezoRecording& one : run_recordings({2.0}, 30, {signal_at_100_hz()}, options, motors)) {
      if (one.motors_only) continue;
      const auto frame = std::ranges::lower_bound(one.time, 0.89) - one.time.begin() - 1;
      if (one.motors.at(static_cast<std::size_t>(frame)) > 0.0F) ++count;
    }
    return count;
  };
  EXPECT_EQ(running(Motors::of_the_tip), 0U);
  EXPECT_GT(running(Motors::others_too), 0U);
}

TEST_F(PiezoRecordings, SurviveTheirBytes) {
  const std::vector<network::Input> inputs{published_spectra(), spectra_of(0.0, 5000.0)};
  const PiezoRecording first = make_recording(skin_record(0, true, R"({"effects": 3})"), inputs);
  EXPECT_TRUE(std::isnan(first.level));
  Packed bytes(Packed::bytes_of(first, make_recording(skin_record(1, false, "{}"), inputs)));
  const std::array back{bytes.take<PiezoRecording>(), bytes.take<PiezoRecording>()};
  EXPECT_TRUE(bytes.at_end());
  EXPECT_TRUE(std::isnan(back[0].level));
  EXPECT_EQ(back[0].tip, "effects=3");
  ASSERT_THAT(back[0].inputs, SizeIs(2));
  EXPECT_THAT(back[0].inputs[1].features, SizeIs(3 * 101));  // 0 to 5 kHz by 50 Hz
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(back[0].inputs[k].features, first.inputs[k].features);
    EXPECT_EQ(back[0].inputs[k].truth, first.inputs[k].truth);
    EXPECT_EQ(back[0].inputs[k].paper, first.inputs[k].paper);
  }
  EXPECT_EQ(back[0].slip_time, first.slip_time);
  EXPECT_EQ(back[0].label_time, first.label_time);
  EXPECT_EQ(back[0].time, first.time);
  EXPECT_EQ(back[0].contact, first.contact);
  EXPECT_EQ(back[0].motors, first.motors);
  EXPECT_FALSE(back[0].motors_only);
  EXPECT_TRUE(back[1].motors_only);
}

TEST_F(PiezoRecordings, OfOtherSensorsAreRefused) {
  EXPECT_THAT(refusal_of([] { make_recording(make_record(2, 400), {published_spectra()}); }),
              HasSubstr("trial 2: has no piezo_skin"));
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_recordings_test
