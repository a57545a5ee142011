// The setting that a scene's wish for accuracy takes, kept beside the scene so that it is looked for once.
#pragma once

#include <functional>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/program/cost/errors.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

// What setting a scene's wish for accuracy takes: the cheapest one that meets it, told by the errors of its trials.
//
// Settings are tried in one order, that of the steps they take (an implicit step counts as `implicit_cost` explicit ones), and
// not by the clock, so that the choice is the same on any machine: fields with explicit springs from the longest step that
// divides the sampling time and is stable in the trials, halved from one to the next; where the scene's bodies move by forces and
// its solver is free, implicit springs likewise.
// A setting meets the wish when in every trial looked at the worst error is at most `margin` of what the wish allows, and nothing
// happens in one run alone. Errors are against the closed form where all that is wished for has one, else against a run whose
// step is an eighth of the longest or less: the same at twice that step is no farther off than `reference_share` of the wish,
// which bounds its own error as long as that shrinks at least in proportion to the step.
inline constexpr double margin = 0.5;
inline constexpr double reference_share = 0.1;
inline constexpr std::size_t implicit_cost = 4;       // what an implicit step costs, as a multiple of an explicit one (assumed)
inline constexpr std::size_t most_probed = 5;         // trials looked at, spread evenly over those asked for
inline constexpr std::size_t finest_reference = 512;  // the longest step over the shortest one of a reference

// One setting that was tried.
struct SettingLook {
  std::vector<Override> overrides;
  Errors errors;        // the worst of the trials looked at, up to the first that misses the wish
  std::string failure;  // why a trial could not be run; empty: all could
  bool met = false;
};

struct FoundSetting {
  std::vector<Override> overrides;  // what replaces the wish: accuracy, time_step and, where it is not explicit, field_solver
  std::vector<std::size_t> trials;  // of the plan, looked at
  std::string reference;            // as a person reads it: "closed form", "time_step 62.5 us"
  std::vector<Override> reference_overrides;  // exactly; empty: closed form
  Errors reference_errors;                    // of the reference, as estimated; empty: closed form
  std::vector<SettingLook> looks;             // in the order in which they were tried; the last one is what was found
};

// Empty where the scene wishes for nothing. `planned`: the trials that are to run, and thus the scene and the dataset's seed.
// Throws InputError, as "scene.yaml:3: ...", for a scene that cannot be run, for a wish for what never happens in the trials
// looked at, and for one that cannot be met: then it says what can.
std::optional<FoundSetting> find_setting(const PlannedTrials& planned);

// Settings as a person reads them, steps to four digits: "time_step 227.3 us, field_solver implicit".
std::string setting_text(const std::vector<Override>& overrides);

// An error in its measure's unit: "0.52 %".
std::string error_text(Measure measure, double value);

struct KeptSetting {
  std::vector<Override> overrides;  // to be given after the scene's own: the wish goes, what meets it comes
  std::string file;                 // where it stands with its evidence: SCENE.accuracy.json
  std::string text;                 // one line for a person
};

// The setting of a scene that wishes for one; empty where it does not, which costs no more than reading its YAML. It is taken
// from the file beside the scene where that holds one for just this scene (its text, the overrides, the seed, the bytes of its
// model and the program's version) and these trials (as many, of as many draws a cell). Else it is looked for (find_setting) and
// put there, and entries for another text of the scene go. `on_search` is called before it is looked for, which takes long, and
// may be empty.
// Of `sweep` what decides the trials counts: one trial alone (`only`) has the setting of those that it is one of.
// Throws InputError as plan_trials() and find_setting(), for a file that is damaged, and, before anything is looked for, where it
// cannot be written.
std::optional<KeptSetting> setting_for(const SweepOptions& sweep, const Catalogues& catalogues,
                                       const std::function<void()>& on_search = {});

}  // namespace slipbench
