// `slipbench cost`: measures the CPU time that accuracy costs, for a user's scene.
//
// A trial of the scene is run with every setting of settings_to_try(). Each run is compared with a
// reference (errors.h): onsets with their closed form if it exists (closed_form), everything else
// with a much finer run, whose own error is its difference from a run of twice its step. Then all
// successful settings are timed, in rounds over all of them, so that a drift of the machine affects
// all alike, until the budget is used up.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/cost/errors.h"
#include "tools/cost/settings.h"

namespace slipbench::cost {

struct ExploreOptions {
  std::string scene_path;
  std::vector<Override> overrides = {};
  std::optional<std::uint64_t> seed = {};  // empty: the scene's
  std::size_t trial = 0;                   // index in the scene's sweep
  double budget = 60.0;                    // s, wall-clock time
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say = {};  // called with the current activity; may be empty
};

enum class Status {
  ok,
  refused,      // by an InputError before the first step
  warning,      // MuJoCo warning: the run failed
  diverged,     // or failed in another way
  over_budget,  // not run: would have exceeded its share of the budget
};
std::string_view status_name(Status status);  // "ok", "over budget"

// CPU time of a trial: construction, and all steps with sensors, detector and controller, without
// recording. If the budget allows no second run, the time of the first, which records everything.
struct CpuTime {
  double median = 0.0;           // s
  double low = 0.0, high = 0.0;  // s, quartiles; NaN for fewer than least_repeats
  std::size_t repeats = 0;
};
inline constexpr std::size_t least_repeats = 3;

struct Row {
  Setting setting;
  bool own = false;     // the unchanged scene
  double rate = 0.0;    // Hz, output rate of the fastest sensor; 0: none is set
  std::string command;  // runs the setting
  Status status = Status::ok;
  std::string why = {};  // reason if it is not ok
  std::optional<CpuTime> cpu = {};
  Errors errors = {};               // only if ok
  std::vector<Measure> front = {};  // measures for which no cheaper row is as accurate

  [[nodiscard]] bool ok() const { return status == Status::ok; }
};

// Price of an effect or of a part of a sensor's electronics: the scene with it against the scene
// without it.
struct Price {
  std::string name;  // "stribeck", "pad: noise"
  bool electronics = false;
  std::optional<CpuTime> without = {};  // CPU time of the trial without it; empty: that does not run
  std::string why = {};                 // reason why that does not run
  double share = 0.0;                   // of the scene's CPU time that it takes
  double low = 0.0, high = 0.0;         // of `share`, from the quartiles of both; NaN if one has none
  Errors changes = {};                  // of the scene without it, against the scene with it
  // True if its cost is above zero by the quartiles and it changes no measure.
  [[nodiscard]] bool idle() const;
};

struct Reference {
  bool closed_onsets = false;  // onsets are compared with their closed form
  double time_step = 0.0;      // s, of the fine run
  std::string command;
  Errors own_error = {};   // estimated error of the fine run: its difference from one of twice its step
  bool converged = false;  // every measure is below converged_error()
};

// Largest estimated error of a fine run that can serve as a reference for a claim of 0.1 %.
double converged_error(Measure measure);

struct Exploration {
  std::string scene_path;
  std::string description;
  std::string command;
  std::uint64_t seed = 0;
  std::size_t trial = 0;
  double budget = 0.0, elapsed = 0.0;  // s, wall-clock time
  double simulated = 0.0;              // s, duration of a trial
  Reference reference;
  std::vector<Row> rows;  // the scene's own first
  std::vector<Price> prices;
  bool one_friction = false;  // MuJoCo's own contact uses the static friction as the kinetic one, unlike the scene
  bool interrupted = false;   // stopped early

  [[nodiscard]] const Row& own() const { return rows.front(); }
  // CPU time [s] per second of the trial.
  [[nodiscard]] double cost(const Row& row) const { return row.cpu->median / simulated; }
};

// Throws InputError for a scene that is unreadable or does not run unchanged, and for a budget of
// less than budget_in_runs trials; Interrupted if interrupted before there is a reference.
inline constexpr double budget_in_runs = 12.0;
Exploration explore(const ExploreOptions& options, const Catalogues& catalogues);

}  // namespace slipbench::cost
