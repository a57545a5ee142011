// Replays the loop of a grasp from its recording alone.
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/tools/dataset/record/test_records.h"
#include "tests/tools/eval/loop_scene.h"
#include "tools/dataset/reader.h"
#include "tools/eval/evaluate.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::eval::testing {
namespace {

using ::slipbench::testing::FolderTest;

struct GraspReplay : FolderTest {
  // Three boxes, one of them too heavy for the grip.
  std::string dataset(const std::string& detector) {
    std::ofstream(path("scene.yaml")) << "slipbench: 1\nseed: 2\nsurface: {material: ptfe}\nduration: 5 s\n"
                                         "sensors: {pad: {type: papillarray, rate: 100 Hz}}\ncontroller: {type: step_on_slip}\n"
                                         "sweep: {box.mass: [0.1 kg, 0.5 kg, 2 kg]}\ndetector: "
                                      << detector << "\n";
    SweepOptions options;
    options.scene_path = path("scene.yaml");
    options.jobs = 2;
    options.output = path("grasps.h5");
    run_sweep(options, program_catalogues());
    return options.output;
  }
};

TEST_F(GraspReplay, GivesTheLoopsClassesAndOutcomesAgain) {
  for (const char* detector : {"{type: gst_hd}", "{type: force_ratio, ratio: 0.15}"}) {
    SCOPED_TRACE(detector);
    const std::string file = dataset(detector);
    const DatasetReader reader(file);
    const Scene scene =
        parsed("slipbench: 1\nsensors: {pad: {type: papillarray, rate: 100 Hz}}\ndetector: " + std::string(detector) + "\n");
    std::size_t judged_by = 0;
    for (const std::size_t trial : reader.trials()) {
      SCOPED_TRACE(trial);
      const TrialRecord record = reader.read_trial(trial);
      const Replayed replayed = expect_same_as_loop(scene, record);
      const Scene own = recorded_scene(recorded_file(reader), record, program_catalogues());
      const Judgement judgement = judged(trial, truth_of(&own, record, record.sensors[0], LabelRule::strict), replayed);
      const TrialOutcome& outcome = record.outcome;
      EXPECT_EQ(judgement.detection, outcome.detection.value());
      EXPECT_EQ(std::isnan(judgement.slip_time), std::isnan(outcome.judged_slip_time));
      if (std::isnan(outcome.judged_slip_time)) continue;
      ++judged_by;
      EXPECT_EQ(judgement.slip_time, outcome.judged_slip_time);
      EXPECT_EQ(judgement.frames, record.control->confusion);
      // The loop runs at every tick, the recording has every sample.
      if (outcome.detection == Detection::seen) {
        EXPECT_NEAR(judgement.delay, outcome.detection_delay, 0.01);
      }
    }
    EXPECT_GT(judged_by, 0U);
  }
}

TEST_F(GraspReplay, LoopFiguresAreThoseOfThisDetectorAlone) {
  Options options;
  options.dataset = dataset("{type: force_ratio, ratio: 0.15}");
  options.detector =
      *parsed("slipbench: 1\nsensors: {pad: {type: papillarray}}\ndetector: {type: force_ratio, ratio: 0.15}\n").detector;
  const Json own = evaluate(options);
  EXPECT_TRUE(own.at("loop").at("same").get<bool>());
  EXPECT_EQ(own.at("loop").at("trials"), 3);
  std::size_t dropped = 0;
  for (const std::size_t trial : {0U, 1U, 2U})
    dropped += DatasetReader(options.dataset).read_trial(trial).outcome.grasp->dropped ? 1U : 0U;
  EXPECT_EQ(own.at("loop").at("dropped"), dropped);
  options.detector =
      *parsed("slipbench: 1\nsensors: {pad: {type: papillarray}}\ndetector: {type: force_ratio, ratio: 0.3}\n").detector;
  const Json other = evaluate(options);
  EXPECT_FALSE(other.at("loop").at("same").get<bool>());
  EXPECT_FALSE(other.at("loop").contains("dropped"));
}

}  // namespace
}  // namespace slipbench::eval::testing
