#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

// Adding and subtracting this constant rounds a number below 2^51 to the nearest even integer, like
// std::nearbyint but without a call.
constexpr double to_whole = 0x1.8p52;

// Returns true if a value was beyond the codes 0 to `last_code`.
SLIPBENCH_DISPATCHED bool convert(std::size_t count, const double* lowest, const double* step, double last_code, float* values) {
  std::uint64_t beyond = 0;
  SLIPBENCH_VECTORISE
  for (std::size_t v = 0; v < count; ++v) {
    const double code = ((values[v] - lowest[v]) / step[v] + to_whole) - to_whole;
    const double held = std::min(std::max(code, 0.0), last_code);
    beyond |= held != code ? 1U : 0U;
    values[v] = static_cast<float>(lowest[v] + step[v] * held);
  }
  return beyond != 0;
}

// Does the same for values in codes: from 0, in steps of 1.
SLIPBENCH_DISPATCHED bool round_codes(std::size_t count, double last_code, float* values) {
  std::uint64_t beyond = 0;
  SLIPBENCH_VECTORISE
  for (std::size_t v = 0; v < count; ++v) {
    const double code = (values[v] + to_whole) - to_whole;
    const double held = std::min(std::max(code, 0.0), last_code);
    beyond |= held != code ? 1U : 0U;
    values[v] = static_cast<float>(held);
  }
  return beyond != 0;
}

class Quantisation final : public ElectronicsStage {
 public:
  Quantisation(const Parameters& parameters, const SignalModel& model) {
    if (model.converter.size() != model.source.size())
      throw std::logic_error("quantisation: a value without a converter's range");
    const double codes = std::ldexp(1.0, static_cast<int>(parameters.integer("bits"))) - 1.0;
    for (const ConverterRange& range : model.converter) {
      lowest_.push_back(range.lowest);
      step_.push_back((range.highest - range.lowest) / codes);
    }
    last_code_ = codes;
    in_codes_ = std::ranges::all_of(lowest_, [](double lowest) { return lowest == 0.0; }) &&
                std::ranges::all_of(step_, [](double step) { return step == 1.0; });
  }

  void apply(std::span<float> values, double /*time*/) override {
    const bool beyond = in_codes_ ? round_codes(values.size(), last_code_, values.data())
                                  : convert(values.size(), lowest_.data(), step_.data(), last_code_, values.data());
    if (beyond) ++saturated_;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return saturated_; }

 private:
  std::vector<double> lowest_, step_;  // [V] in the value's unit
  double last_code_ = 0.0;
  bool in_codes_ = false;  // the sensor's unit is the code
  std::uint64_t saturated_ = 0;
};

}  // namespace

PartKind quantisation_part() {
  return {
      .entry =
          {.name = "quantisation",
           .summary = "The converter: rounds each value to one of 2^bits levels and clips it to the range.",
           .law = "y = lowest + q*c,  c = round((x - lowest)/q), not below 0, not above 2^bits - 1,\n"
                  "q = (highest - lowest)/(2^bits - 1)\n"
                  "lowest, highest: ends of the converter's range for the value. Rounding adds an error of variance q^2/12 to a\n"
                  "signal that is large against q.",
           .source = "the definition of a uniform converter",
           .parameters =
               {// A float of 24 bits holds every level.
                integer_spec("bits", "12", {1.0, 24.0}, "Bits of the converter.", "assumed")}},
      .drawn_per = DrawnPer::never,
      .make = made<Quantisation>};
}

}  // namespace slipbench
