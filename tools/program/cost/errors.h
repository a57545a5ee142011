// How far a run is from a reference: the same trial of the same scene, simulated otherwise (another step, fidelity, solver,
// number of elements, output rate).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

// What a user cares for. Values index Errors.
enum class Measure : std::size_t {
  onset,
  micro_onset,
  slip_distance,
  force,
  creep,
  label,
  label_micro,
  outcome,
  detector,
  signal,
};
inline constexpr std::size_t num_measures = 10;

// One measure as a report names and explains it.
struct MeasureInfo {
  Measure measure;
  std::string_view name;        // "slip_distance", as a scene's key `accuracy` and JSON have it
  std::string_view title;       // "slipped distance"
  std::string_view unit;        // "%" or "um/s": in which it is shown
  double factor;                // shown = factor times MeasureError's value
  std::string_view definition;  // one sentence
};

// All measures, in the order of enum Measure.
std::span<const MeasureInfo, num_measures> measure_table();
const MeasureInfo& info_of(Measure measure);

// One error. Shares are of 1 (0.01: 1 %), creep is in m/s; finite.
struct MeasureError {
  double worst = 0.0;
  double median = 0.0;     // over the same units, sensors or channels
  bool different = false;  // something happened in one of the two and not in the other
};

// By measure; empty: it does not apply, since nothing of the kind is in the reference, or no time is in both records.
using Errors = std::array<std::optional<MeasureError>, num_measures>;

inline std::optional<MeasureError>& at(Errors& errors, Measure measure) { return errors[static_cast<std::size_t>(measure)]; }
inline const std::optional<MeasureError>& at(const Errors& errors, Measure measure) {
  return errors[static_cast<std::size_t>(measure)];
}

// Compares two full records (Recording::full) of one trial by every measure: definitions stand in measure_table(). `scene`: the
// reference's. What goes sample by sample is compared at the times that both records have to within rounding; nothing is
// interpolated. Measures by unit leave out a sensor that has another number of units in the two. Throws std::invalid_argument
// when the two have not the same sensors.
Errors compare(const Scene& scene, const TrialResult& run, const TrialResult& reference);

// The worst of two trials: by measure the larger `worst` and the larger `median`, `different` where either is. A measure that
// applies to one of them alone is that one's.
void keep_worst(Errors& errors, const Errors& other);

// Rows of `a` and of `b` [s, ascending] that are at one time, to within rounding, in order.
std::vector<std::pair<std::size_t, std::size_t>> common_rows(std::span<const double> a, std::span<const double> b);

// The time that a unit's friction took to be used up before `time` [s], had it been used up all along as fast as from half way
// between 1 and the unit's margin at the last sample before `time` down to that: of a load that grows in proportion to time, how
// long it has grown. Of a unit that touched later than half way it is the time since, and never less than least_load_time.
// `times`: [L] s. `margin`: [L] of the unit, NaN while it is detached.
double load_time(std::span<const double> times, std::span<const float> margin, double time);
inline constexpr double least_load_time = 10e-3;  // s

}  // namespace slipbench
