// Values of one measure while they are gathered: for errors.cc and closed_form.cc.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "tools/program/cost/errors.h"

namespace slipbench {

class MeasureValues {
 public:
  void add(double value) { values_.push_back(value); }
  void add_count(std::size_t differing, std::size_t of);
  // A root mean square as a share of the reference's, of sums of squares over as many values. Where the reference's is 0 and the
  // run's not, it is 1, and different.
  void add_share(double squares, double of);
  // Onsets of a unit [s], NaN: never, and the time that its friction took to be used up [s]; `end` of the trial [s].
  void add_onsets(double in_run, double in_reference, double load_time, double end);
  // Divides all values gathered so far.
  void divide(double by);

  // Empty when nothing was added.
  [[nodiscard]] std::optional<MeasureError> error() const;

 private:
  std::vector<double> values_;
  bool different_ = false;
};

}  // namespace slipbench
