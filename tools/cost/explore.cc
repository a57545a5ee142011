#include "tools/cost/explore.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/scene/scene_reader.h"
#include "tools/cost/reading.h"
#include "tools/files/reject.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench::cost {
namespace {

// Shares of the budget: at most reference_share for the two reference runs, setting_share for three
// repeats of one setting.
constexpr double reference_share = 0.15;
constexpr double setting_share = 0.1;
// Share of the budget for the first runs of all settings; the rest is for timing.
constexpr double trying_share = 0.5;

// A short run is repeated for this long, so that its median is as reliable as that of a long one.
constexpr double turn = 0.01;  // s

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

bool warned(std::string_view why) { return why.find("MuJoCo warns") != std::string_view::npos; }

constexpr std::array reference_divisors{64, 32, 16, 8, 4, 2};

double cpu_clock() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Replaces the onsets of `errors` by those of `exact`.
void take_onsets(const Errors& exact, Errors& errors) {
  for (const Measure measure : {Measure::onset, Measure::micro_onset}) at(errors, measure) = at(exact, measure);
}

// A repeated run: of a setting, or of the scene without an effect.
struct Job {
  Scene scene;
  std::vector<double> seconds = {};  // CPU time of each timed run
  double first = 0.0;                // s, CPU time of the run that was recorded
  double expected = 0.0;             // s, wall-clock time of the next run
};

CpuTime cpu_time(const Job& job) {
  if (job.seconds.empty()) return {job.first, nan, nan, 1};
  const bool few = job.seconds.size() < least_repeats;
  return {median(job.seconds), few ? nan : quantile(job.seconds, 0.25), few ? nan : quantile(job.seconds, 0.75),
          job.seconds.size()};
}

class Explorer {
 public:
  Explorer(const ExploreOptions& options, const Catalogues& catalogues)
      : options_(options), catalogues_(catalogues), start_(Clock::now()) {}

  Exploration run() {
    const InterruptScope scope(options_.interrupt);
    result_.scene_path = options_.scene_path;
    result_.budget = options_.budget;
    result_.trial = options_.trial;
    run_own();
    result_.seed = seed_;
    run_reference();
    end_if(options_.interrupt);
    try {
      try_all();
      price_all();
      time_all();
    } catch (const Interrupted&) {  // the interrupted run does not count
    }
    sum_up();
    mark_fronts(result_);
    result_.interrupted = interrupted();
    result_.elapsed = since(start_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }
  [[nodiscard]] double left() const { return options_.budget - since(start_); }
  void say(const std::string& what) const {
    if (options_.say) options_.say(what);
  }

  [[nodiscard]] std::vector<Override> changes_of(const Setting& setting) const {
    std::vector<Override> all = options_.overrides;
    all.insert(all.end(), setting.changes.begin(), setting.changes.end());
    return all;
  }

  [[nodiscard]] std::string command_of(const Setting& setting) const {
    SweepOptions sweep;
    sweep.verb = "run";
    sweep.scene_path = options_.scene_path;
    sweep.overrides = changes_of(setting);
    sweep.seed = options_.seed;
    if (options_.trial > 0) sweep.only = options_.trial;
    return canonical_command(sweep);
  }

  // Throws InputError if the changes do not fit the scene.
  [[nodiscard]] Scene scene_of(const Setting& setting) const {
    SceneFile file = SceneFile::load(options_.scene_path);
    for (const Override& change : changes_of(setting)) file.apply(change);
    const TrialPlan plan(file, catalogues_, 0, seed_);
    if (options_.trial >= plan.size()) {
      reject("cost: --trial is {}; allowed: 0 to {}, the trials of the scene's sweep", options_.trial, plan.size() - 1);
    }
    Scene scene = plan.trial(options_.trial).scene;
    scene.seed = seed_;
    try {
      check_trial(scene, options_.trial);
    } catch (const SceneValueError& error) {
      throw InputError(plan.where(options_.trial, error.path()) + ": " + error.what());
    }
    return scene;
  }

  TrialResult timed_run(Job& job, Recording recording) const {
    const double begin = cpu_clock(), on_clock = since(start_);
    TrialResult result = run_trial(job.scene, options_.trial, recording, max_record_bytes, options_.interrupt);
    const double seconds = cpu_clock() - begin;
    if (recording == Recording::outcome) {
      job.seconds.push_back(seconds);
    } else {
      job.first = seconds;
    }
    job.expected = since(start_) - on_clock;
    return result;
  }

  void run_own() {
    SceneFile file = SceneFile::load(options_.scene_path);
    for (const Override& change : options_.overrides) file.apply(change);
    seed_ = options_.seed.value_or(read_seed(file.root()));
    Row row{.setting = {"own", "the scene", {}}, .own = true, .command = command_of({})};
    Job job{scene_of({})};
    say("the scene as it is");
    own_ = timed_run(job, Recording::full);
    if (budget_in_runs * job.expected > options_.budget) {
      reject("cost: --budget is {:.3g} s, but a trial of {} takes {:.2g} s; allowed: at least {:.3g} s", options_.budget,
             options_.scene_path, job.expected, std::ceil(budget_in_runs * job.expected));
    }
    own_ = timed_run(job, Recording::full);  // repeated: the first run filled the caches
    timed_run(job, Recording::outcome);
    row.setting.label = short_text(own_.time_step);
    result_.simulated = job.scene.duration;
    result_.description = job.scene.description;
    result_.one_friction = one_friction(job.scene);
    row.rate = fastest_rate(job.scene);
    result_.rows.push_back(std::move(row));
    jobs_.push_back(std::move(job));
  }

  void run_reference() {
    const double own = jobs_.front().expected;
    int divisor = reference_divisors.back();
    for (const int candidate : reference_divisors) {
      if (1.5 * candidate * own > reference_share * options_.budget) continue;
      divisor = candidate;
      break;
    }
    const double fine = own_.time_step / divisor;
    say(fmt::format("the reference, {}", short_text(fine)));
    const Setting setting = finer(fine), half = finer(2.0 * fine);
    Job fine_job{scene_of(setting)};
    reference_ = timed_run(fine_job, Recording::full);
    Job half_job{scene_of(half)};
    const TrialResult coarser = divisor == 2 ? own_ : timed_run(half_job, Recording::full);

    Reference& reference = result_.reference;
    reference.time_step = fine;
    reference.command = command_of(setting);
    reference.own_error = compare(fine_job.scene, coarser, reference_);
    exact_ = closed_form(jobs_.front().scene, options_.trial);
    reference.closed_onsets = exact_.has_value();
    if (exact_) take_onsets({}, reference.own_error);
    reference.converged = true;
    for (const MeasureInfo& info : measure_table()) {
      const std::optional<MeasureError>& error = at(reference.own_error, info.measure);
      if (error && (error->different || error->worst > converged_error(info.measure))) reference.converged = false;
    }
    result_.rows.front().errors = errors_of(own_);
  }

  [[nodiscard]] Errors errors_of(const TrialResult& run) const {
    const Scene& scene = jobs_.front().scene;
    Errors errors = compare(scene, run, reference_);
    if (exact_) take_onsets(compare(scene, run, *exact_), errors);
    return errors;
  }

  // Runs a setting for the first time; returns nothing if it fails, with the reason in the row.
  std::optional<TrialResult> try_setting(Row& row, Job& job) {
    try {
      job.scene = scene_of(row.setting);
    } catch (const InputError& error) {
      row.why = error.what();
      row.status = warned(row.why) ? Status::warning : Status::refused;  // tips that settle before the first step may diverge
      return std::nullopt;
    }
    // The time is proportional to the number of steps, by the fastest run of the series, so that
    // one stalled run does not affect the others.
    job.expected = job.scene.time_step && pace_ ? *pace_ / *job.scene.time_step : 0.0;
    if (static_cast<double>(least_repeats) * job.expected > setting_share * options_.budget) {
      row.status = Status::over_budget;
      row.why = fmt::format("{:.2g} s per run, estimated from the fastest run of the series: more than 1/30 of the budget",
                            job.expected);
      return std::nullopt;
    }
    try {
      TrialResult run = timed_run(job, Recording::full);
      pace_ = std::min(pace_.value_or(infinite), job.expected * run.time_step);
      return run;
    } catch (const InputError& error) {
      row.why = error.what();
      row.status = warned(row.why) ? Status::warning : Status::diverged;
      return std::nullopt;
    }
  }

  void try_all() {
    const double begin = since(start_);
    std::vector<std::pair<std::size_t, TrialResult>> apart;  // rows to compare with the last row of their series
    for (Setting& setting : settings_to_try(jobs_.front().scene, own_.time_step)) {
      if (interrupted()) return;
      const Series& series = series_of(setting);
      if (setting.series != series_at_hand_) {
        say(series.title);
        series_at_hand_ = setting.series;
        pace_.reset();
      }
      Row row{.setting = std::move(setting), .command = {}};
      Job job;
      row.command = command_of(row.setting);
      std::optional<TrialResult> run;
      if (since(start_) - begin > trying_share * options_.budget) {
        row.status = Status::over_budget;
        row.why = "the budget for trying settings is used up";
      } else {
        run = try_setting(row, job);
      }
      if (run && series.own_reference) {
        apart.emplace_back(result_.rows.size(), std::move(*run));
      } else if (run) {
        row.errors = errors_of(*run);
      }
      row.rate = fastest_rate(job.scene);
      result_.rows.push_back(std::move(row));
      jobs_.push_back(std::move(job));
    }
    for (std::size_t k = 0, last = 0; k < apart.size(); ++k) {
      const auto series = [&](std::size_t i) { return result_.rows[apart[i].first].setting.series; };
      while (last < k || (last + 1 < apart.size() && series(last + 1) == series(k))) ++last;
      if (last == k) continue;
      const auto& [finest, reference] = apart[last];
      result_.rows[apart[k].first].errors = compare(jobs_[finest].scene, apart[k].second, reference);
    }
  }

  void price_all() {
    const Scene scene = jobs_.front().scene;
    for (std::size_t i = 0; i < scene.effects.size() && !interrupted(); ++i) {
      say("without " + scene.effects[i].name);
      Scene without = scene;
      without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(i));
      price({.name = scene.effects[i].name}, std::move(without));
    }
    for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
      const SensorScene& sensor = scene.sensors[s];
      for (std::size_t i = 0; i < sensor.electronics.size() && !interrupted(); ++i) {
        say("without " + sensor.electronics[i].name);
        Scene without = scene;
        without.sensors[s].electronics.erase(without.sensors[s].electronics.begin() + static_cast<std::ptrdiff_t>(i));
        price({.name = sensor.name + ": " + sensor.electronics[i].name, .electronics = true}, std::move(without));
      }
    }
  }

  void price(Price price, Scene without) {
    Job job{std::move(without)};
    try {
      check_trial(job.scene, options_.trial);
      price.changes = compare(jobs_.front().scene, timed_run(job, Recording::full), own_);
    } catch (const InputError& error) {
      price.why = error.what();
    }
    result_.prices.push_back(std::move(price));
    price_jobs_.push_back(std::move(job));
  }

  // Repeats all jobs in rounds, each starting one job later, until no run fits into the remaining
  // budget. The first round goes from the cheapest to the most expensive, so that a short budget
  // omits the most expensive ones.
  void time_all() {
    std::vector<Job*> jobs;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (result_.rows[i].ok()) jobs.push_back(&jobs_[i]);
    }
    for (std::size_t i = 0; i < price_jobs_.size(); ++i) {
      if (result_.prices[i].why.empty()) jobs.push_back(&price_jobs_[i]);
    }
    std::ranges::stable_sort(jobs, {}, &Job::expected);
    say(fmt::format("timing {} alternately for {:.0f} s", counted(jobs.size(), "setting"), std::max(0.0, left())));
    bool any = true;
    for (std::size_t round = 0; any; ++round) {
      any = false;
      for (std::size_t k = 0; k < jobs.size(); ++k) {
        if (interrupted()) return;
        Job& job = *jobs[(k + round) % jobs.size()];
        if (job.expected > left()) continue;
        const double begin = since(start_);
        do {
          timed_run(job, Recording::outcome);
        } while (since(start_) - begin + job.expected < std::min(turn, left()));
        any = true;
      }
    }
  }

  void sum_up() {
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (result_.rows[i].ok()) result_.rows[i].cpu = cpu_time(jobs_[i]);
    }
    const CpuTime with = cpu_time(jobs_.front());
    for (std::size_t i = 0; i < price_jobs_.size(); ++i) {
      Price& price = result_.prices[i];
      if (!price.why.empty()) continue;
      const CpuTime without = cpu_time(price_jobs_[i]);
      price.without = without;
      price.share = 1.0 - without.median / with.median;
      price.low = 1.0 - without.high / with.low;
      price.high = 1.0 - without.low / with.high;
    }
  }

  const ExploreOptions& options_;
  const Catalogues& catalogues_;
  Clock::time_point start_;
  std::uint64_t seed_ = 0;
  Exploration result_;
  std::vector<Job> jobs_;        // of the rows, in the same order
  std::vector<Job> price_jobs_;  // of the prices
  TrialResult own_;
  TrialResult reference_;
  std::optional<ClosedForm> exact_;
  // For the current series: the least wall-clock time of a run times its step [s2]; empty: none has
  // run.
  std::string series_at_hand_;
  std::optional<double> pace_;
};

}  // namespace

std::string_view status_name(Status status) {
  constexpr std::array<std::string_view, 5> names{"ok", "refused", "warning", "diverged", "over budget"};
  return names.at(static_cast<std::size_t>(status));
}

double converged_error(Measure measure) { return measure == Measure::creep ? 1e-8 : 1e-3; }

bool Price::idle() const {
  if (!why.empty() || !(low > 0.0)) return false;
  return std::ranges::none_of(
      changes, [](const std::optional<MeasureError>& change) { return change && (change->different || change->worst > 0.0); });
}

Exploration explore(const ExploreOptions& options, const Catalogues& catalogues) { return Explorer(options, catalogues).run(); }

}  // namespace slipbench::cost
