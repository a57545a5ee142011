// Runs all trials of a scene: expands the sweep, runs worker threads, writes the trials in order.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/dataset/batches.h"
#include "tools/dataset/header.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/trial/run_trial.h"
#include "tools/workers/child_process.h"

namespace slipbench {

// Reported on the calling thread after each trial, in order.
struct SweepProgress {
  std::size_t done = 0;  // finished or failed trials; a kill loses those of the current batch (batches.h)
  std::size_t total = 0;
  double simulated = 0.0;  // s, simulated time of those trials
  double share = 0.0;      // simulated share of a run of one trial, reported while it runs
};
using ProgressCallback = std::function<void(const SweepProgress&)>;

struct SensorSummary {
  std::string name;
  std::vector<UnitOutcome> units;
  StateCounts state_count{};        // samples in each PadState, rule strict
  StateCounts state_micro_count{};  // likewise, rule micro
};

struct DetectorSummary {
  std::string type;    // "force_ratio"
  std::string sensor;  // name in the scene of the sensor that it reads
  Confusion confusion{};
  std::string notice = {};  // Detector::notice(); of a resumed trial empty
};

struct TrialSummary {
  std::size_t trial = 0;
  std::string params;  // JSON object of the swept values
  TrialOutcome outcome;
  std::vector<SensorSummary> sensors;
  std::optional<DetectorSummary> detector;  // empty: no detector
  std::string controller = {};              // "step_on_slip"; empty: no controller
  bool resumed = false;                     // read from the resumed dataset, which lacks the outcomes of units
};

// Runs each trial in a child process, for user code that may end its process or never return: only
// that trial fails.
struct Isolation {
  bool on = false;
  double limit = std::numeric_limits<double>::infinity();  // time limit of a trial [s]
  Fork fork = {};                                          // see ChildProcesses
};

struct SweepOptions {
  std::string verb = "sweep";                  // name of the command, for the dataset's attribute `command`
  std::string scene_path;                      // "-": standard input, whose text is in scene_text
  std::optional<std::string> scene_text = {};  // the scene; empty: it is read from scene_path
  std::vector<Override> overrides;
  std::optional<std::uint64_t> seed;     // empty: the scene's
  std::size_t trials = 0;                // repetitions of each grid cell; 0: the scene's
  std::size_t limit = 0;                 // maximum number of trials, repeating cells as needed; 0: all
  std::optional<std::size_t> only = {};  // run only this one of those trials; empty: all
  std::optional<SweepShard> shard = {};  // run only the trials of this part of the sweep; its `trials` is ignored; empty: all
  bool resume = false;                   // continue with what an interrupted run of the same sweep left of `output`
  bool keep_units = true;                // in the summary of every trial of several: some 100 B per unit
  std::size_t jobs = 0;                  // worker threads; 0: one per hardware thread, as far as memory allows
  Isolation isolation = {};
  std::string output;                                              // dataset; empty: no output
  Recording recording = Recording::full;                           // recorded part of a trial; its outcome alone takes some kB
  std::uint64_t shard_limit = DatasetWriter::default_shard_limit;  // bytes
  const std::atomic<bool>* interrupt = nullptr;                    // once true, running trials end and do not count
  std::function<void()> on_start;  // called after the scene is checked, before anything is written; may be empty
  std::function<void(const TrialSummary&)> on_trial = {};  // called with each finished trial, in order; may be empty
};

struct SweepSummary {
  std::uint64_t seed = 0;
  std::string command;                             // canonical
  Scene scene;                                     // of the first trial to run
  std::size_t available = 0;                       // trials in the scene's sweep
  std::size_t planned = 0;                         // requested trials; of a shard, its own
  std::optional<SweepShard> shard;                 // empty: not a shard
  std::vector<TrialSummary> trials;                // finished, in order
  std::vector<FailedTrial> failed;                 // in order
  std::size_t resumed = 0;                         // finished trials that an earlier run simulated
  std::vector<std::string> damaged;                // damaged batches of an earlier run, whose trials were simulated again
  bool was_complete = false;                       // nothing to resume: the dataset exists and is complete; `trials` is empty
  std::size_t kept = 0;                            // trials in `files`
  double simulated = 0.0;                          // s, of the trials that this run simulated
  double computed = 0.0;                           // s, wall-clock time of their simulation, summed over the workers
  double shortest_step = 0.0, longest_step = 0.0;  // s, of these trials; 0 if there are none
  bool interrupted = false;
  std::vector<std::string> files;  // written files; the batches if interrupted
};

// The trials from which a command selects.
struct PlannedTrials {
  TrialPlan plan;             // the scene's sweep, with repeated cells until there are at least options.limit trials
  std::size_t requested = 0;  // number of requested trials, the first of the plan; options.only is one of them
};

// `file`: with options.overrides; `catalogues` must outlive the result; `seed`: the dataset's.
// Throws InputError as TrialPlan does, and if options.only is not a requested trial.
PlannedTrials plan_trials(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed);

// A sweep whose scene was read and checked, once for all uses before and during the run.
struct ReadSweep {
  SceneFile file;  // with the overrides
  std::uint64_t seed = 0;
  PlannedTrials planned;
};

// The scene of `options`, with the overrides. Messages call standard input "<stdin>". Throws
// InputError if the scene is unreadable or an override does not fit it.
SceneFile scene_file(const SweepOptions& options);

// `catalogues` must outlive the result. Throws InputError as plan_trials() and scene_file() do.
ReadSweep read_sweep(const SweepOptions& options, const Catalogues& catalogues);

// Runs action() where trials run: in this process, or, if isolated, in a child process. For actions
// that build `trials` trials before the first one runs, and so may run user code. Throws the
// action's exceptions, and InputError if its process crashes.
std::string run_before_trials(const SweepOptions& options, std::size_t trials, const std::function<std::string()>& action);

// Removes the empty columns of a record with the outcome alone.
void keep_outcome(TrialRecord& record);

// TrialPlan::Trial::drawn in the form of a demo's attribute `params`.
std::string params_json(const std::vector<std::pair<std::string, std::string>>& drawn);

// The shell command that determines the bytes of a dataset: without --jobs and -o.
std::string canonical_command(const SweepOptions& options);

// A word quoted for a shell.
std::string shell_word(const std::string& word);

// Runs the sweep. A failed trial is recorded, in the summary and in the dataset, and the others
// run. Throws InputError for an invalid scene or target, and if options.only is not one of its
// trials. If the target fails, finished work is kept in the folder OUT.h5.partial, which the
// message names. The output does not depend on `jobs`.
SweepSummary run_sweep(const SweepOptions& options, const Catalogues& catalogues, const ProgressCallback& progress = {});
// As above; `read`: read_sweep(options, catalogues).
SweepSummary run_sweep(const ReadSweep& read, const SweepOptions& options, const Catalogues& catalogues,
                       const ProgressCallback& progress = {});

}  // namespace slipbench
