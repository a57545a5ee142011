#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class Gain final : public ElectronicsStage {
 public:
  Gain(const Parameters& parameters, const SignalModel& model, RandomStream stream) : gain_(model.source.size()) {
    for (std::size_t v = 0; v < gain_.size(); ++v) {
      const double sd = parameters.number("scale") * model.gain_sd[v];
      const double log_variance = std::log1p(sd * sd);
      // A value without gain error still takes its draw, so that the draws of the others do not depend on it.
      gain_[v] = static_cast<float>(std::exp(std::sqrt(log_variance) * stream.normal() - 0.5 * log_variance));
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    for (std::size_t v = 0; v < gain_.size(); ++v) values[v] *= gain_[v];
  }

 private:
  std::vector<float> gain_;  // [V]
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  return std::make_unique<Gain>(parameters, model, stream);
}

}  // namespace

PartKind gain_part() {
  return {
      .entry = {.name = "gain",
                .summary = "Calibration error: each value is too large or too small by its own factor, fixed for a device.",
                .law = "y = g*x,  ln g = s*z - s^2/2,  s^2 = ln(1 + (scale*sd)^2)\n"
                       "g: lognormal with mean 1 and standard deviation scale*sd, so never negative; z: standard normal, one a\n"
                       "value; sd: of the value's gain",
                .source = "the distribution is assumed",
                .parameters = {scale_parameter()}},
      .drawn_per = DrawnPer::device,
      .make = &make};
}

}  // namespace slipbench
