#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/core/readable_quantity.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

SLIPBENCH_DISPATCHED void hold_back(std::size_t count, const double* age, double* last, float* values) {
  SLIPBENCH_VECTORISE
  for (std::size_t v = 0; v < count; ++v) {
    const double now = values[v];
    values[v] = static_cast<float>(now - age[v] * (now - last[v]));
    last[v] = now;
  }
}

class Scan final : public ElectronicsStage {
 public:
  Scan(const Parameters& parameters, const SignalModel& model) : memory_(model.source.size() + 1) {
    const double duration = parameters.number("duration");
    const auto count = static_cast<double>(model.source.size());
    for (std::size_t v = 0; v < model.source.size(); ++v) {
      age_.push_back(duration * model.rate *
                     (model.scan_share.empty() ? (count - 1.0 - static_cast<double>(v)) / count : model.scan_share[v]));
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    double& begun = memory_.back();
    if (begun == 0.0) std::ranges::copy(values, memory_.begin());
    begun = 1.0;
    hold_back(age_.size(), age_.data(), memory_.data(), values.data());
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }

 private:
  std::vector<double> age_;     // [V] in samples
  std::vector<double> memory_;  // [V] the previous sample, then whether there was one
};

void check_duration(const Parameters& parameters, const SignalModel& model, const std::string& path) {
  const double duration = parameters.number("duration");
  if (duration * model.rate <= 1.0) return;
  throw SceneValueError(path + ".duration", format_quantity(duration, Quantity::time) + " is longer than the " +
                                                readable_quantity(1.0 / model.rate, Quantity::time) + " between two samples");
}

}  // namespace

PartKind scan_part() {
  return {
      .entry = {.name = "scan",
                .summary = "Scan: values are read one after the other, the last one at the time of the sample.",
                .law = "y_v = x_v(t - a_v),  a_v = duration (V - 1 - v)/V,  v = 0 .. V - 1,  x linear between two samples",
                .source = "the definition of a converter that many values share",
                .parameters = {number_spec("duration", Quantity::time, "0 s", non_negative,
                                           "Time to read all values once, at most the time between two samples.", "assumed")}},
      .drawn_per = DrawnPer::never,
      .make = made<Scan>,
      .check = &check_duration};
}

}  // namespace slipbench
