// Tests use a part of the protocol, one trial or some trials of each scene, because the whole takes
// minutes.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/board_page.h"
#include "tools/benchmark/control.h"
#include "tools/benchmark/entrants.h"
#include "tools/benchmark/known_signal.h"
#include "tools/benchmark/protocol.h"
#include "tools/benchmark/submission.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"
#include "tools/eval/yardsticks.h"
#include "tools/files/project/project_file.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::benchmark {
namespace {

Json board(const std::string& sensor, std::size_t trials, std::size_t jobs, const std::string& flip = "") {
  Options options;
  options.request.sensor = sensor;
  options.request.trials = trials;
  options.jobs = jobs;
  if (!flip.empty()) {
    options.request.detectors = {"shear_rate", "force_ratio"};
    options.request.parameters = {{"flip", flip}};
  }
  return benchmark(options);
}

const Json& row_of(const Json& set, const std::string& detector) {
  return *std::ranges::find_if(set.at("rows"), [&](const Json& row) { return row.at("detector") == detector; });
}
double score(const Json& set, const std::string& detector) { return row_of(set, detector).at("score").at("value").get<double>(); }

bool is_yardstick(const std::string& detector) {
  const std::vector<DetectorScene> all = eval::yardsticks();
  return std::ranges::find(all, detector, &DetectorScene::type) != all.end();
}

TEST(Board, HasEveryDetectorInEveryTrackOfItsSensor) {
  const Json result = board("", 1, 2);
  std::map<std::string, std::set<std::string>> tracks;  // by detector
  for (const Json& set : result.at("sets")) {
    SCOPED_TRACE(set.at("scene"));
    std::set<std::string> here;
    for (const Json& row : set.at("rows")) {
      here.insert(row.at("detector"));
      tracks[row.at("detector")].insert(set.at("track"));
    }
    // Detectors that are not on the board are named with the reason.
    for (const Json& one : set.at("left_out")) EXPECT_NE(one.at("why"), "");
    if (set.contains("disturbance")) continue;
    for (const char* control : {"always slip", "never slip", "motion known"}) EXPECT_TRUE(here.contains(control)) << control;
    EXPECT_EQ(score(set, "never slip"), 0.0);
    // No detector scores less than the one that always reports slip. Oracle and known signal have no rank.
    EXPECT_EQ(set.at("rows").back().at("score"), row_of(set, "always slip").at("score"));
    EXPECT_EQ(set.at("rows").back().at("rank"), row_of(set, "always slip").at("rank"));
  }
  for (const Entry& entry : detector_entries()) {
    if (std::set<std::string>{"network", "plugin", "truth"}.contains(entry.name)) continue;
    if (is_yardstick(entry.name)) continue;
    EXPECT_EQ(tracks[entry.name], (std::set<std::string>{"open recordings", "closed loop"})) << entry.name;
  }
  EXPECT_EQ(result.at("protocol").at("whole"), false);
  EXPECT_NE(result.at("transfer"), "");
}

// In the first open recordings of a sensor every yardstick chooses its thresholds, one for each
// half of the trials; the best of them enters the other sets with one threshold.
TEST(Board, HasTheBestYardstickInEverySet) {
  const Json result = board("papillarray", 4, 2);
  std::string best;
  for (const Json& set : result.at("sets")) {
    SCOPED_TRACE(set.at("scene"));
    std::vector<const Json*> rows;
    for (const Json& row : set.at("rows")) {
      if (row.at("kind") == "yardstick") rows.push_back(&row);
    }
    if (best.empty()) {
      EXPECT_EQ(rows.size(), eval::yardsticks().size());
      for (const Json* row : rows) EXPECT_EQ(row->at("thresholds").size(), 2U);
      best = rows.front()->at("detector");
      continue;
    }
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0]->at("detector"), best);
    EXPECT_FALSE(rows[0]->contains("thresholds"));
    EXPECT_TRUE(rows[0]->at("parameters").contains("threshold"));
  }
  EXPECT_THAT(board_page(result), mentions({"yardstick", best}));
}

// One half of two trials is empty, so one threshold is chosen on both.
TEST(Board, YardsticksOfOneHalfHaveOneThreshold) {
  const Json result = board("taxels", 2, 2);
  for (const Json& row : result.at("sets").at(0).at("rows")) {
    if (row.at("kind") != "yardstick") continue;
    EXPECT_EQ(row.at("thresholds").size(), 1U) << row.at("detector");
  }
}

// Four a decade from 1e4 down to 1e-8: 4 (4 + 8) + 1 factors.
TEST(Board, ThresholdsOfYardsticksSpanTwelveDecades) {
  const std::vector<double> factors = threshold_factors();
  ASSERT_EQ(factors.size(), 49U);
  EXPECT_NEAR(factors.front(), 1e4, 1e-8);
  EXPECT_NEAR(factors[16], 1.0, 1e-15);
  EXPECT_NEAR(factors.back() * 1e8, 1.0, 1e-12);
  EXPECT_TRUE(std::ranges::is_sorted(factors, std::greater{}));
}

// The oracle detects each slip at its instant, the control that never reports slip has no false
// alarm, and a detector that knows more than a sensor can tell has no rank.
TEST(Board, HasItsMeasures) {
  const Json result = board("taxels", 3, 2);
  std::set<std::string> disturbances;
  for (const Json& set : result.at("sets")) {
    SCOPED_TRACE(set.at("scene"));
    if (set.at("track") != "open recordings") continue;
    EXPECT_EQ(score(set, "oracle"), 1.0);
    EXPECT_TRUE(row_of(set, "oracle").at("rank").is_null());
    if (set.contains("disturbance")) {
      disturbances.insert(set.at("disturbance"));
      EXPECT_EQ(score(set, "never slip"), 1.0);
      EXPECT_EQ(score(set, "always slip"), 0.0);
      for (const Json& row : set.at("rows")) EXPECT_TRUE(row.at("rank").is_null()) << row.at("detector");
      EXPECT_GT(row_of(set, "never slip").at("judged").get<std::size_t>(), 0U);
    } else {
      EXPECT_EQ(score(set, "never slip"), 0.0);
      const Json& known = row_of(set, "signal known");
      EXPECT_EQ(known.at("false_alarms_per_minute"), 0.0);
      EXPECT_TRUE(known.at("rank").is_null());
    }
  }
  EXPECT_EQ(disturbances, (std::set<std::string>{"grip", "hand", "knock", "load", "motor"}));
  EXPECT_THAT(board_page(result), mentions({"Specificity", "knock", "Score by sensor", "signal known",
                                            "detectors of other sensors: ", "taxels: no public recordings"}));
}

// The result is byte-identical with one thread and with two.
TEST(Board, SameBytesWhateverTheThreads) {
  const Json one = board("taxels", 2, 1);
  EXPECT_EQ(submission_text(one), submission_text(board("taxels", 2, 2)));
  // Grasps 0 and 36 of the 72 are the first of the twelve boxes, which have six trials each, and the
  // seventh.
  const Json& by = one.at("sets").back().at("by");
  const auto masses = std::ranges::find_if(by, [](const Json& axis) { return axis.at("by") == "box.mass"; });
  ASSERT_NE(masses, by.end());
  std::vector<std::string> names;
  for (const Json& group : masses->at("groups")) names.push_back(group.at("name"));
  EXPECT_EQ(names, (std::vector<std::string>{"229 g", "305 g"}));
}

// Detectors with 1 and 20 % of their answers flipped, in addition to the included ones without
// flips. Under a disturbance the first flip already costs all of the score. In four grasps only many
// flips are sure to cost.
TEST(Board, FlipsLowerTheScore) {
  std::map<std::string, double> before;  // by scene and detector
  for (const std::string flip : {"0.01", "0.2"}) {
    const Json flipped = board("papillarray", 4, 2, flip);
    for (const Json& set : flipped.at("sets")) {
      if (set.contains("disturbance")) continue;
      for (const char* detector : {"shear_rate", "force_ratio"}) {
        const double unflipped = score(set, detector), now = score(set, fmt::format("{}, given", detector));
        double& last = before.try_emplace(set.at("scene").get<std::string>() + detector, unflipped).first->second;
        if (set.at("track") == "closed loop" && flip == "0.2") {
          EXPECT_LT(now, unflipped) << detector;
        }
        // An open recording has at most one false alarm to lose.
        if (set.at("track") != "closed loop") {
          EXPECT_LE(now, last) << detector << " with flip " << flip << ", " << set.at("scene");
        }
        last = now;
      }
    }
  }
}

// The truth of a recording without its samples, which would not fit into memory for all trials of a
// set.
struct TruthOfTrial {
  Scene scene;
  eval::Truth truth;
};

std::vector<TruthOfTrial> all_truths(const TestSet& test_set) {
  const Catalogues catalogues = program_catalogues();
  SweepOptions options;
  options.scene_path = project_file(test_set.scene);
  const ReadSweep read = read_sweep(options, catalogues);
  std::vector<TruthOfTrial> truths;
  for (std::size_t k = 0; k < read.planned.plan.size(); ++k) {
    Scene scene = read.planned.plan.trial(k).scene;
    std::erase_if(scene.sensors, [&](const SensorScene& sensor) { return sensor.name != test_set.readers.front(); });
    const TrialRecord record = run_trial(scene, k, Recording::full).record;
    eval::Truth truth = eval::truth_of(&scene, record, record.sensors.front(), LabelRule::masked, judged_from(test_set, scene));
    truths.push_back({std::move(scene), std::move(truth)});
  }
  return truths;
}

TestSet open_set(const std::string& sensor, const std::string& domain) {
  const std::vector<TestSet> held_out = find_protocol(default_protocol, "test").held_out;
  return *std::ranges::find_if(held_out, [&](const TestSet& one) { return one.sensor == sensor && one.domain == domain; });
}

// The score of a rule that reports slip `delay` [s] after the beginning of each motion.
double score_of_clock(const TestSet& test_set, const std::vector<TruthOfTrial>& trials, double delay) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const auto& [scene, truth] = trials[k];
    eval::Replayed replayed = no_reports(truth);
    const double from = motion_known(test_set, scene).from + delay;
    const auto row = static_cast<std::size_t>(std::ranges::lower_bound(truth.time, from) - truth.time.begin());
    if (row < replayed.seen.size()) replayed.seen[row] = PadState::gross;
    parts.push_back(recording_part(eval::judged(k, truth, replayed, truth.period), test_set));
  }
  return score_of(parts, test_set).value;
}

// The first recording of each pair has no slip, the second one has, and both have one motion. So a
// rule that knows the motion alone reports slip in both or in none, and loses at least what it earns.
TEST(Protocol, Pairs) {
  for (const auto& [sensor, domain] : {std::pair{"taxels", "inside"}, {"papillarray", "outside"}}) {
    SCOPED_TRACE(sensor);
    const TestSet test_set = open_set(sensor, domain);
    const std::vector<TruthOfTrial> trials = all_truths(test_set);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      EXPECT_EQ(std::isnan(trials[k].truth.first_slip), k % 2 == 0) << "trial " << k;
      const Parameters &motion = trials[k].scene.motion.parameters, &twin = trials[k ^ 1U].scene.motion.parameters;
      for (const char* name :
           {"start", "direction", "speed", "acceleration", "travel", "rotation", "angular_acceleration", "stop", "compression"})
        EXPECT_EQ(motion.number(name), twin.number(name)) << name << " of trial " << k;
    }
    for (int step = 0; step <= 40; ++step) EXPECT_LE(score_of_clock(test_set, trials, 0.02 * step), 0.0) << step;
  }
}

TEST(Protocol, SharesNoSeedWithWhatIsLearntFrom) {
  const auto seed = [](const std::string& scene) { return SceneFile::load(project_file(scene)).root().find("seed")->text; };
  std::set<std::string> learnt;
  for (const char* scene : {"grasp/learn",
                            "learn/papillarray",
                            "learn/piezo_skin",
                            "learn/nib_pad",
                            "learn/biotac_sp",
                            "learn/biotac_stage",
                            "learn/grasp",
                            "learn/disturbed",
                            "learn/taxels",
                            "learn/magnetic_skin",
                            "learn/carried_magnetic_skin",
                            "learn/gel_markers",
                            "learn/short_papillarray",
                            "learn/short_taxels",
                            "learn/short_magnetic_skin",
                            "learn/short_nib_pad",
                            "learn/short_piezo_skin",
                            "learn/short_gel_markers",
                            "learn/short_myrmex",
                            "learn/short_biotac_sp",
                            "learn/motor"})
    learnt.insert(seed(fmt::format("scenes/{}.yaml", scene)));  // of the included networks
  for (const char* name : protocol_names) {
    const Protocol protocol = find_protocol(name, "test");
    for (const TestSet& test_set : protocol.held_out) EXPECT_FALSE(learnt.contains(seed(test_set.scene))) << test_set.scene;
  }
}

// A recording is judged from the beginning of its motion, so a recording without motion would not
// be judged at all.
TEST(Protocol, EveryOpenRecordingMoves) {
  const Catalogues catalogues = program_catalogues();
  const Protocol protocol = find_protocol(default_protocol, "test");
  for (const TestSet& test_set : protocol.held_out) {
    if (test_set.track != Track::open || !test_set.disturbance.empty()) continue;
    SweepOptions options;
    options.scene_path = project_file(test_set.scene);
    const ReadSweep read = read_sweep(options, catalogues);
    EXPECT_GE(read.planned.plan.size(), 240U) << test_set.scene;
    for (std::size_t k = 0; k < read.planned.plan.size(); ++k) {
      const Scene scene = read.planned.plan.trial(k).scene;
      EXPECT_LT(judged_from(test_set, scene), scene.duration) << test_set.scene << ", trial " << k;
    }
  }
}

// Every loop has the same boxes for all sensors.
TEST(Protocol, LoopsDifferInTheirSensorAlone) {
  for (const char* name : protocol_names) {
    std::set<std::string> sweeps, seeds;
    const Protocol protocol = find_protocol(name, "test");
    for (const TestSet& test_set : protocol.held_out) {
      if (test_set.track != Track::loop) continue;
      const SceneFile file = SceneFile::load(project_file(test_set.scene));
      sweeps.insert(file.text().substr(file.text().find("sweep:")));
      seeds.insert(file.root().find("seed")->text);
    }
    EXPECT_EQ(sweeps.size(), 1U) << name;
    EXPECT_EQ(seeds.size(), 1U) << name;
  }
}

TEST(Submission, NamesTheFirstDifference) {
  const Json made{{result_key, 1}, {"machine", {{"cpu", "a"}}}, {"sets", {{{"rows", {{{"credit", 0.5}}}}}}}};
  EXPECT_EQ(difference(submission_text(made), made, made), "");
  Json elsewhere = made;
  elsewhere["machine"]["cpu"] = "b";
  EXPECT_EQ(difference(submission_text(made), made, elsewhere), "") << "the machine is a claim, not a result";
  Json known = made;
  known["protocol"]["real"] = "three recordings";
  Json earlier = known;
  earlier["protocol"]["real"] = "two recordings";
  EXPECT_EQ(difference(submission_text(earlier), earlier, known), "") << "text for the page";
  Json other = made;
  other["sets"][0]["rows"][0]["credit"] = 0.25;
  EXPECT_EQ(difference(submission_text(made), made, other), "/sets/0/rows/0/credit: 0.5 in the file, but 0.25 recomputed");
  other["sets"][0]["rows"][0]["credit"] = 0.5 * (1.0 + 1e-10);
  EXPECT_EQ(difference(submission_text(made), made, other), "") << "MuJoCo, FFTW and networks round by the processor";
  EXPECT_EQ(difference(submission_text(made) + "\n", made, made).substr(0, 5), "byte ");
}

TEST(Submission, AskedIsReadBack) {
  const BoardRequest request{
      .detectors = {"a.onnx"}, .parameters = {{"flip", "0.1"}}, .real = {"r.h5"}, .sensor = "myrmex", .trials = 4};
  EXPECT_EQ(request_json(parse_request(request_json(request), "a.json")), request_json(request));
  EXPECT_THAT(refusal_of([] { parse_request(Json::array(), "a.json"); }), HasSubstr("a.json: /asked: "));
  Json negative = request_json(request);
  negative["trials"] = -1;
  EXPECT_THAT(refusal_of([&] { parse_request(negative, "a.json"); }), HasSubstr("a.json: /asked: "));
  EXPECT_THAT(refusal_of([] { parse_submission(std::string(100'000, '['), "a.json"); }), mentions({"a.json", "100"}));
}

}  // namespace
}  // namespace slipbench::benchmark
