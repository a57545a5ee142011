// How far a run is from a reference: the same trial of the same scene, simulated otherwise (another step, fidelity, solver,
// number of elements, output rate).
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
#include "tools/base/statistics/descriptive.h"
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
  double median = 0.0;  // over the same units, sensors or channels
  // Something happened in one of the two and not in the other; the figures are of all else.
  bool different = false;
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

// Values of one measure while they are gathered: for errors.cc and closed_form.cc.
class MeasureValues {
 public:
  void add(double value) { values_.push_back(value); }
  void add_count(std::size_t differing, std::size_t of) {
    if (of > 0) add(static_cast<double>(differing) / static_cast<double>(of));
  }
  // A root mean square as a share of the reference's, of sums of squares over as many values. Where the reference's is 0 and the
  // run's not, it is 1, and different.
  void add_share(double squares, double of) {
    if (of > 0.0) {
      add(std::sqrt(squares / of));
    } else if (squares > 0.0) {
      add(1.0);
      different_ = true;
    }
  }
  // Onsets of a unit [s], NaN: never, and the time that its friction took to be used up [s]; `end` of the trial [s].
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
  // Of a unit whose first slips in the two runs are two events, between which no time is an error.
  void add_other_event() { different_ = true; }
  // Divides all values gathered so far.
  void divide(double by) {
    for (double& value : values_) value /= by;
  }

  // Empty when nothing was added.
  [[nodiscard]] std::optional<MeasureError> error() const {
    if (values_.empty()) return different_ ? std::optional(MeasureError{0.0, 0.0, true}) : std::nullopt;
    return MeasureError{std::ranges::max(values_), median(values_), different_};
  }

 private:
  // Of a unit that slips in one run alone: how much of its loading time before the trial's end makes that a difference. Later,
  // its onset in the other run may well come right after the end.
  static constexpr double end_share = 0.01;

  std::vector<double> values_;
  bool different_ = false;
};

// Slip onset in closed form, where there is one: a reference that no step and no code of the field has a part in.
//
// An element on a plane sticks where it touched until its spring pulls harder than friction holds,
//   k_t |p(t) - p(t_touch)| = mu_s k_n d(t),
// with the motion's own place p of its tip along the plane and depth d of its tip in it. All springs of a pad are clamped to one
// body that moves as prescribed, so no element knows of another, and the first t that solves this is its onset exactly; mu_k has
// no part in it. For one pillar in translation at constant speed v it is mu_s f_n/(k_t v) after the start.
// A unit slips in part from the first onset of its elements on, and as a whole from the last one on if till then all that slipped
// go on.
struct ClosedForm {
  struct Onset {
    double time = std::numeric_limits<double>::quiet_NaN();  // s; NaN: never in the trial
    double load_time =
        least_load_time;  // s, twice the time since half of the friction was used up, or the time since the touch; no less
  };
  struct Unit {
    Onset micro, whole;
  };
  std::vector<std::vector<Unit>> units;  // [sensor][N]
};

// The onsets of one trial, resolved to rounding. Empty unless all of this holds: nothing moves by forces, the surface is a plane,
// there are no effects, mu_s > 0, pads have no dashpots, axes look at the plane throughout, and in every unit of several elements
// what slips goes on until all of it does (between the unit's first onset and its last, or the trial's end, each tip keeps its
// depth, moves, and never turns by 90 degrees or more from where it moved at first).
// Throws InputError as make_sensor() and make_motion() do.
std::optional<ClosedForm> closed_form(const Scene& scene, std::uint64_t trial);

// The measures onset and micro_onset of a run (Recording::outcome is enough) as compare() has them, against the closed form; no
// other measure applies.
Errors compare(const Scene& scene, const TrialResult& run, const ClosedForm& exact);

}  // namespace slipbench
