// Errors of a run against a reference: the same trial of the same scene, simulated with another
// step, fidelity, solver, number of elements or output rate.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/run_trial.h"

namespace slipbench {

// Measures of error that matter to users. Values index Errors.
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

// Name and definition of one measure for reports.
struct MeasureInfo {
  Measure measure;
  std::string_view name;        // in `cost --accuracy` and in JSON: "slip_distance"
  std::string_view title;       // "slipped distance"
  std::string_view unit;        // displayed unit: "%" or "um/s"
  double factor;                // displayed value = factor times MeasureError's value
  std::string_view definition;  // one sentence
};

// All measures, in the order of enum Measure.
std::span<const MeasureInfo, num_measures> measure_table();
const MeasureInfo& info_of(Measure measure);

// One error. Shares are fractions (0.01: 1 %), creep is in m/s; finite.
struct MeasureError {
  double worst = 0.0;
  double median = 0.0;  // over the same units, sensors or channels
  // An event happened in only one of the two runs; the values cover everything else.
  bool different = false;
};

// By measure; empty if it does not apply: the reference has nothing of the kind, or the records
// have no common time.
using Errors = std::array<std::optional<MeasureError>, num_measures>;

inline std::optional<MeasureError>& at(Errors& errors, Measure measure) { return errors[static_cast<std::size_t>(measure)]; }
inline const std::optional<MeasureError>& at(const Errors& errors, Measure measure) {
  return errors[static_cast<std::size_t>(measure)];
}

// Compares two full records (Recording::full) of one trial by every measure of measure_table().
// `scene`: the reference's. Samples are compared at times that both records have to within
// rounding, without interpolation. Measures by unit omit a sensor whose number of units differs.
// Throws std::invalid_argument if the records have different sensors.
Errors compare(const Scene& scene, const TrialResult& run, const TrialResult& reference);

// Keeps the worse of two trials per measure: the larger `worst` and the larger `median`, and
// `different` if either has it. A measure that applies to one trial only is taken from it.
void keep_worst(Errors& errors, const Errors& other);

// Pairs of rows of `a` and `b` [s, ascending] with equal time, to within rounding, in order.
std::vector<std::pair<std::size_t, std::size_t>> common_rows(std::span<const double> a, std::span<const double> b);

// Time [s] in which a unit's friction limit is reached before `time` [s], extrapolated from the
// second half: the rate between the time at which the margin was half way between 1 and its value
// at the last sample before `time`, and that sample. For a load that grows in proportion to time it
// is the duration of the growth. For a unit that touched after half way it is the time since the
// touch; never less than least_load_time. `times`: [L] s. `margin`: [L] of the unit, NaN while it
// is detached.
double load_time(std::span<const double> times, std::span<const float> margin, double time);
inline constexpr double least_load_time = 10e-3;  // s

// Collects the values of one measure; for errors.cc and closed_form.cc.
class MeasureValues {
 public:
  void add(double value) { values_.push_back(value); }
  void add_count(std::size_t differing, std::size_t total) {
    if (total > 0) add(static_cast<double>(differing) / static_cast<double>(total));
  }
  // Adds a root mean square as a share of the reference's, from sums of squares over equally many
  // values. If the reference's is 0 and the run's is not, adds 1 and sets `different`.
  void add_share(double squares, double total) {
    if (total > 0.0) {
      add(std::sqrt(squares / total));
    } else if (squares > 0.0) {
      add(1.0);
      different_ = true;
    }
  }
  // Adds the onsets of a unit [s], NaN: never. `load_time`: time in which its friction limit was
  // reached [s]; `end` of the trial [s].
  void add_onsets(double in_run, double in_reference, double load_time, double end) {
    if (std::isnan(in_run) && std::isnan(in_reference)) return;
    if (std::isnan(in_run) || std::isnan(in_reference)) {
      const double left = end - (std::isnan(in_run) ? in_reference : in_run);
      add(std::max(0.0, left) / load_time);
      different_ = different_ || values_.back() > end_share;
    } else {
      add(std::abs(in_run - in_reference) / load_time);
    }
  }
  // Counts a unit whose first slips in the two runs are different events, so that their time
  // difference is not an error.
  void add_other_event() { different_ = true; }
  // Divides all values added so far.
  void divide(double by) {
    for (double& value : values_) value /= by;
  }

  // Empty if nothing was added.
  [[nodiscard]] std::optional<MeasureError> error() const {
    if (values_.empty()) return different_ ? std::optional(MeasureError{0.0, 0.0, true}) : std::nullopt;
    return MeasureError{std::ranges::max(values_), median(values_), different_};
  }

 private:
  // For a unit that slips in one run only: share of its loading time that must remain before the
  // trial's end. If less remains, its onset in the other run may simply come after the end.
  static constexpr double end_share = 0.01;

  std::vector<double> values_;
  bool different_ = false;
};

// Slip onset in closed form, where it exists: a reference independent of any step and of the
// field's code.
//
// An element on a plane sticks where it touched until its spring pulls harder than friction holds,
//   k_t |p(t) - p(t_touch)| = mu_s k_n d(t),
// with the prescribed position p of its tip along the plane and depth d of its tip in it. All
// springs of a pad are clamped to one body in prescribed motion, so the elements are independent,
// and the first t that solves this equation is the exact onset; mu_k does not matter. For one
// pillar in translation at constant speed v it is mu_s f_n/(k_t v) after the start.
// A unit slips in part from the first onset of its elements, and as a whole from the last one, if
// all elements that slipped keep slipping until then.
struct ClosedForm {
  struct Onset {
    double time = std::numeric_limits<double>::quiet_NaN();  // s; NaN: never in the trial
    double load_time =
        least_load_time;  // s, twice the time since half of the friction limit was reached, or the time since the touch; at least least_load_time
  };
  struct Unit {
    Onset micro, whole;
  };
  std::vector<std::vector<Unit>> units;  // [sensor][N]
};

// The onsets of one trial, exact to rounding. Empty unless all of this holds: no body moves by
// forces, the surface is a plane, there are no effects, mu_s > 0, pads have no dashpots, axes point
// at the plane throughout, and in every unit of several elements each slipping element keeps
// slipping until all do (between the unit's first onset and its last, or the trial's end, each tip
// keeps its depth, moves, and turns by less than 90 degrees from its first direction).
// Throws InputError as make_sensor() and make_motion() do.
std::optional<ClosedForm> closed_form(const Scene& scene, std::uint64_t trial);

// The measures onset and micro_onset of a run (Recording::outcome suffices) against the closed
// form, defined as in the other compare(); no other measure applies.
Errors compare(const Scene& scene, const TrialResult& run, const ClosedForm& exact);

}  // namespace slipbench
