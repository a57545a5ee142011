#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/math.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

constexpr std::size_t bits = 12, levels = std::size_t{1} << bits;
constexpr std::size_t levels_a_draw = quad;  // from the upper 48 bits of a draw

// Midpoints of `levels` equally likely intervals of the normal distribution, scaled to a mean
// square of 1 (from 0.9995).
const std::array<double, levels>& quantiles() {
  static const std::array<double, levels> table = [] {
    std::array<double, levels> values{};
    double square = 0.0;
    for (std::size_t j = 0; j < levels / 2; ++j) {  // the lower half; the upper one is its mirror
      const double p = (static_cast<double>(j) + 0.5) / static_cast<double>(levels);
      double low = -10.0, high = 0.0;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        (0.5 * math::erfc(-middle / std::numbers::sqrt2) < p ? low : high) = middle;
      }
      values[j] = 0.5 * (low + high);
      square += values[j] * values[j] * 2.0 / static_cast<double>(levels);
    }
    for (std::size_t j = 0; j < levels / 2; ++j) {
      values[j] /= std::sqrt(square);
      values[levels - 1 - j] = -values[j];
    }
    return values;
  }();
  return table;
}

// Returns the four quantiles that a draw selects.
SLIPBENCH_INLINE Quad picked_by(std::uint64_t draw, const double* table) {
  const auto level = [draw](std::size_t k) { return draw >> (64 - bits * (levels_a_draw - k)) & (levels - 1); };
  return Quad{table[level(0)], table[level(1)], table[level(2)], table[level(3)]};
}

// Adds the quantiles selected by `draws`, times `sd`, to `count` values.
SLIPBENCH_DISPATCHED void add_picked(std::size_t count, const double* table, const std::uint64_t* draws, const double* sd,
                                     float* values) {
  std::size_t v = 0;
  for (; v + levels_a_draw <= count; v += levels_a_draw) {
    put_vector(values + v,
               __builtin_convertvector(widened(values + v) + vector_at<Quad>(sd + v) * picked_by(*draws++, table), QuadFloat));
  }
  if (v == count) return;
  const Quad left = picked_by(*draws, table);
  for (std::size_t k = 0; v < count; ++v, ++k) values[v] = static_cast<float>(values[v] + sd[v] * left[k]);
}

class WhiteNoise final : public ElectronicsStage {
 public:
  WhiteNoise(const Parameters& parameters, const SignalModel& model, RandomStream stream)
      : source_(model.source), table_(quantiles().data()), stream_(stream) {
    for (const double sd : model.noise_sd) sd_.push_back(parameters.number("scale") * sd);
    const std::size_t draws = (model.sources + levels_a_draw - 1) / levels_a_draw;
    draws_.resize(draws + draws % 2);
    each_its_own_ = true;
    for (std::size_t v = 0; v < source_.size(); ++v) each_its_own_ = each_its_own_ && source_[v] == v;
  }

  void apply(std::span<float> values, double /*time*/) override {
    stream_.seek(static_cast<std::uint64_t>(samples_[0]) * (draws_.size() / 2));
    samples_[0] += 1.0;
    stream_.bits(draws_);
    if (each_its_own_) {
      add_picked(sd_.size(), table_, draws_.data(), sd_.data(), values.data());
      return;
    }
    for (std::size_t v = 0; v < sd_.size(); ++v) {
      const Quad picked = picked_by(draws_[source_[v] / levels_a_draw], table_);
      values[v] = static_cast<float>(values[v] + sd_[v] * picked[source_[v] % levels_a_draw]);
    }
  }

  [[nodiscard]] std::span<double> memory() override { return samples_; }

 private:
  std::vector<std::size_t> source_;  // [V]
  std::vector<double> sd_;           // [V] in the value's unit
  const double* table_;
  std::vector<std::uint64_t> draws_;  // for the current sample, in pairs
  bool each_its_own_;                 // value v follows source v
  std::array<double, 1> samples_{};   // samples drawn so far
  RandomStream stream_;
};

}  // namespace

PartKind white_noise_part() {
  return {
      .entry =
          {.name = "white_noise",
           .summary = "White noise for many values: `noise` without correlation in time, at a tenth of the computing time.",
           .law =
               "y = x + scale*sd*n,  n: one of 4,096 quantiles of the normal distribution, drawn anew of each source and sample;\n"
               "mean square 1, none beyond 3.7; sd: of the value's noise",
           .source = "the definition of white noise",
           .parameters = {scale_parameter()}},
      .drawn_per = DrawnPer::trial,
      .make = made<WhiteNoise>};
}

}  // namespace slipbench
