// A scene as a regression test: its trials, and the same with the negative control, held against its key `expect`.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/sweep/run_sweep.h"
#include "tools/program/sweep/warnings.h"

namespace slipbench {

struct CheckOptions {
  std::string scene_path = {};
  std::vector<Override> overrides = {};
  std::optional<std::uint64_t> seed = {};  // empty: the scene's
  std::size_t trials = 0;                  // of each cell of the grid; 0: the scene's sweep.trials, or 1
  std::size_t jobs = 0;                    // worker threads; 0: one a hardware thread. What comes out does not depend on it
  Isolation isolation = {};                // as SweepOptions has it
  std::string folder = {};                 // for what a failed check leaves; made where it is missing; empty: nothing is left
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void()> on_start = {};  // called once the scene is checked; may be empty
};

// One trial's value of what an expectation is about.
struct ObservedValue {
  std::size_t trial = 0;
  double value = 0.0;  // SI, a flag as 0 or 1; NaN: it never happened, or the trial failed
};

// What became of one expectation.
struct ExpectationResult {
  std::string name;
  std::string limit;                        // as a person reads it: "at most 3 mm", "false"
  std::size_t kept = 0;                     // trials
  std::size_t trials = 0;                   // at least 1
  std::size_t needed = 0;                   // of them, to pass
  Interval rate;                            // of trials that keep it
  double median = 0.0;                      // as ObservedValue::value; of an even number of trials the worse of the middle two
  ObservedValue worst;                      // the earliest such trial
  std::string median_text, worst_text;      // as a person reads them, in the limit's unit: "2.31 mm", "never", "no delay"
  std::optional<std::size_t> control_kept;  // trials of the negative control; empty: the scene has none
  std::string replay;                       // command that repeats exactly the worst trial; `-o` is left to its user

  [[nodiscard]] bool passed() const { return kept >= needed; }
};

enum class Verdict {
  passed,
  failed,
  tests_nothing,  // all is kept, but by the negative control too
  not_checked,    // the scene expects nothing
};

// "passed", "failed", "tests nothing", "not checked"
std::string verdict_text(Verdict verdict);

struct SceneCheck {
  std::string scene_path;
  std::uint64_t seed = 0;
  double confidence = 0.0;
  std::string control;  // the negative control: a controller; empty: the scene has none
  std::size_t control_trials = 0;
  Verdict verdict = Verdict::not_checked;
  std::vector<ExpectationResult> expectations;
  std::vector<DetectorScore> detectors;  // how they did over the trials
  std::vector<std::string> failures;     // why trials failed to run, in their order: "trial 3: ..."
  std::optional<std::size_t> replayed;   // trial that the files below hold: it fails most of the expectations that failed
  std::vector<std::string> files;        // dataset, then report
  std::vector<Warning> warnings;         // of what the trials showed
};

// Whether the scene expects anything. Throws InputError for a scene that cannot be read.
bool expects_anything(const CheckOptions& options, const Catalogues& catalogues);

// The sweep whose trials are held against what the scene expects.
SweepOptions sweep_of(const CheckOptions& options);

// Runs the scene's trials and holds each expectation against them. A trial that fails keeps none. Throws InputError for a scene that
// cannot be run, for a reliability that so many trials cannot show, and where the files of a failed check cannot be written; Interrupted
// once options.interrupt is true.
SceneCheck check_scene(const CheckOptions& options, const Catalogues& catalogues, const ProgressCallback& progress = {});

// What is to be said of an expectation that failed: "max_slip: 3 of 20 trials fail, allowed 0 (at most 3 mm); worst: 4.1 mm in trial 7".
std::string failure_text(const ExpectationResult& result);

// The same of a scene that tests nothing.
std::string tests_nothing_text(const SceneCheck& check);

// JUnit XML as Jenkins and GitLab read it: a suite a scene, a case an expectation, one more for its negative control. What failed says why and
// with which command the trial is repeated; a scene that expects nothing has one case, skipped. No clock times: the same check, the
// same bytes.
std::string junit_xml(const std::vector<SceneCheck>& checks);

}  // namespace slipbench
