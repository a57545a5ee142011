#include <memory>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class Offset final : public ElectronicsStage {
 public:
  Offset(const Parameters& parameters, const SignalModel& model, RandomStream stream) : offset_(model.source.size()) {
    std::vector<double> draw(model.sources);
    for (double& z : draw) z = stream.normal();
    for (std::size_t v = 0; v < offset_.size(); ++v) {
      offset_[v] = static_cast<float>(parameters.number("scale") * model.offset_sd[v] * draw[model.source[v]]);
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    for (std::size_t v = 0; v < offset_.size(); ++v) values[v] += offset_[v];
  }

 private:
  std::vector<float> offset_;  // [V] in the value's unit
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  return std::make_unique<Offset>(parameters, model, stream);
}

}  // namespace

PartKind offset_part() {
  return {.entry = {.name = "offset",
                    .summary = "What taring leaves: a constant on each value, new in each recording.",
                    .law = "y = x + scale*sd*z\n"
                           "z: standard normal, one a source (values computed from one another share it); sd: of the value",
                    .source = "the form is assumed",
                    .parameters = {scale_parameter()}},
          .drawn_per = DrawnPer::trial,
          .make = &make};
}

}  // namespace slipbench
