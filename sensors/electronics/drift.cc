#include <memory>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class Drift final : public ElectronicsStage {
 public:
  Drift(const Parameters& parameters, const SignalModel& model, RandomStream stream) : slope_(model.source.size()) {
    std::vector<double> draw(model.sources);
    for (double& z : draw) z = stream.normal();
    for (std::size_t v = 0; v < slope_.size(); ++v) {
      slope_[v] = parameters.number("scale") * model.drift_sd[v] * draw[model.source[v]];
    }
  }

  void apply(std::span<float> values, double time) override {
    for (std::size_t v = 0; v < slope_.size(); ++v) values[v] = static_cast<float>(values[v] + slope_[v] * time);
  }

 private:
  std::vector<double> slope_;  // [V] in the value's unit over s
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  return std::make_unique<Drift>(parameters, model, stream);
}

}  // namespace

PartKind drift_part() {
  return {.entry = {.name = "drift",
                    .summary = "Drift: a slow linear change of each value, with a new slope in each recording.",
                    .law = "y = x + scale*sd*z*t\n"
                           "t: time since the start [s]; z: standard normal, one a source (values computed from one another\n"
                           "share it); sd: of the value's slope",
                    .source = "the form is assumed; recordings of a few seconds show no more than a slope",
                    .parameters = {scale_parameter()}},
          .drawn_per = DrawnPer::trial,
          .make = &make};
}

}  // namespace slipbench
