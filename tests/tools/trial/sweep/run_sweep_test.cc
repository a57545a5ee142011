#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/warnings.h"

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/finished_trial.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench::testing {
namespace {

using Json = nlohmann::json;

// Twelve short trials: three speeds, two materials, two draws of each, noisy sensor.
constexpr const char* scene_text = R"(slipbench: 1
description: short sweep
duration: 0.3 s
time_step: 1 ms
seed: 7
surface: {material: acrylic}
motion: {kind: stage, gap: 0 mm, compression: 0.1 mm, approach_speed: 10 mm/s, start: 0.1 s, speed: 4 mm/s, acceleration: 1 m/s2}
sensors:
  pad: {type: papillarray, rate: 1 kHz, electronics: typical, bristles: 3}
sweep:
  motion.speed: [1 mm/s, 4 mm/s, 16 mm/s]
  surface.material: [acrylic, felt]
  motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}
  trials: 2
)";

struct SweepTest : FolderTest {
  SweepTest() { std::ofstream(path("scene.yaml")) << scene_text; }

  SweepOptions options(const std::string& output, std::size_t jobs = 2) {
    SweepOptions options;
    options.scene_path = path("scene.yaml");
    if (!output.empty()) options.output = path(output);
    options.jobs = jobs;
    return options;
  }
  SweepSummary run(const SweepOptions& options, const ProgressCallback& progress = {}) {
    return run_sweep(options, catalogues_, progress);
  }
  // Digests of a dataset's files. The bytes also depend on when the sweep finished its batches.
  [[nodiscard]] std::vector<std::string> content_of(const std::string& name) const {
    return DatasetReader(path(name)).content_sha256();
  }

 private:
  Catalogues catalogues_ = program_catalogues();
};

TEST_F(SweepTest, WritesEveryTrial) {
  const SweepSummary summary = run(options("out.h5"));
  EXPECT_EQ(summary.planned, 12U);
  EXPECT_EQ(summary.trials.size(), 12U);
  EXPECT_FALSE(summary.interrupted);
  EXPECT_NEAR(summary.simulated, 12 * 0.3, 1e-9);
  EXPECT_THAT(summary.files, ElementsAre(path("out.h5")));
  EXPECT_THAT(names(), ElementsAre("out.h5", "scene.yaml"));

  const DatasetReader reader(path("out.h5"));
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.header().scene, scene_text);
  EXPECT_EQ(reader.header().seed, 7U);
  EXPECT_EQ(reader.trials().size(), 12U);
  for (const TrialSummary& trial : summary.trials) {
    const DemoInfo info = reader.info(trial.trial);
    EXPECT_EQ(info.num_samples, 300U);
    EXPECT_EQ(info.params, trial.params);
    EXPECT_EQ(info.outcome, outcome_json(trial.outcome));
    const Json params = Json::parse(info.params);
    EXPECT_TRUE(params.contains("motion.speed"));
    EXPECT_TRUE(params.at("motion.direction").is_number());
  }
  // Two materials: one is for the test, none for validation, and none is in two parts.
  EXPECT_EQ(reader.mask("test").size(), 6U);
  EXPECT_EQ(reader.mask("valid").size(), 0U);
  EXPECT_EQ(reader.mask("train").size(), 6U);
}

TEST_F(SweepTest, ContentDependsOnNeitherJobsNorRun) {
  run(options("one.h5", 1));
  run(options("two.h5", 2));
  run(options("again.h5", 2));
  run(options("five.h5", 5));
  const std::vector<std::string> one = content_of("one.h5");
  EXPECT_THAT(one, SizeIs(1));
  EXPECT_EQ(content_of("two.h5"), one);
  EXPECT_EQ(content_of("again.h5"), one);
  EXPECT_EQ(content_of("five.h5"), one);
}

// The file stores what would be counted from a recording.
TEST_F(SweepTest, OutcomesAloneAreThoseOfARecording) {
  SweepOptions full = options("full.h5");
  full.overrides = {{"detector", "{type: force_ratio}"}};
  SweepOptions alone = full;
  alone.output = path("alone.h5");
  alone.recording = Recording::outcome;
  const SweepSummary summary = run(full);
  EXPECT_EQ(run(alone).command, summary.command + " --record outcome");
  const DatasetReader recorded(path("full.h5"));
  const DatasetReader outcomes(path("alone.h5"));
  ASSERT_EQ(outcomes.trials(), recorded.trials());
  for (const std::size_t trial : recorded.trials()) {
    EXPECT_EQ(outcomes.info(trial).outcome, recorded.info(trial).outcome);
    EXPECT_EQ(outcomes.info(trial).params, recorded.info(trial).params);
    const TrialRecord record = outcomes.read_trial(trial);
    EXPECT_THAT(record.sensors, IsEmpty());
    EXPECT_THAT(record.bodies, IsEmpty());
    EXPECT_EQ(record.control->detector, "force_ratio");
    EXPECT_EQ(record.control->confusion, recorded.read_trial(trial).control->confusion);
    EXPECT_THROW(outcomes.check_recorded(trial), InputError);
  }
  // Twelve trials of 300 samples of nine pillars compared with a few attributes each.
  EXPECT_LT(bytes_of(path("alone.h5")).size() * 4, bytes_of(path("full.h5")).size());
  alone.output = path("other.h5");
  alone.jobs = 1;
  run(alone);
  EXPECT_EQ(content_of("alone.h5"), content_of("other.h5"));
}

TEST_F(SweepTest, SeedChangesTheContent) {
  run(options("seven.h5"));
  SweepOptions eight = options("eight.h5");
  eight.seed = 8;
  EXPECT_EQ(run(eight).seed, 8U);
  const DatasetReader first(path("seven.h5"));
  const DatasetReader second(path("eight.h5"));
  EXPECT_NE(first.content_sha256(), second.content_sha256());
  EXPECT_EQ(second.header().seed, 8U);
  EXPECT_EQ(second.info(0).seed, 8U);
}

TEST_F(SweepTest, CommandIsCanonical) {
  SweepOptions changed = options("");
  changed.verb = "run";
  changed.overrides = {{"motion.start", "50 ms"}, {"description", "it's"}};
  changed.seed = 9;
  changed.trials = 1;
  changed.jobs = 1;
  EXPECT_EQ(run(changed).command, "slipbench run " + path("scene.yaml") +
                                      " --set 'motion.start=50 ms' --set 'description=it'\\''s' --seed 9 --trials 1");
}

TEST_F(SweepTest, OverridesAreWritten) {
  SweepOptions changed = options("out.h5");
  changed.overrides = {{"motion.start", "50 ms"}};
  changed.trials = 1;
  EXPECT_EQ(run(changed).planned, 6U);  // three speeds, two materials
  EXPECT_EQ(DatasetReader(path("out.h5")).header().overrides, R"({"motion.start":"50 ms"})");
}

// Applied again in their written order they give the simulated scene, although a JSON object has
// each key only once.
TEST_F(SweepTest, RepeatedOverridesAreWrittenInAnOrderThatGivesTheSameScene) {
  struct Case {
    std::vector<Override> given;
    std::string written;
  };
  const std::vector<Case> cases{
      {{{"motion.speed", "1 mm/s"}, {"motion", "{speed: 2 mm/s}"}, {"motion.speed", "3 mm/s"}},
       R"({"motion":"{speed: 2 mm/s}","motion.speed":"3 mm/s"})"},
      {{{"motion.tilt", "[0, 0]"}, {"motion.tilt.0", "1 deg"}, {"motion.tilt", "[0, 0.01]"}}, R"({"motion.tilt":"[0, 0.01]"})"},
      {{{"motion.start", "1 s"}, {"motion.stop", "2 s"}, {"motion.start", "50 ms"}},
       R"({"motion.stop":"2 s","motion.start":"50 ms"})"},
      {{{"sweep.motion.speed", "[1 mm/s]"}, {"sweep.motion", "[{stop: 2 s}]"}},
       R"({"sweep.motion.speed":"[1 mm/s]","sweep.motion":"[{stop: 2 s}]"})"},
      {{{"sweep.motion.speed", "[1 mm/s]"}, {"sweep", "{}"}}, R"({"sweep":"{}"})"}};
  const Catalogues catalogues = program_catalogues();
  for (const Case& entry : cases) {
    SweepOptions changed = options("out.h5");
    changed.overrides = entry.given;
    changed.limit = 1;
    const SweepSummary summary = run(changed);
    const std::string written = DatasetReader(path("out.h5")).header().overrides;
    EXPECT_EQ(written, entry.written);
    SceneFile again = SceneFile::load(path("scene.yaml"));
    const auto overrides = nlohmann::ordered_json::parse(written);
    for (const auto& [key, value] : overrides.items()) again.apply({key, value.get<std::string>()});
    const TrialPlan plan(again, catalogues, 0, 7);
    EXPECT_EQ(plan.size(), summary.available);
    for (const char* name : {"speed", "start", "stop"}) {
      EXPECT_EQ(plan.trial(0).scene.motion.parameters.number(name), summary.scene.motion.parameters.number(name)) << name;
    }
    EXPECT_EQ(plan.trial(0).scene.motion.parameters.vector("tilt"), summary.scene.motion.parameters.vector("tilt"));
  }
}

// 1,400 s at 1 kHz with the bodies' poses are a record of 870 MB: four jobs fit into 4 GB, five do
// not.
TEST_F(SweepTest, JobsShareTheMemoryForRecords) {
  SweepOptions long_trials = options("out.h5", 5);
  long_trials.overrides = {{"duration", "1400 s"}, {"sweep", "{trials: 5}"}};
  EXPECT_THAT(refusal_of([&] { run(long_trials); }), mentions({"--set duration=1400 s", "0.868 GB", "0.8 GB", "--jobs"}));
  EXPECT_THAT(names(), ElementsAre("scene.yaml")) << "refused before anything is written";

  // Four would run for long: the interrupt ends them before the first trial.
  const std::atomic<bool> interrupt{true};
  long_trials.jobs = 4;
  long_trials.interrupt = &interrupt;
  EXPECT_TRUE(run(long_trials).interrupted);
  // Without a dataset there are no records.
  long_trials.jobs = 5;
  long_trials.output.clear();
  EXPECT_TRUE(run(long_trials).interrupted);
}

TEST_F(SweepTest, WithoutATargetTheSummaryIsTheSame) {
  const SweepSummary dry = run(options(""));
  const SweepSummary written = run(options("out.h5"));
  ASSERT_EQ(dry.trials.size(), written.trials.size());
  for (std::size_t k = 0; k < dry.trials.size(); ++k) {
    EXPECT_EQ(dry.trials[k].params, written.trials[k].params);
    EXPECT_EQ(outcome_json(dry.trials[k].outcome), outcome_json(written.trials[k].outcome));
    EXPECT_EQ(dry.trials[k].sensors.at(0).units.at(4).load, written.trials[k].sensors.at(0).units.at(4).load);
    EXPECT_EQ(dry.trials[k].sensors.at(0).state_count, written.trials[k].sensors.at(0).state_count);
  }
  EXPECT_THAT(dry.files, IsEmpty());
}

TEST_F(SweepTest, ProgressCountsInOrder) {
  std::vector<std::size_t> done;
  run(options(""), [&](const SweepProgress& progress) {
    done.push_back(progress.done);
    EXPECT_EQ(progress.total, 12U);
    EXPECT_NEAR(progress.simulated, 0.3 * static_cast<double>(progress.done), 1e-9);
  });
  EXPECT_THAT(done, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
}

TEST_F(SweepTest, SummaryIsJson) {
  SweepOptions sweep_options = options("out.h5");
  Json trials = Json::array();
  sweep_options.on_trial = [&trials](const TrialSummary& trial) { trials.push_back(Json::parse(trial_json(trial))); };
  sweep_options.keep_units = false;
  const SweepSummary summary = run(sweep_options);
  EXPECT_THAT(summary.trials.at(3).sensors.at(0).units, IsEmpty());
  Json json = Json::parse(summary_json(summary));
  json["trials"] = std::move(trials);
  EXPECT_EQ(json.at("planned"), 12);
  EXPECT_EQ(json.at("finished"), 12);
  EXPECT_EQ(json.at("files").at(0), path("out.h5"));
  EXPECT_EQ(json.at("trials").size(), 12U);
  EXPECT_EQ(json.at("trials").at(3).at("trial"), 3);
  EXPECT_TRUE(json.at("trials").at(3).at("outcome").at("dropped").is_null());
  EXPECT_EQ(json.at("trials").at(3).at("sensors").at("pad").at("onset_time_s").size(), 9U);
  for (const char* key : {"touch_time_s", "micro_onset_time_s", "slip_distance_m", "load_N", "margin"}) {
    EXPECT_EQ(json.at("trials").at(3).at("sensors").at("pad").at(key).size(), 9U) << key;
  }
}

// Enough trials that the workers cannot have begun all of them when the first few are saved.
TEST_F(SweepTest, InterruptKeepsWhatIsFinished) {
  const InterruptGuard guard;
  SweepOptions interrupted = options("out.h5");
  interrupted.trials = 1000;
  interrupted.interrupt = &InterruptGuard::flag();
  const SweepSummary summary = run(interrupted, [](const SweepProgress& progress) {
    if (progress.done >= 3 && !InterruptGuard::flag()) std::raise(SIGINT);
  });
  EXPECT_TRUE(summary.interrupted);
  EXPECT_GE(summary.trials.size(), 3U);
  EXPECT_LT(summary.trials.size(), 6000U);
  ASSERT_GE(summary.files.size(), 1U);
  EXPECT_EQ(summary.files.front(), path("out.h5.partial/batch.h5"));
  EXPECT_THAT(names(), ElementsAre("out.h5.partial", "scene.yaml"));
  const DatasetReader reader(path("out.h5.partial/batch.h5"));
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.files(), summary.files);
  EXPECT_EQ(reader.trials().size(), summary.trials.size());
}

// The second trial would take a minute.
TEST_F(SweepTest, InterruptEndsARunningTrial) {
  std::atomic<bool> interrupt = false;
  SweepOptions long_one = options("");
  long_one.overrides = {{"sweep", "{duration: [0.3 s, 86400 s]}"}};
  long_one.interrupt = &interrupt;
  const SweepSummary summary = run(long_one, [&](const SweepProgress&) { interrupt = true; });
  EXPECT_TRUE(summary.interrupted);
  EXPECT_EQ(summary.trials.size(), 1U);
  EXPECT_EQ(summary.planned, 2U);
}

TEST(InterruptGuard, TakesEverySignalThatAsksToEnd) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const InterruptGuard guard;
    EXPECT_FALSE(InterruptGuard::flag());
    std::raise(signal);
    EXPECT_TRUE(InterruptGuard::flag()) << signal;
  }
}

// Three speeds and three parts: one each.
TEST_F(SweepTest, SplitsAsTheSceneSays) {
  std::ofstream(path("scene.yaml"), std::ios::app) << "split: {by: speed, shares: [0.4, 0.3, 0.3]}\n";
  run(options("out.h5"));
  const DatasetReader reader(path("out.h5"));
  const auto speed_of = [&](const char* part) {
    const std::vector<std::size_t> members = reader.mask(part);
    EXPECT_EQ(members.size(), 4U) << part;
    for (const std::size_t trial : members) EXPECT_EQ(trial / 4, members.front() / 4) << part;  // the last axis varies fastest
    return members.front() / 4;
  };
  EXPECT_EQ(std::set({speed_of("train"), speed_of("valid"), speed_of("test")}).size(), 3U);
}

// Each of the grid's experiments is repeated, with the same forces and another noise. Its repeats
// are in one part, whether the scene asks for a split by trial or has no other property.
TEST_F(SweepTest, RepeatsOfOneExperimentAreInOnePart) {
  SweepOptions repeated = options("out.h5");
  repeated.overrides = {
      {"sweep", "{motion.speed: [1 mm/s, 2 mm/s, 4 mm/s, 8 mm/s], sensors.pad.electronics: [ideal, typical], trials: 3}"}};
  run(repeated);
  const DatasetReader reader(path("out.h5"));
  std::map<std::size_t, std::set<std::string>> parts_of_speed;  // 4 speeds of 2 electronics of 3 repeats
  for (const char* part : {"train", "valid", "test"}) {
    EXPECT_FALSE(reader.mask(part).empty()) << part;
    for (const std::size_t trial : reader.mask(part)) parts_of_speed[trial / 6].insert(part);
  }
  EXPECT_EQ(parts_of_speed.size(), 4U);
  for (const auto& [speed, parts] : parts_of_speed) EXPECT_EQ(parts.size(), 1U) << speed;
}

TEST_F(SweepTest, SplitBySpeedNeedsAMotionWithOne) {
  SweepOptions pressed = options("out.h5");
  pressed.overrides = {{"motion", "{kind: wander}"}, {"sweep", "{trials: 2}"}, {"split", "{by: speed}"}};
  EXPECT_THAT(refusal_of([&] { run(pressed); }), mentions({"split.by", "wander", "speed"}));
  EXPECT_THAT(names(), ElementsAre("scene.yaml"));
}

// A shell starts a script's background processes with SIGINT ignored.
TEST(InterruptGuard, LeavesAnIgnoredSignalIgnored) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  {
    const InterruptGuard guard;
    std::raise(SIGINT);
    EXPECT_FALSE(InterruptGuard::flag());
    std::raise(SIGTERM);
    EXPECT_TRUE(InterruptGuard::flag());
  }
  EXPECT_EQ(std::signal(SIGINT, before), SIG_IGN);
}

TEST_F(SweepTest, InterruptBeforeTheFirstTrialLeavesNothing) {
  const std::atomic<bool> interrupt{true};
  SweepOptions interrupted = options("out.h5");
  interrupted.interrupt = &interrupt;
  const SweepSummary summary = run(interrupted);
  EXPECT_TRUE(summary.interrupted);
  EXPECT_THAT(summary.files, IsEmpty());
  EXPECT_THAT(names(), ElementsAre("scene.yaml"));
}

// A compression drawn below zero gives no valid scene. The seed determines which trials draw one.
TEST_F(SweepTest, FailedTrialIsNotedAndTheOthersRun) {
  std::ofstream(path("scene.yaml"), std::ios::app) << "  motion.compression: {draw: uniform, min: -0.03 mm, max: 0.1 mm}\n";
  const SweepSummary summary = run(options("out.h5"));
  ASSERT_GT(summary.failed.size(), 0U) << "choose another seed";
  ASSERT_GT(summary.trials.size(), 0U);
  EXPECT_EQ(summary.failed.size() + summary.trials.size(), 12U);
  EXPECT_FALSE(summary.interrupted);
  const DatasetReader reader(path("out.h5"));
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.trials().size(), summary.trials.size());
  ASSERT_EQ(reader.failed().size(), summary.failed.size());
  const FailedTrial& failed = reader.failed().front();
  EXPECT_THAT(failed.message, StartsWith("trial " + std::to_string(failed.trial) + ": " + path("scene.yaml")));
  EXPECT_THAT(failed.message, HasSubstr("compression"));
  EXPECT_EQ(failed.command, "slipbench run " + path("scene.yaml") + " --seed 7 --trial " + std::to_string(failed.trial));
  EXPECT_THAT(names(), ElementsAre("out.h5", "scene.yaml"));
  // The command fails in the same way.
  SweepOptions again = options("");
  again.only = failed.trial;
  again.limit = 0;
  const std::string prefix = "trial " + std::to_string(failed.trial) + ": ";
  EXPECT_EQ(prefix + refusal_of([&] { run(again); }), failed.message);
  // The content does not depend on which thread had the failure.
  const std::vector<std::string> content = content_of("out.h5");
  run(options("out.h5", 1));
  EXPECT_EQ(content_of("out.h5"), content);
}

// The first trials of the cells are built before anything runs: these fail at their end.
TEST_F(SweepTest, SweepInWhichAllFailWritesNothing) {
  SweepOptions unstable = options("out.h5");
  unstable.overrides = {{"sensors.pad.electronics", "[{offset: {scale: 1e50}}]"}};  // beyond a float's range
  const SweepSummary summary = run(unstable);
  EXPECT_EQ(summary.failed.size(), 12U);
  EXPECT_THAT(summary.files, IsEmpty());
  EXPECT_THAT(names(), ElementsAre("scene.yaml"));
}

// Each trial reads the same files. A file rewritten with the same content counts as unchanged.
TEST_F(SweepTest, AFileThatChangesEndsTheRun) {
  std::ofstream(path("scene.yaml"))
      << "slipbench: 1\nduration: 0.4 s\nmotion: {compression: 0.1 mm, start: 0.3 s}\nsensors: {pad: {type: taxels, places: "
         "places.csv}}\nsweep: {motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}, trials: 300}\n";
  const auto write = [this](const char* places) {
    std::ofstream(path("new.csv")) << places;
    std::filesystem::rename(path("new.csv"), path("places.csv"));
  };
  write("x [mm],y [mm]\n0,0\n4,0\n");
  SweepOptions rewritten = options("out.h5", 1);
  rewritten.on_trial = [&](const TrialSummary& trial) {
    if (trial.trial == 0) write("x [mm],y [mm]\n0,0\n4,0\n");
  };
  EXPECT_EQ(run(rewritten).trials.size(), 300U);
  SweepOptions changed = options("other.h5", 1);
  changed.on_trial = [&](const TrialSummary& trial) {
    if (trial.trial == 0) write("x [mm],y [mm]\n0,0\n5,0\n");
  };
  EXPECT_THAT(refusal_of([&] { run(changed); }), refused_at(path("places.csv"), {"changed", path("other.h5.partial")}));
  const DatasetReader kept(path("other.h5.partial/batch.h5")), whole(path("out.h5"));
  ASSERT_LT(kept.trials().size(), 300U);
  for (const std::size_t trial : kept.trials()) EXPECT_EQ(kept.trial_sha256(trial), whole.trial_sha256(trial));
}

// A child process returns the whole trial, including the NaN times of units without slip.
TEST_F(SweepTest, IsolatedTrialsAreTheSame) {
  const SweepSummary together = run(options("together.h5"));
  SweepOptions isolated = options("apart.h5");
  isolated.isolation.on = true;
  const SweepSummary apart = run(isolated);
  EXPECT_EQ(content_of("apart.h5"), content_of("together.h5"));
  ASSERT_EQ(apart.trials.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(trial_json(apart.trials[i]), trial_json(together.trials[i]));
  EXPECT_EQ(apart.longest_step, together.longest_step);
  EXPECT_THROW(from_message("no trial"), std::exception);
}

// A sanitiser ends the program when memory runs out.
#ifndef __SANITIZE_ADDRESS__
// The second trial has 2,000,000 samples of more than 500 bytes, which do not fit into 400 MB. With
// more memory it would run, so the run ends.
TEST_F(SweepTest, TrialWithoutMemoryEndsTheRun) {
  SweepOptions large = options("out.h5", 1);
  large.overrides = {{"sweep", "{duration: [0.3 s, 2000 s]}"}};
  const int status = in_child([&] {
    std::size_t pages = 0;  // of the whole process: the first number of statm
    std::ifstream("/proc/self/statm") >> pages;
    rlimit tight{};
    ::getrlimit(RLIMIT_AS, &tight);
    tight.rlim_cur = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + 400'000'000;
    ::setrlimit(RLIMIT_AS, &tight);
    std::ofstream(path("message")) << refusal_of([&] { run(large); });
  });
  EXPECT_EQ(status, 0);
  EXPECT_THAT(bytes_of(path("message")), mentions({"out of memory", path("out.h5.partial"), "1 of 2 trials"}));
  EXPECT_THAT(DatasetReader(path("out.h5.partial/batch.h5")).failed(), IsEmpty());
}
#endif

// After interruptions at any point, continued with any number of threads. Failed trials fail again.
TEST_F(SweepTest, ResumedSweepGivesTheContentOfAnUndisturbedOne) {
  std::ofstream(path("scene.yaml"), std::ios::app) << "  motion.compression: {draw: uniform, min: -0.03 mm, max: 0.1 mm}\n";
  for (const Recording recording : {Recording::full, Recording::outcome}) {
    SweepOptions whole = options("whole.h5");
    whole.recording = recording;
    const SweepSummary undisturbed = run(whole);
    for (const std::size_t first : {1U, 3U, 8U}) {
      std::atomic<bool> interrupt = false;
      SweepOptions part = options("out.h5");
      part.recording = recording;
      part.interrupt = &interrupt;
      std::size_t finished = 0;
      part.on_trial = [&](const TrialSummary&) { interrupt = ++finished == first; };
      EXPECT_TRUE(run(part).interrupted);
      SweepOptions rest = options("out.h5", first);
      rest.recording = recording;
      rest.resume = true;
      const SweepSummary resumed = run(rest);
      EXPECT_GE(resumed.resumed, first);
      EXPECT_EQ(resumed.trials.size(), undisturbed.trials.size());
      EXPECT_EQ(resumed.failed.size(), undisturbed.failed.size());
      EXPECT_EQ(outcome_json(resumed.trials.front().outcome), outcome_json(undisturbed.trials.front().outcome));
      if (recording == Recording::full) {
        EXPECT_EQ(resumed.trials.front().sensors.at(0).state_count, undisturbed.trials.front().sensors.at(0).state_count);
      }
      EXPECT_EQ(DatasetReader(path("out.h5")).content_sha256(), DatasetReader(path("whole.h5")).content_sha256());
      EXPECT_THAT(names(), ElementsAre("out.h5", "scene.yaml", "whole.h5"));
      // It is complete: nothing is run or written again.
      EXPECT_TRUE(run(rest).was_complete);
      std::filesystem::remove(path("out.h5"));
    }
  }
}

TEST_F(SweepTest, LeftTrialsAreReplacedByNobody) {
  std::atomic<bool> interrupt = false;
  SweepOptions part = options("out.h5");
  part.interrupt = &interrupt;
  part.on_trial = [&](const TrialSummary&) { interrupt = true; };
  run(part);
  const std::string left = file_sha256(path("out.h5.partial/batch.h5"));
  EXPECT_THAT(refusal_of([&] { run(options("out.h5")); }), mentions({"--resume"}));
  SweepOptions other = options("out.h5");
  other.resume = true;
  other.seed = 99;
  EXPECT_THAT(refusal_of([&] { run(other); }), mentions({"seed 7", "99"}));
  EXPECT_EQ(file_sha256(path("out.h5.partial/batch.h5")), left);
}

TEST_F(SweepTest, BadTargetIsRefusedBeforeAnythingRuns) {
  std::size_t trials = 0;
  SweepOptions bad = options("no/out.h5");
  EXPECT_THAT(refusal_of([&] { run(bad, [&](const SweepProgress&) { ++trials; }); }), mentions({"folder"}));
  EXPECT_EQ(trials, 0U);
}

}  // namespace
}  // namespace slipbench::testing
