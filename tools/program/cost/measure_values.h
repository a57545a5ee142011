// Values of one measure while they are gathered: for errors.cc and closed_form.cc.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "tools/base/statistics/descriptive.h"
#include "tools/program/cost/errors.h"

namespace slipbench {

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
  // Divides all values gathered so far.
  void divide(double by) {
    for (double& value : values_) value /= by;
  }

  // Empty when nothing was added.
  [[nodiscard]] std::optional<MeasureError> error() const {
    if (values_.empty()) return std::nullopt;
    return MeasureError{std::ranges::max(values_), median(values_), different_};
  }

 private:
  // Of a unit that slips in one run alone: how much of its loading time before the trial's end makes that a difference. Later,
  // its onset in the other run may well come right after the end.
  static constexpr double end_share = 0.01;

  std::vector<double> values_;
  bool different_ = false;
};

}  // namespace slipbench
