// Finds the cheapest setting of a scene with which its trials have a required accuracy.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/cost/errors.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

// Settings are tried in order of their number of steps (an implicit step counts as `implicit_cost`
// explicit ones), not of measured time, so that the choice is the same on any machine. They are
// fields with explicit springs, from the longest step that divides the sampling time and is stable
// in the trials, halved each time; if the scene's bodies move by forces and it does not name a solver,
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

// A required accuracy: the largest allowed error of a measure.
struct Requirement {
  Measure measure;
  double limit;  // SI; a share as 0.01
};
// Returns the requirement "onset=1 %", written as for --accuracy. Throws InputError for an unknown
// measure and for a value that does not fit.
Requirement parse_requirement(const std::string& text);

// One setting that was tried.
struct TriedSetting {
  std::vector<Override> overrides;
  Errors errors;        // worst of the examined trials, up to the first that misses the requirement
  std::string failure;  // reason why a trial could not run; empty: all ran
  bool met = false;
};

struct FoundSetting {
  std::vector<Override> overrides;            // replacements: time_step and, if implicit, field_solver
  std::vector<std::size_t> trials;            // examined trials of the plan
  std::string reference;                      // as text: "closed form", "time_step 62.5 us"
  std::vector<Override> reference_overrides;  // exact; empty: closed form
  Errors reference_errors;                    // estimated errors of the reference; empty: closed form
  std::vector<TriedSetting> tried;            // in the order of trying; the last one was accepted
};

// `read`: the scene and the trials to run. `required`: at least one. Throws InputError for an invalid
// scene and for one whose sweep varies the step or the solver, with the line of the scene; for a
// requirement on an event that never happens in the examined trials; and for one that cannot be met,
// with the least error that can be.
FoundSetting find_setting(const ReadSweep& read, const std::vector<Requirement>& required);

// Settings as text, steps to four digits: "time_step 227.3 us, field_solver implicit".
std::string setting_text(const std::vector<Override>& overrides);

// An error in its measure's unit: "0.52 %".
std::string error_text(Measure measure, double value);

}  // namespace slipbench
