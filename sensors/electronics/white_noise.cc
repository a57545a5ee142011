#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

constexpr std::size_t bits = 12, levels = std::size_t{1} << bits;
constexpr std::size_t levels_a_draw = 4;  // of the upper 48 bits of a draw

// The middles of `levels` stretches of the normal distribution that are as likely as one another, scaled to a mean square of 1 (from 0.9995).
const std::array<double, levels>& quantiles() {
  static const std::array<double, levels> table = [] {
    std::array<double, levels> values{};
    double square = 0.0;
    for (std::size_t j = 0; j < levels / 2; ++j) {  // the lower half; the upper one is its mirror
      const double p = (static_cast<double>(j) + 0.5) / static_cast<double>(levels);
      double low = -10.0, high = 0.0;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle / std::numbers::sqrt2) < p ? low : high) = middle;
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

SLIPBENCH_DISPATCHED void add_scaled(std::size_t count, const double* sd, const double* drawn, float* values) {
  SLIPBENCH_VECTORISE
  for (std::size_t v = 0; v < count; ++v) values[v] = static_cast<float>(values[v] + sd[v] * drawn[v]);
}

class WhiteNoise final : public ElectronicsStage {
 public:
  WhiteNoise(const Parameters& parameters, const SignalModel& model, RandomStream stream)
      : source_(model.source), table_(quantiles().data()), stream_(stream) {
    for (const double sd : model.noise_sd) sd_.push_back(parameters.number("scale") * sd);
    const std::size_t draws = (model.sources + levels_a_draw - 1) / levels_a_draw;
    bits_.resize(draws + draws % 2);
    drawn_.resize(levels_a_draw * bits_.size());
    each_its_own_ = true;
    for (std::size_t v = 0; v < source_.size(); ++v) each_its_own_ = each_its_own_ && source_[v] == v;
  }

  void apply(std::span<float> values, double /*time*/) override {
    stream_.seek(static_cast<std::uint64_t>(samples_[0]) * (bits_.size() / 2));
    samples_[0] += 1.0;
    stream_.bits(bits_);
    double* drawn = drawn_.data();
    for (std::uint64_t draw : bits_) {
      draw >>= 64 - bits * levels_a_draw;
      for (std::size_t k = 0; k < levels_a_draw; ++k, draw >>= bits) *drawn++ = table_[draw % levels];
    }
    if (each_its_own_) {
      add_scaled(sd_.size(), sd_.data(), drawn_.data(), values.data());
      return;
    }
    for (std::size_t v = 0; v < sd_.size(); ++v) values[v] = static_cast<float>(values[v] + sd_[v] * drawn_[source_[v]]);
  }

  [[nodiscard]] std::span<double> memory() override { return samples_; }

 private:
  std::vector<std::size_t> source_;  // [V]
  std::vector<double> sd_;           // [V] in the value's unit
  const double* table_;
  std::vector<std::uint64_t> bits_;  // of the sample at hand, in pairs
  std::vector<double> drawn_;        // [sources], and what the last bits give beyond them
  bool each_its_own_;                // value v follows source v
  std::array<double, 1> samples_{};  // drawn so far
  RandomStream stream_;
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  return std::make_unique<WhiteNoise>(parameters, model, stream);
}

}  // namespace

PartKind white_noise_part() {
  return {.entry = {.name = "white_noise",
                    .summary = "white noise of many values: `noise` without its memory, at a tenth of its time",
                    .law = "y = x + scale*sd*n,  n: one of 4,096 quantiles of the normal distribution, drawn anew of each source "
                           "and sample;\n"
                           "mean square 1, none beyond 3.7; sd: of the value's noise",
                    .source = "the definition of white noise",
                    .parameters = {scale_parameter()}},
          .drawn_per = DrawnPer::trial,
          .make = &make};
}

}  // namespace slipbench
