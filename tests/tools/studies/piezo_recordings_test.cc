#include "tools/studies/piezo_fft_gru/piezo_recordings.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "sim/core/random.h"
#include "tests/tools/base/dataset/test_records.h"
#include "tools/base/dataset/writer.h"

namespace slipbench::reproduce::piezo_recordings_test {
namespace {

using slipbench::testing::make_record;
using slipbench::testing::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

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
  record.params = params;
  return record;
}

class PiezoRecordings : public slipbench::testing::FolderTest {};

TEST_F(PiezoRecordings, SayWhatWasSwept) {
  DatasetWriter writer(path("a.h5"), {"1", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"}, 2);
  writer.append(TrialEncoder().encode(skin_record(
      0, true, R"({"motion.vibration": 0.5, "friction.static": 0.9, "motion.speed": 0.01, "effects": ["asperities"]})")));
  writer.append(TrialEncoder().encode(skin_record(1, false, R"({"motion.vibration": 4.0})")));
  writer.commit();
  const std::vector<PiezoRecording> recordings = read_recordings(path("a.h5"));
  ASSERT_THAT(recordings, SizeIs(2));
  EXPECT_EQ(recordings[0].level, 0.5);
  EXPECT_EQ(recordings[0].tip, R"(friction.static=0.9 effects=["asperities"])");
  EXPECT_FALSE(recordings[0].motors_only);
  EXPECT_THAT(recordings[0].truth, ElementsAre(0, 1, 1));  // frames end with samples 199, 299, 399
  EXPECT_THAT(recordings[0].paper, ElementsAre(0, 0, 1));
  EXPECT_THAT(recordings[0].features, SizeIs(3 * 12));
  EXPECT_THAT(recordings[0].frames(learn::LabelRule::paper).slip, ElementsAre(0, 0, 1));
  EXPECT_EQ(recordings[1].level, 4.0);
  EXPECT_EQ(recordings[1].tip, "");
  EXPECT_TRUE(recordings[1].motors_only);
  EXPECT_THAT(recordings[1].truth, ElementsAre(0, 0, 0));
}

TEST_F(PiezoRecordings, SurviveTheirBytes) {
  const PiezoRecording first = make_recording(skin_record(0, true, R"({"effects": 3})"));
  EXPECT_TRUE(std::isnan(first.level));
  std::string bytes;
  pack(first, bytes);
  pack(make_recording(skin_record(1, false, "{}")), bytes);
  const std::vector<PiezoRecording> back = unpack(bytes);
  ASSERT_THAT(back, SizeIs(2));
  EXPECT_TRUE(std::isnan(back[0].level));
  EXPECT_EQ(back[0].tip, "effects=3");
  EXPECT_EQ(back[0].features, first.features);
  EXPECT_EQ(back[0].truth, first.truth);
  EXPECT_EQ(back[0].paper, first.paper);
  EXPECT_FALSE(back[0].motors_only);
  EXPECT_TRUE(back[1].motors_only);
}

TEST_F(PiezoRecordings, OfOtherSensorsAreRefused) {
  EXPECT_THAT(message_of<InputError>([] { make_recording(make_record(2, 400)); }), HasSubstr("trial 2: has no piezo_skin"));
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_recordings_test
