#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

// What a number below 2^51 is added to so that its fraction is rounded off, to the nearest even: std::nearbyint without a call.
constexpr double to_whole = 0x1.8p52;

class Quantisation final : public ElectronicsStage {
 public:
  Quantisation(const Parameters& parameters, const SignalModel& model) {
    if (model.converter.size() != model.source.size())
      throw std::logic_error("quantisation: a value without a converter's range");
    const double codes = std::exp2(static_cast<double>(parameters.integer("bits"))) - 1.0;
    for (const ConverterRange& range : model.converter) values_.push_back({range.lowest, (range.highest - range.lowest) / codes});
    last_code_ = codes;
  }

  void apply(std::span<float> values, double /*time*/) override {
    bool beyond = false;
    for (std::size_t v = 0; v < values_.size(); ++v) {
      const double code = ((values[v] - values_[v].lowest) / values_[v].step + to_whole) - to_whole;
      const double held = std::min(std::max(code, 0.0), last_code_);
      beyond |= held != code;
      values[v] = static_cast<float>(values_[v].lowest + values_[v].step * held);
    }
    if (beyond) ++saturated_;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return saturated_; }

 private:
  struct Value {
    double lowest, step;
  };
  std::vector<Value> values_;
  double last_code_ = 0.0;
  std::uint64_t saturated_ = 0;
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream /*stream*/) {
  return std::make_unique<Quantisation>(parameters, model);
}

}  // namespace

PartKind quantisation_part() {
  return {
      .entry = {.name = "quantisation",
                .summary = "the converter: each value becomes one of 2^bits levels, and one of the end levels beyond its range",
                .law = "y = lowest + q*c,  c = round((x - lowest)/q), not below 0, not above 2^bits - 1,\n"
                       "q = (highest - lowest)/(2^bits - 1)\n"
                       "lowest, highest: ends of the converter's range for the value. The rounding of a signal that is large\n"
                       "against q adds an error of variance q^2/12",
                .source = "the definition of a uniform converter",
                .parameters = {{.name = "bits",
                                .type = ParameterType::integer,
                                .quantity = Quantity::none,
                                .default_text = "12",
                                .range = {.min = 1.0, .max = 24.0, .open_min = false},  // a float of 24 bits holds every level
                                .choices = {},
                                .size = 1,
                                .doc = "Bits of the converter.",
                                .source = "assumed"}}},
      .drawn_per = DrawnPer::device,
      .make = &make};
}

}  // namespace slipbench
