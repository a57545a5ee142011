#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class ValidRange final : public ElectronicsStage {
 public:
  ValidRange(const Parameters& parameters, const SignalModel& model) {
    if (model.valid.size() != model.source.size()) throw std::logic_error("valid_range: a value without a range");
    for (const ConverterRange& range : model.valid) {
      lowest_.push_back(static_cast<float>(parameters.number("scale") * range.lowest));
      highest_.push_back(static_cast<float>(parameters.number("scale") * range.highest));
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    bool beyond = false;
    for (std::size_t v = 0; v < values.size(); ++v) beyond |= values[v] < lowest_[v] || values[v] > highest_[v];
    if (beyond) ++saturated_;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return saturated_; }

 private:
  std::vector<float> lowest_, highest_;  // [V] in the value's unit
  std::uint64_t saturated_ = 0;
};

}  // namespace

PartKind valid_range_part() {
  return {
      .entry = {.name = "valid_range",
                .summary = "Counts samples with a value beyond the range in which the maker states an accuracy; changes nothing.",
                .law = "saturated_samples = number of samples with a value below scale*lowest or above scale*highest",
                .source = "the definition",
                .parameters = {number_spec("scale", Quantity::none, "1", positive, "Factor on the device's own range.",
                                           "1: as the maker states it")}},
      .drawn_per = DrawnPer::never,
      .make = made<ValidRange>};
}

}  // namespace slipbench
