// Uses a scene as a regression test: compares its trials, and those of the negative control, with
// its key `expect`.
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
#include "tools/statistics/descriptive.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench {

struct CheckOptions {
  std::string scene_path = {};
  std::vector<Override> overrides = {};
  std::optional<std::uint64_t> seed = {};  // empty: the scene's
  std::size_t trials = 0;                  // per cell of the grid; 0: the scene's sweep.trials, or 1
  std::size_t jobs = 0;                    // worker threads; 0: one per hardware thread; does not affect the result
  Isolation isolation = {};                // as in SweepOptions
  std::string folder = {};                 // for the files of a failed check; created if missing; empty: no files
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void()> on_start = {};  // called after the scene is checked; may be empty
};

// One trial's value of an expectation's quantity.
struct ObservedValue {
  std::size_t trial = 0;
  double value = 0.0;  // SI, a flag as 0 or 1; NaN: never happened, or the trial failed
};

// Result of one expectation.
struct ExpectationResult {
  std::string name;
  std::string limit;       // as text: "at most 3 mm", "false"
  std::size_t kept = 0;    // number of trials
  std::size_t trials = 0;  // at least 1
  std::size_t needed = 0;  // number of trials needed to pass
  Interval rate;           // share of trials that keep it
  double median =
      0.0;  // as ObservedValue::value; of an even number: mean of the middle two, or the worse for flags and missing values
  ObservedValue worst;                      // the earliest worst trial
  std::string median_text, worst_text;      // as text in the limit's unit: "2.31 mm", "never", "no delay"
  std::optional<std::size_t> control_kept;  // trials of the negative control; empty: no control
  std::string replay;                       // command or call in Python that repeats the worst trial bit-exactly, without `-o`

  [[nodiscard]] bool passed() const { return kept >= needed; }
};

enum class Verdict {
  passed,
  failed,
  tests_nothing,  // the negative control passes too
  not_checked,    // the scene expects nothing
};

// "passed", "failed", "tests nothing", "not checked"
std::string verdict_text(Verdict verdict);

struct SceneCheck {
  std::string scene_path;
  std::uint64_t seed = 0;
  double confidence = 0.0;
  std::string control;  // controller of the negative control; empty: no control
  std::size_t control_trials = 0;
  Verdict verdict = Verdict::not_checked;
  std::vector<ExpectationResult> expectations;
  std::vector<DetectorScore> detectors;  // over all trials
  std::vector<std::string> failures;     // reasons of trials that failed to run, in order: "trial 3: ..."
  std::optional<std::size_t> replayed;   // trial in the files below: it misses most of the failed expectations
  std::vector<std::string> files;        // dataset, then report
  std::vector<Warning> warnings;         // found in the trials
};

// True if the scene has expectations. Throws InputError for an unreadable scene.
bool expects_anything(const CheckOptions& options, const Catalogues& catalogues);

// The sweep whose trials are compared with the scene's expectations.
SweepOptions sweep_of(const CheckOptions& options);

// Runs the scene's trials and evaluates each expectation. A failed trial keeps none. Throws
// InputError for an invalid scene, for a reliability that the number of trials cannot show, and
// if the files of a failed check cannot be written; Interrupted once options.interrupt is true.
SceneCheck check_scene(const CheckOptions& options, const Catalogues& catalogues, const ProgressCallback& progress = {});

// Message of a failed expectation: "max_slip: at most 3 mm in 17 of 20 trials, needed in 20; worst:
// 4.1 mm in trial 7".
std::string failure_text(const ExpectationResult& result);

// Message of a scene that tests nothing.
std::string tests_nothing_text(const SceneCheck& check);

// JUnit XML for Jenkins and GitLab: a suite per scene, a case per expectation, one more for the
// negative control. A failure states the reason and the command that repeats the trial; a scene
// without expectations has one case, skipped. There are no clock times, so equal checks give
// identical bytes.
std::string junit_xml(const std::vector<SceneCheck>& checks);

}  // namespace slipbench
