// All trials of a scene: expanded, run by worker threads, written in order.
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
#include "tools/base/dataset/batches.h"
#include "tools/base/dataset/header.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/workers/child_process.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

// Told from the calling thread after each trial, in order.
struct SweepProgress {
  std::size_t done = 0;  // trials that failed or are finished; a kill loses those of the batch that is being written (batches.h)
  std::size_t total = 0;
  double simulated = 0.0;  // s, of the trials done
  double share = 0.0;      // of a run of one trial, told while it runs: what of it is simulated
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
  std::string sensor;  // the scene's name of the one it reads
  Confusion confusion{};
};

struct TrialSummary {
  std::size_t trial = 0;
  std::string params;  // JSON object of what was swept
  TrialOutcome outcome;
  std::vector<SensorSummary> sensors;
  std::optional<DetectorSummary> detector;  // empty: the scene has none
  std::string controller = {};              // "step_on_slip"; empty: the scene has none
  bool resumed = false;  // read from the dataset that the run went on with, which does not hold what became of units
};

// Whether each trial runs in a child process, for code of others that may end its process or never return: that fails the trial alone.
struct Isolation {
  bool on = false;
  double limit = std::numeric_limits<double>::infinity();  // s that a trial may take
  Fork fork = {};                                          // see ChildProcesses
};

struct SweepOptions {
  std::string verb = "sweep";  // the command's own name, for the dataset's attribute `command`
  std::string scene_path;
  std::vector<Override> overrides;
  std::optional<std::uint64_t> seed;  // empty: the scene's
  std::size_t trials = 0;             // repetitions of each cell of the grid; 0: the scene's
  std::size_t limit = 0;              // run no more than the first so many trials, repeating cells as often as that needs; 0: all
  std::optional<std::size_t> only = {};  // run no other than this one of those trials; empty: all
  std::optional<SweepShard> shard =
      {};                  // run no other than the trials of this part of the sweep, whose `trials` are not looked at; empty: all
  bool resume = false;     // go on with what a run of the same that did not come to its end has left of `output`
  bool keep_units = true;  // in the summary of every trial of several: some 100 B a unit
  std::size_t jobs = 0;    // worker threads; 0: as many as the machine has, or as their records have room for
  Isolation isolation = {};
  std::string output;                     // dataset; empty: nothing is written
  Recording recording = Recording::full;  // what the dataset holds of a trial: its outcome alone takes some kB
  std::uint64_t shard_limit = DatasetWriter::default_shard_limit;  // bytes
  const std::atomic<bool>* interrupt = nullptr;                    // once true, running trials end and count for nothing
  std::function<void()> on_start;  // called once the scene is checked, before anything is written; may be empty
  std::function<void(const TrialSummary&)> on_trial = {};  // called with each finished trial, in order; may be empty
};

struct SweepSummary {
  std::uint64_t seed = 0;
  std::string command;               // canonical
  Scene scene;                       // of the first trial that runs
  std::size_t available = 0;         // trials that the scene's sweep has
  std::size_t planned = 0;           // trials asked for; of a shard its own
  std::optional<SweepShard> shard;   // empty: the run is no part of another
  std::vector<TrialSummary> trials;  // finished, in order
  std::vector<FailedTrial> failed;   // the others, in order
  std::size_t resumed = 0;           // of the finished, those that an earlier run has simulated
  std::vector<std::string> damaged;  // batches that an earlier run had left damaged: their trials were simulated again
  bool was_complete = false;         // there was nothing to resume: the dataset is there, and whole; `trials` is empty
  std::size_t kept = 0;              // trials in `files`
  double simulated = 0.0;            // s, of the trials that this run has simulated
  double computed = 0.0;             // s, what their simulation took on the clock, summed over the workers
  double shortest_step = 0.0, longest_step = 0.0;  // s, of these trials; 0 where there is none
  bool interrupted = false;
  std::vector<std::string> files;  // written; the batches when interrupted
};

// The trials that a command chooses from.
struct PlannedTrials {
  TrialPlan plan;         // the scene's sweep, its cells repeated until there are at least options.limit
  std::size_t asked = 0;  // the first so many of them are asked for; options.only is one of these
};

// `file`: with options.overrides; `catalogues` must outlive what comes back; `seed`: the dataset's. Throws InputError as
// TrialPlan does, and when options.only is none of the trials asked for.
PlannedTrials plan_trials(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed);

// A sweep whose scene has been read and checked, once for all who look at it before and while it runs.
struct ReadSweep {
  SceneFile file;  // with the overrides
  std::uint64_t seed = 0;
  PlannedTrials planned;
};

// `catalogues` must outlive what comes back. Throws InputError as plan_trials() does, and where the scene cannot be read.
ReadSweep read_sweep(const SweepOptions& options, const Catalogues& catalogues);

// Runs action() where trials run: here, or where they are isolated in a child process. For what builds `trials` of them before the first one runs, and
// so may run code of others. Throws what it throws, and InputError where its process is lost.
std::string run_before_trials(const SweepOptions& options, std::size_t trials, const std::function<std::string()>& action);

// Takes away what a record does not hold where the outcome alone is kept: its empty columns.
void keep_outcome(TrialRecord& record);

// TrialPlan::Trial::drawn as a demo's attribute `params`.
std::string params_json(const std::vector<std::pair<std::string, std::string>>& drawn);

// What decides the bytes of a dataset, as a shell would be given it: no --jobs, no -o.
std::string canonical_command(const SweepOptions& options);

// A word as a shell has to be given it.
std::string shell_word(const std::string& word);

// Runs the sweep. A trial that fails is noted, in the summary and in the dataset, and the others run. Throws InputError for a
// scene or a target that cannot be used, and when options.only is none of its trials. What is finished when the target fails is
// kept in the folder OUT.h5.partial, which the message names. A scene that wishes for accuracy is a std::logic_error: its setting is
// found before (tools/program/cost). What is written does not depend on `jobs`.
SweepSummary run_sweep(const SweepOptions& options, const Catalogues& catalogues, const ProgressCallback& progress = {});
// The same; `read`: read_sweep(options, catalogues).
SweepSummary run_sweep(const ReadSweep& read, const SweepOptions& options, const Catalogues& catalogues,
                       const ProgressCallback& progress = {});

}  // namespace slipbench
