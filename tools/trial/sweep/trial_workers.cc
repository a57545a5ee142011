#include "tools/trial/sweep/trial_workers.h"

#include <exception>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/reject.h"
#include "tools/trial/recorded_scene.h"
#include "tools/workers/child_process.h"
#include "tools/workers/ordered_children.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench {
namespace {

FinishedTrial run_one(const WorkPlan& plan, std::size_t index, TrialEncoder* encoder) {
  const InterruptScope scope(plan.interrupt);
  TrialPlan::Trial trial = plan.trials.trial(index);
  trial.scene.seed = plan.seed;
  const auto start = std::chrono::steady_clock::now();
  TrialResult result = run_trial(trial.scene, index, plan.recording, plan.max_bytes, plan.interrupt, plan.share);
  const std::chrono::duration<double> computed = std::chrono::steady_clock::now() - start;
  result.record.params = params_json(trial.drawn);
  result.record.material =
      split_group_text(result.record.material, experiments_of(trial.scene, trial.drawn, truth_sha256(result.record.sensors)));
  FinishedTrial finished{summary_of(result), trial.scene.duration, computed.count(), result.time_step, std::nullopt};
  if (plan.recording == Recording::outcome) keep_outcome(result.record);
  if (encoder != nullptr) finished.encoded = encoder->encode(result.record);
  return finished;
}

// Message of an error in trial `index`, with a line of the scene unless it names one already: that
// of the sensors, since no value of the scene is known to be the cause.
std::string located(const WorkPlan& plan, std::size_t index, const std::string& message) {
  const std::string where = plan.trials.where(index, "sensors");
  const bool names_line = message.starts_with(where.substr(0, where.rfind(':') + 1));
  return names_line ? message : where + ": " + message;
}

// As run_one(), with the trial's number and a line of the scene in errors.
FinishedTrial run_numbered(const WorkPlan& plan, std::size_t index, TrialEncoder* encoder) {
  try {
    return run_one(plan, index, encoder);
  } catch (const Interrupted&) {
    throw;
  } catch (const SceneValueError& error) {
    reject("trial {}: {}: {}", index, plan.trials.where(index, error.path()), error.what());
  } catch (const FailedRun& error) {
    reject("trial {}: {}: {}", index, plan.trials.where(index, "time_step"), error.what());
  } catch (const InputError& error) {
    reject("trial {}: {}", index, located(plan, index, error.what()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("trial {}: {}", index, error.what()));
  }
}

// Simulates the trial of a given number.
using Simulate = std::function<FinishedTrial(std::size_t)>;

Simulate simulation(const WorkPlan& plan, const SweepOptions& options) {
  std::shared_ptr<TrialEncoder> encoder = options.output.empty() ? nullptr : std::make_shared<TrialEncoder>();
  return [plan, encoder](std::size_t trial) {
    try {
      return run_numbered(plan, trial, encoder.get());
    } catch (const InputError& error) {
      return failed_trial(trial, error.what());
    }
  };
}

class WorkerThreads final : public TrialWorkers {
 public:
  WorkerThreads(std::vector<std::size_t> trials, std::size_t threads, const WorkPlan& plan, const SweepOptions& options,
                const HeldFiles& files)
      : trials_(std::move(trials)),
        workers_(
            trials_.size(), threads,
            [this, plan, &options, &files]() -> OrderedWorkers<FinishedTrial>::Work {
              return [this, &files, simulate = simulation(plan, options)](std::size_t index) {
                FinishedTrial finished = simulate(trials_[index]);
                files.check();  // the trial must have read the same files as all others
                return finished;
              };
            },
            options.interrupt) {}

  bool ready_until(std::chrono::steady_clock::time_point deadline) override { return workers_.ready_until(deadline); }
  std::optional<FinishedTrial> next() override { return workers_.next(); }
  void give_back(FinishedTrial trial) override { workers_.give_back(std::move(trial)); }

 private:
  std::vector<std::size_t> trials_;
  OrderedWorkers<FinishedTrial> workers_;
};

// One child process per trial, so that a crash fails only that trial.
class WorkerProcesses final : public TrialWorkers {
 public:
  WorkerProcesses(std::vector<std::size_t> trials, std::size_t jobs, const WorkPlan& plan, const SweepOptions& options,
                  const HeldFiles& files)
      : trials_(std::move(trials)),
        limit_(options.isolation.limit),
        files_(&files),
        children_(
            trials_.size(), jobs,
            [this, simulate = simulation(plan, options)](std::size_t index) { return to_message(simulate(trials_[index])); },
            options.interrupt, limit_, options.isolation.fork) {}

  bool ready_until(std::chrono::steady_clock::time_point deadline) override { return children_.ready_until(deadline); }
  std::optional<FinishedTrial> next() override {
    std::optional<ChildEnd> end = children_.next();
    if (!end) return std::nullopt;
    files_->check();
    return finished(trials_[delivered_++], std::move(*end));
  }
  void give_back(FinishedTrial) override {}

 private:
  [[nodiscard]] FinishedTrial finished(std::size_t trial, ChildEnd end) const {
    if (end.kind == ChildEnd::Kind::lost)
      return failed_trial(trial, fmt::format("trial {}: its worker process {}", trial, end.loss(limit_)));
    if (end.kind != ChildEnd::Kind::result) return failed_trial(trial, fmt::format("trial {}: {}", trial, end.text));
    try {
      return from_message(end.text);
    } catch (const std::exception&) {  // user code may write to any descriptor
      return failed_trial(trial, fmt::format("trial {}: its worker process returned an invalid result", trial));
    }
  }

  std::vector<std::size_t> trials_;
  std::size_t delivered_ = 0;
  double limit_;
  const HeldFiles* files_;
  OrderedChildren children_;
};

}  // namespace

// Recorded part of a trial; without a dataset, the outcome.
Recording recording_of(const SweepOptions& options) { return options.output.empty() ? Recording::outcome : options.recording; }

std::unique_ptr<TrialWorkers> make_workers(std::vector<std::size_t> trials, std::size_t jobs, const WorkPlan& plan,
                                           const SweepOptions& options, const HeldFiles& files) {
  if (options.isolation.on) return std::make_unique<WorkerProcesses>(std::move(trials), jobs, plan, options, files);
  return std::make_unique<WorkerThreads>(std::move(trials), jobs, plan, options, files);
}

}  // namespace slipbench
