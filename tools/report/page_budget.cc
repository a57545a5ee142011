#include "tools/report/page_budget.h"

#include <algorithm>
#include <set>

#include "tools/statistics/descriptive.h"

namespace slipbench::report {
namespace {

// Maximum size of a page [bytes]: fits into an e-mail and opens at once. Rows and curves share the
// space left by the scripts.
constexpr std::size_t page_bytes = 19'000'000;
constexpr std::size_t script_bytes = 700'000;
constexpr std::size_t least_curve_bytes = 2'000'000;  // minimum, even with the rows of very many trials

constexpr std::size_t least_curve_rows = 24;

}  // namespace

CurveRange curve_range(std::size_t columns, std::size_t samples) {
  const std::size_t finest = std::min(most_curve_values, columns * std::max<std::size_t>(1, samples));
  return {finest, std::min(finest, columns * least_curve_rows)};
}

PageBudget::PageBudget(const CurveRange& range, std::size_t coarsest_bytes, std::size_t trials, std::size_t row_bytes)
    : values_(range.finest), least_values_(range.coarsest) {
  const std::size_t taken = script_bytes + row_bytes;
  const std::size_t left = taken + least_curve_bytes < page_bytes ? page_bytes - taken : least_curve_bytes;
  const std::size_t least = coarsest_bytes * 11 / 10;  // other trials may be larger
  count_ = std::clamp<std::size_t>(left / least, 1, trials);
  each_ = left / count_;
}

bool PageBudget::accept(std::size_t bytes) {
  if (bytes <= each_ || values_ <= least_values_) return true;
  const double share = 0.9 * static_cast<double>(each_) / static_cast<double>(bytes);
  values_ = std::max(least_values_, static_cast<std::size_t>(share * static_cast<double>(values_)));
  return false;
}

std::vector<std::size_t> trials_with_curves(const std::vector<std::size_t>& trials, std::size_t count,
                                            const std::optional<std::size_t>& asked) {
  std::vector<std::size_t> chosen;
  for (const std::size_t k : evenly_spaced(trials.size(), count)) chosen.push_back(trials[k]);
  if (asked && std::find(chosen.begin(), chosen.end(), *asked) == chosen.end()) {
    const auto distance = [&](std::size_t trial) { return trial > *asked ? trial - *asked : *asked - trial; };
    *std::min_element(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); }) =
        *asked;
  }
  return chosen;
}

std::vector<std::size_t> trials_with_rows(const std::vector<std::size_t>& trials, const std::vector<std::size_t>& with_curves,
                                          std::size_t most) {
  std::set<std::size_t> chosen(with_curves.begin(), with_curves.end());
  const std::size_t count = std::min(most, trials.size());
  for (std::size_t i = 0; i < count; ++i) chosen.insert(trials[i * trials.size() / count]);
  return {chosen.begin(), chosen.end()};
}

}  // namespace slipbench::report
