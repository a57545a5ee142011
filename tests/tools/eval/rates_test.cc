// One simulated scene, seen by the same sensor at several rates, judged by a shipped network.
#include <cmath>

#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/metrics.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::eval {
namespace {

struct Rates : ::slipbench::testing::FolderTest {
  // The training scene of a network with its sensor at another rate, and a seed of its own. `draws`: of
  // each cell.
  std::string dataset(const std::string& scene, const std::string& rate, std::size_t draws) {
    SweepOptions options;
    options.scene_path = SLIPBENCH_SOURCE_DIR "/scenes/learn/" + scene;
    options.overrides = {{"sensors.pad.rate", rate}, {"time_step", "auto"}};
    options.trials = draws;
    options.seed = 987;
    options.jobs = 2;
    options.output = path(rate + ".h5");
    run_sweep(options, program_catalogues());
    return options.output;
  }
};

// Balanced accuracy of slip and no slip over all samples. `jitter`: of the stamps, in steps; in the
// middle of each trial one step is longer by .59.
double balanced_accuracy(const std::string& file, const std::string& network, double jitter) {
  const DatasetReader reader(file);
  const DetectorScene detector = chosen_detector(network, {});
  std::vector<Judgement> judgements;
  for (const std::size_t trial : reader.trials()) {
    TrialRecord record = reader.read_trial(trial);
    const Scene scene = recorded_scene(recorded_file(reader), record, program_catalogues());
    const Truth truth = truth_of(&scene, record, record.sensors[0], LabelRule::masked);
    SensorRecord& sensor = record.sensors[0];
    RandomStream random(5, trial, "jitter");
    for (std::size_t k = 1; jitter > 0.0 && k < sensor.time.size(); ++k)
      sensor.time[k] += (jitter * (2.0 * random.uniform() - 1.0) + (2 * k > sensor.time.size() ? 0.59 : 0.0)) / sensor.rate;
    judgements.push_back(judged(trial, truth, replay(detector, record.sensors, 0, record.seed, trial)));
  }
  return summary_json(summarised(judgements, false)).at("figures").at("balanced_slip_accuracy").at("value").get<double>();
}

// The sensor's noise is drawn anew at each rate. On 480 trials that changes the figure by some .3
// points (on 75 by 1); the bar is 1 point.
constexpr double bar = 0.01;

TEST_F(Rates, JudgeASkinAlike) {
  const std::string network = SLIPBENCH_SOURCE_DIR "/scenes/learn/magnetic_skin_slip.onnx", scene = "magnetic_skin.yaml";
  const std::string at_own = dataset(scene, "100 Hz", 32);
  const double own = balanced_accuracy(at_own, network, 0.0);
  EXPECT_GT(own, 0.8);
  EXPECT_NEAR(balanced_accuracy(at_own, network, 0.01), own, bar) << "with jitter";
  const std::string faster = dataset(scene, "150 Hz", 32);
  for (const double jitter : {0.0, 0.01}) EXPECT_NEAR(balanced_accuracy(faster, network, jitter), own, bar) << jitter;
  EXPECT_NEAR(balanced_accuracy(dataset(scene, "1 kHz", 32), network, 0.01), own, bar);
}

// papillarray_slip.onnx reads one sample in ten of 1 kHz, which is also all of 100 Hz.
TEST_F(Rates, JudgeAPapillArrayAlike) {
  const std::string network = SLIPBENCH_SOURCE_DIR "/scenes/learn/papillarray_slip.onnx", scene = "papillarray.yaml";
  const double own = balanced_accuracy(dataset(scene, "1 kHz", 20), network, 0.0);
  EXPECT_GT(own, 0.8);
  for (const char* rate : {"100 Hz", "250 Hz"})
    EXPECT_NEAR(balanced_accuracy(dataset(scene, rate, 20), network, 0.01), own, bar) << rate;
}

}  // namespace
}  // namespace slipbench::eval
