// `slipbench cost`: what accuracy costs in time, for a scene of the user's own.
//
// A trial of the scene is run with every setting of settings_to_try(). Each run is compared with a reference (errors.h): onsets with
// their closed form where there is one (closed_form), all else with a far finer run, whose own error is what it differs from
// one of twice its step. Then all that ran are timed, in rounds that go over all of them in turn, so that a drift of the machine
// meets all alike, until the budget is used up.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/base/page/page.h"
#include "tools/program/cost/errors.h"

namespace slipbench::cost {

// Which settings `slipbench cost` tries on a scene: each is a list of changes that a user could give with --set.
struct Setting {
  std::string series;             // name of its Series: "field"
  std::string label;              // within the series: "1 ms"
  std::vector<Override> changes;  // on top of the user's own; empty: the scene as it is
};

// Settings that differ in one thing and make one curve.
struct Series {
  std::string name;   // "field"
  std::string title;  // "element field, explicit"
  // The series' finest setting, the last, stands for the truth, and not the reference of the scene: the settings are other models of the
  // same sensor, which do not converge to the scene's own.
  bool own_reference = false;
};

const std::vector<Series>& all_series();
// That of a setting.
const Series& series_of(const Setting& setting);

// The fastest of the rates [Hz] that the scene's sensors are given; 0 where none has one.
double fastest_rate(const Scene& scene);

// Whether MuJoCo's own contact, which knows one coefficient of friction, has to take the static one for the kinetic one too.
bool one_friction(const Scene& scene);

// All settings that suit the scene, the scene's own not among them; those of a series from coarse to fine. What the scene's kind refuses
// as such (an integrator where nothing is integrated) is left out; what a scene could have and this one may not (a step that is too long)
// is not. `own`: the step of the fastest sensor's pad [s].
std::vector<Setting> settings_to_try(const Scene& scene, double own);

// The scene itself with a step of `time_step` [s], at its own output rate.
Setting finer(double time_step);

// A step as a scene writes it, exact: "0.05 ms".
std::string step_text(double time_step);
// The same for a person, to four digits: "227.3 us".
std::string short_text(double time_step);

struct ExploreOptions {
  std::string scene_path;
  std::vector<Override> overrides = {};
  std::optional<std::uint64_t> seed = {};  // empty: the scene's
  std::size_t trial = 0;                   // of the scene's sweep
  double budget = 60.0;                    // s on the clock
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say = {};  // told what is being done; may be empty
};

enum class Status {
  ok,
  refused,      // before the first step
  warning,      // of MuJoCo's: the run failed
  diverged,     // or went wrong otherwise
  over_budget,  // would have taken more than its share of the budget: not run
};
std::string_view status_name(Status status);  // "ok", "over budget"

// CPU time of a trial: building the bench, and all steps with sensors, detector and controller; nothing is recorded, but where
// the budget has room for no second run, and the first, which everything is recorded of, is all there is.
struct CpuTime {
  double median = 0.0;           // s
  double low = 0.0, high = 0.0;  // s, quartiles; NaN where fewer than least_repeats say nothing of the spread
  std::size_t repeats = 0;
};
inline constexpr std::size_t least_repeats = 3;

struct Row {
  Setting setting;
  bool own = false;     // the scene as it is
  double rate = 0.0;    // Hz, of the output: the fastest sensor's; 0: no sensor is given one
  std::string command;  // that runs it
  Status status = Status::ok;
  std::string why = {};  // it is not ok
  std::optional<CpuTime> cpu = {};
  Errors errors = {};               // of a row that is ok
  std::vector<Measure> front = {};  // by which nothing cheaper is as right

  [[nodiscard]] bool ok() const { return status == Status::ok; }
};

// The price of an effect or of a part of a sensor's electronics: the scene with it against the scene without.
struct Price {
  std::string name;  // "stribeck", "pad: noise"
  bool electronics = false;
  std::optional<CpuTime> without = {};  // CPU time of the trial without it; empty: it does not run
  std::string why = {};                 // it does not
  double share = 0.0;                   // of the scene's CPU time that goes with it
  double low = 0.0, high = 0.0;         // likewise, from the quartiles of both; NaN where one has none
  Errors changes = {};                  // of the scene without it, against the scene with it
  // Costs something that the quartiles tell from nothing, and changes no measure.
  [[nodiscard]] bool idle() const;
};

struct Reference {
  bool closed_onsets = false;  // onsets are compared with their closed form
  double time_step = 0.0;      // s, of the fine run
  std::string command;
  Errors own_error = {};   // the fine run's, estimated: what it differs from one of twice its step
  bool converged = false;  // every measure's is below converged_error()
};

// A fine run whose estimated error is above this is no reference to the promise of 0.1 %.
double converged_error(Measure measure);

struct Exploration {
  std::string scene_path;
  std::string description;
  std::string command;
  std::uint64_t seed = 0;
  std::size_t trial = 0;
  double budget = 0.0, elapsed = 0.0;  // s on the clock
  double simulated = 0.0;              // s, a trial
  Reference reference;
  std::vector<Row> rows;  // the scene's own first
  std::vector<Price> prices;
  bool wish_left_aside = false;  // the scene says `accuracy`, which would choose one setting
  bool one_friction = false;     // in MuJoCo's own contact the kinetic friction is the static one, and in the scene it is not
  bool interrupted = false;      // it ended early

  [[nodiscard]] const Row& own() const { return rows.front(); }
  // CPU time [s] a second of the trial.
  [[nodiscard]] double cost(const Row& row) const { return row.cpu->median / simulated; }
};

// Throws InputError for a scene that cannot be read or does not run as it is, and for a budget of less than budget_in_runs of its
// trials, and Interrupted where it was interrupted before there was a reference.
inline constexpr double budget_in_runs = 12.0;
Exploration explore(const ExploreOptions& options, const Catalogues& catalogues);

// Marks the rows by which nothing cheaper is as right, for every measure, among those that put out as often as the scene does.
void mark_fronts(Exploration& exploration);

// Whether a row puts out as often as the scene itself: others are cheaper for giving less.
bool as_often(const Exploration& exploration, const Row& row);

// Row of the least cost that puts out as often as the scene, whose worst error by the measure is at most `limit` and whose events
// are the reference's, or null. `only`: of that series, where it is empty of any but those with a reference of their own.
const Row* cheapest(const Exploration& exploration, Measure measure, double limit, std::string_view only = {});

// What there is to say in plain words: what 1 % and 0.1 % of each measure cost, what MuJoCo's own contact has to pay for the
// same, and which effects cost and change nothing.
std::vector<std::string> sentences(const Exploration& exploration);

// Three digits, no exponent above one: "1.25", "380", "19600".
std::string ratio_text(double ratio);

// "element field, 5 ms"
std::string setting_text(const Row& row);

// "costs 12 % and changes nothing", "costs 12 %; changes label most, by 3 %"
std::string verdict(const Price& price);

// Numbers in SI; shares of 1. README.md lists the keys. `environment`: environment_json().
Json cost_json(const Exploration& exploration, const Json& environment);

// The page of `slipbench cost`: what accuracy costs, what each effect costs, and how long a step stays stable.

// The files of web/, in the order in which the page loads them. Written by slipbench_embed().
const std::vector<page::Asset>& assets();

// One HTML page that needs no other file, of an exploration (its first key "slipbench_cost": 1; a stability map may stand in it as
// "stability") or of a stability map alone ("slipbench_stability": 1). Text of `result` is shown as text, never as markup. Throws
// std::logic_error where `result` begins with neither key.
std::string cost_page(const Json& result);

// The page, and either of the objects beside it.
inline constexpr page::PageKind page_kind{"an exploration",
                                          "slipbench cost",
                                          "page of slipbench cost",
                                          "result of slipbench cost",
                                          {"slipbench_cost", "slipbench_stability"}};

}  // namespace slipbench::cost
