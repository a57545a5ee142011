// Finds the setting that meets a scene's accuracy requirement, and stores it next to the scene.
#pragma once

#include <functional>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/cost/errors.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

// The cheapest setting that meets a scene's accuracy requirement, by the errors of its trials.
//
// Settings are tried in order of their number of steps (an implicit step counts as `implicit_cost`
// explicit ones), not of measured time, so that the choice is the same on any machine. They are
// fields with explicit springs, from the longest step that divides the sampling time and is stable
// in the trials, halved each time; if the scene's bodies move by forces and its solver is free,
// implicit springs likewise.
// A setting is accepted if in every examined trial the worst error is at most `margin` of the
// required one, and no event happens in one run alone. Errors are against the closed form if all
// required measures have one, else against a run whose step is at most an eighth of the longest.
// The same run at twice that step differs by at most `reference_share` of the requirement, which
// bounds the reference's own error if the error shrinks at least in proportion to the step.
inline constexpr double margin = 0.5;
inline constexpr double reference_share = 0.1;
inline constexpr std::size_t implicit_cost = 4;       // assumed cost of an implicit step, in explicit ones
inline constexpr std::size_t most_probed = 5;         // examined trials, spread evenly over the requested ones
inline constexpr std::size_t finest_reference = 512;  // longest step divided by the shortest one of a reference

// One setting that was tried.
struct SettingLook {
  std::vector<Override> overrides;
  Errors errors;        // worst of the examined trials, up to the first that misses the requirement
  std::string failure;  // reason why a trial could not run; empty: all ran
  bool met = false;
};

struct FoundSetting {
  std::vector<Override> overrides;            // replacements: accuracy, time_step and, if implicit, field_solver
  std::vector<std::size_t> trials;            // examined trials of the plan
  std::string reference;                      // as text: "closed form", "time_step 62.5 us"
  std::vector<Override> reference_overrides;  // exact; empty: closed form
  Errors reference_errors;                    // estimated errors of the reference; empty: closed form
  std::vector<SettingLook> looks;             // in the order of trying; the last one was accepted
};

// Empty if the scene has no accuracy requirement. `planned`: the trials to run, which determine the
// scene and the dataset's seed. Throws InputError, as "scene.yaml:3: ...", for an invalid scene,
// for a requirement on an event that never happens in the examined trials, and for one that cannot
// be met, stating what can.
std::optional<FoundSetting> find_setting(const PlannedTrials& planned);

// Settings as text, steps to four digits: "time_step 227.3 us, field_solver implicit".
std::string setting_text(const std::vector<Override>& overrides);

// An error in its measure's unit: "0.52 %".
std::string error_text(Measure measure, double value);

struct KeptSetting {
  std::vector<Override> overrides;  // to be applied after the scene's own; they replace the requirement
  std::string file;                 // file that stores it with its evidence: SCENE.accuracy.json
  std::string text;                 // one line for the user
};

// Returns the setting of a scene with an accuracy requirement; empty without one, at the cost of
// reading the scene's YAML. The setting is read from the file next to the scene if the file has an
// entry for this scene (its text, the overrides, the seed, the bytes of its model and the program's
// version) and these trials (their number, and draws per cell). Otherwise it is searched
// (find_setting) and stored, and entries for other texts of the scene are removed. `on_search` is
// called before a search, which takes long, and may be empty.
// Only the parts of `sweep` that determine the trials matter: a single trial (`only`) has the
// setting of the sweep it belongs to.
// Throws InputError as plan_trials() and find_setting() do, for a damaged file, and, before any
// search, for a file that cannot be written.
std::optional<KeptSetting> setting_for(const SweepOptions& sweep, const Catalogues& catalogues,
                                       const std::function<void()>& on_search = {});

}  // namespace slipbench
