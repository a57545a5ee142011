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
#include "tools/page/page.h"

namespace slipbench::cost {

// Settings that `slipbench cost` tries on a scene: each is a list of changes that a user could give
// with --set.
struct Setting {
  std::string series;             // name of its Series: "field"
  std::string label;              // within the series: "1 ms"
  std::vector<Override> changes;  // applied after the user's own; empty: unchanged scene
};

// Settings that differ in one parameter and form one curve.
struct Series {
  std::string name;   // "field"
  std::string title;  // "element field, explicit"
  // True if the series' finest setting, the last, is its reference instead of the scene's: the
  // settings are other models of the same sensor, which do not converge to the scene's own.
  bool own_reference = false;
};

const std::vector<Series>& all_series();
// Series of a setting.
const Series& series_of(const Setting& setting);

// The highest rate [Hz] set for the scene's sensors; 0 if none is set.
double fastest_rate(const Scene& scene);

// True if MuJoCo's own contact, which has one coefficient of friction, must use the static one as
// the kinetic one too.
bool one_friction(const Scene& scene);

// All settings that suit the scene, except the scene's own; those of a series from coarse to fine.
// Omits what the kind of scene refuses in general (an integrator where nothing is integrated), but
// not what only this scene may refuse (a step that is too long). `own`: the step of the fastest
// sensor's pad [s].
std::vector<Setting> settings_to_try(const Scene& scene, double own);

// The scene with a step of `time_step` [s], at its own output rate.
Setting finer(double time_step);

// A step as in a scene file, exact: "0.05 ms".
std::string step_text(double time_step);
// A step for display, to four digits: "227.3 us".
std::string short_text(double time_step);

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
  bool wish_left_aside = false;  // the scene has `accuracy`, which would select one setting; ignored here
  bool one_friction = false;     // MuJoCo's own contact uses the static friction as the kinetic one, unlike the scene
  bool interrupted = false;      // stopped early

  [[nodiscard]] const Row& own() const { return rows.front(); }
  // CPU time [s] per second of the trial.
  [[nodiscard]] double cost(const Row& row) const { return row.cpu->median / simulated; }
};

// Throws InputError for a scene that is unreadable or does not run unchanged, and for a budget of
// less than budget_in_runs trials; Interrupted if interrupted before there is a reference.
inline constexpr double budget_in_runs = 12.0;
Exploration explore(const ExploreOptions& options, const Catalogues& catalogues);

// For every measure, marks the rows for which no cheaper row is as accurate, among those with at
// least the scene's output rate.
void mark_fronts(Exploration& exploration);

// True if a row has at least the scene's output rate: others are cheaper because they output less.
bool as_often(const Exploration& exploration, const Row& row);

// The cheapest row with at least the scene's output rate, a worst error by the measure of at most
// `limit` and the events of the reference; null if there is none. `only`: limits the search to that
// series; empty: all series without a reference of their own.
const Row* cheapest(const Exploration& exploration, Measure measure, double limit, std::string_view only = {});

// Summary in plain sentences: the cost of 1 % and 0.1 % of each measure, the cost of the same with
// MuJoCo's own contact, and effects that cost time and change nothing.
std::vector<std::string> sentences(const Exploration& exploration);

// Three digits, no exponent above one: "1.25", "380", "19600".
std::string ratio_text(double ratio);

// "element field, 5 ms"
std::string setting_text(const Row& row);

// "costs 12 % and changes nothing", "costs 12 %; changes label most, by 3 %"
std::string verdict(const Price& price);

// Numbers in SI; shares as fractions. README.md lists the keys. `environment`: environment_json().
Json cost_json(const Exploration& exploration, const Json& environment);

// The page of `slipbench cost`: the cost of accuracy and of each effect, and the longest stable
// steps.

// The files of web/ in the order of loading, generated by slipbench_embed().
const std::vector<page::Asset>& assets();

// One self-contained HTML page of an exploration (its first key is "slipbench_cost": 1; it may
// contain a stability map as "stability") or of a stability map alone ("slipbench_stability": 1).
// Text in `result` is shown as text, never as markup. Throws std::logic_error if `result` begins
// with neither key.
std::string cost_page(const Json& result);

// Page kind with either of the two objects.
inline constexpr page::PageKind page_kind{"an exploration",
                                          "slipbench cost",
                                          "page of slipbench cost",
                                          "result of slipbench cost",
                                          {"slipbench_cost", "slipbench_stability"}};

}  // namespace slipbench::cost
