#include "tools/program/cost/measure_values.h"

#include <algorithm>

#include "tools/base/statistics/descriptive.h"

namespace slipbench {
namespace {

// Of a unit that slips in one run alone: how much of its loading time before the trial's end makes that a difference. Later, its
// onset in the other run may well come right after the end.
constexpr double end_share = 0.01;

}  // namespace

void MeasureValues::add_count(std::size_t differing, std::size_t of) {
  if (of > 0) add(static_cast<double>(differing) / static_cast<double>(of));
}

void MeasureValues::add_share(double squares, double of) {
  if (of > 0.0) {
    add(std::sqrt(squares / of));
  } else if (squares > 0.0) {
    add(1.0);
    different_ = true;
  }
}

void MeasureValues::add_onsets(double in_run, double in_reference, double load_time, double end) {
  if (std::isnan(in_run) && std::isnan(in_reference)) return;
  if (std::isnan(in_run) || std::isnan(in_reference)) {
    const double left = end - (std::isnan(in_run) ? in_reference : in_run);
    add(std::max(0.0, left) / load_time);
    different_ = different_ || values_.back() > end_share;
  } else {
    add(std::abs(in_run - in_reference) / load_time);
  }
}

void MeasureValues::divide(double by) {
  for (double& value : values_) value /= by;
}

std::optional<MeasureError> MeasureValues::error() const {
  if (values_.empty()) return std::nullopt;
  return MeasureError{std::ranges::max(values_), median(values_), different_};
}

}  // namespace slipbench
