#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class ValidRange : public ElectronicsStage {
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

 protected:
  std::vector<float> lowest_, highest_;  // [V] in the value's unit
  std::uint64_t saturated_ = 0;
};

class FlaggedValidRange final : public ValidRange {
 public:
  FlaggedValidRange(const Parameters& parameters, const SignalModel& model)
      : ValidRange(parameters, model), flag_(model.range_flag), flags_(std::ranges::max(flag_) + 1) {}

  void apply(std::span<float> values, double /*time*/) override {
    std::ranges::fill(flags_, 0.0F);
    bool beyond = false;
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (values[v] < lowest_[v] || values[v] > highest_[v]) {
        flags_[flag_[v]] = 1.0F;
        beyond = true;
      }
    }
    if (beyond) ++saturated_;
  }

  [[nodiscard]] std::span<const float> range_flags() const override { return flags_; }

 private:
  std::vector<std::size_t> flag_;  // [V]
  std::vector<float> flags_;
};

std::unique_ptr<ElectronicsStage> make_valid_range(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  const auto make = model.range_flag.empty() ? made<ValidRange> : made<FlaggedValidRange>;
  return make(parameters, model, stream);
}

}  // namespace

PartKind valid_range_part() {
  return {
      .entry =
          {.name = "valid_range",
           .summary =
               "Counts samples with a value beyond the range for which the manufacturer states an accuracy; changes no reading.",
           .law = "saturated_samples = number of samples with a value below scale*lowest or above scale*highest",
           .source = "the definition",
           .parameters = {number_spec("scale", Quantity::none, "1", positive, "Factor on the device's own range.",
                                      "1: as the manufacturer states")}},
      .drawn_per = DrawnPer::never,
      .make = make_valid_range};
}

}  // namespace slipbench
