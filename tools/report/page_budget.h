// The size of a page, and its division among the trials: which have rows in the overview, which have
// curves, and how fine those are.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace slipbench::report {

// Maximum number of values of one trial's curves, some 3 MB of noisy data.
inline constexpr std::size_t most_curve_values = 4'000'000;

// Numbers of values of one trial's curves.
struct CurveRange {
  std::size_t finest = 0;    // every sample, or most_curve_values
  std::size_t coarsest = 0;  // so few rows that curves with fewer would show little
};

// Range of a trial of `samples` rows of `columns` values.
CurveRange curve_range(std::size_t columns, std::size_t samples);

// Divides the size of a page among trials with curves. As many trials as possible have them while
// the curves of each are not coarser than the range allows. Unused space is not passed to other
// trials, so that all have the same resolution.
class PageBudget {
 public:
  // A page without curves.
  PageBudget() = default;
  // `range` and `coarsest_bytes` (size of the coarsest curves) are those of a representative trial.
  // `trials`: number of trials that may have curves, at least 1; `row_bytes`: size of the overview's
  // rows.
  PageBudget(const CurveRange& range, std::size_t coarsest_bytes, std::size_t trials, std::size_t row_bytes);

  // Number of trials with curves in the page.
  [[nodiscard]] std::size_t count() const { return count_; }
  // Number of values to give the curves of the next trial.
  [[nodiscard]] std::size_t curve_values() const { return values_; }
  // True if a trial's curves, made with curve_values(), may take `bytes`: they fit, or are as coarse
  // as they may be. Otherwise lowers curve_values() for this trial and the following ones.
  [[nodiscard]] bool accept(std::size_t bytes);

 private:
  std::size_t values_ = 0, least_values_ = 0;
  std::size_t count_ = 1;
  std::size_t each_ = 0;  // bytes of a trial's curves
};

// The trials with curves in the page, `count` of `trials`: evenly spaced, with `asked` in place of
// the nearest one.
std::vector<std::size_t> trials_with_curves(const std::vector<std::size_t>& trials, std::size_t count,
                                            const std::optional<std::size_t>& asked);

// The trials with rows in the overview, ascending: those with curves, and others evenly spaced so
// that at least `most` of `trials` (or all) are shown.
std::vector<std::size_t> trials_with_rows(const std::vector<std::size_t>& trials, const std::vector<std::size_t>& with_curves,
                                          std::size_t most);

}  // namespace slipbench::report
