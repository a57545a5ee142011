#include "tools/program/train/confusion_matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tools/base/statistics/descriptive.h"

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<PadState, 3> classes{PadState::non_slip, PadState::incipient, PadState::gross};

bool is_slip(PadState state) { return state == PadState::incipient || state == PadState::gross; }

}  // namespace

void ConfusionMatrix::add(const ConfusionMatrix& other) {
  for (std::size_t t = 0; t < 3; ++t) {
    for (std::size_t c = 0; c < 3; ++c) counts_[t][c] += other.counts_[t][c];
  }
}

std::uint64_t ConfusionMatrix::total() const {
  std::uint64_t sum = 0;
  for (const auto& row : counts_) sum = std::accumulate(row.begin(), row.end(), sum);
  return sum;
}

double ConfusionMatrix::accuracy() const {
  const std::uint64_t all = total();
  if (all == 0) return nan;
  return static_cast<double>(counts_[0][0] + counts_[1][1] + counts_[2][2]) / static_cast<double>(all);
}

double ConfusionMatrix::recall(PadState truth) const {
  const auto& row = counts_[index(truth)];
  const std::uint64_t all = std::accumulate(row.begin(), row.end(), std::uint64_t{0});
  return all == 0 ? nan : static_cast<double>(row[index(truth)]) / static_cast<double>(all);
}

double ConfusionMatrix::balanced_accuracy() const {
  std::vector<double> recalls;
  for (const PadState state : classes) {
    if (const double share = recall(state); !std::isnan(share)) recalls.push_back(share);
  }
  return mean_sd(recalls).mean;
}

void Delays::add(std::span<const double> time, std::span<const PadState> called, double onset) {
  ++sequences;
  const bool slips = !std::isnan(onset);
  const auto first =
      slips ? static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), onset) - time.begin()) : time.size();
  if (std::any_of(called.begin(), called.begin() + static_cast<std::ptrdiff_t>(first), is_slip)) ++false_alarms;
  if (!slips) return;
  ++slipping;
  if (first > 0 && is_slip(called[first - 1])) {
    ++early;
    return;
  }
  const auto noticed = std::find_if(called.begin() + static_cast<std::ptrdiff_t>(first), called.end(), is_slip);
  if (noticed == called.end()) {
    ++missed;
  } else {
    delay.push_back(time[static_cast<std::size_t>(noticed - called.begin())] - onset);
  }
}

void Delays::add(const Delays& other) {
  delay.insert(delay.end(), other.delay.begin(), other.delay.end());
  early += other.early;
  missed += other.missed;
  false_alarms += other.false_alarms;
  slipping += other.slipping;
  sequences += other.sequences;
}

}  // namespace slipbench
