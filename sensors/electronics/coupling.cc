#include <memory>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"

namespace slipbench {
namespace {

class CouplingStage final : public ElectronicsStage {
 public:
  CouplingStage(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
    for (const Coupling& coupling : model.couplings) {
      const double limit = parameters.number("scale") * coupling.limit;
      terms_.push_back({coupling.to, coupling.from, static_cast<float>(stream.uniform(-limit, limit)), 0.0F});
    }
  }

  void apply(std::span<float> values, double /*time*/) override {
    // All sums are taken from the undisturbed sample before any is added.
    for (Term& term : terms_) term.added = term.coefficient * values[term.from];
    for (const Term& term : terms_) values[term.to] += term.added;
  }

 private:
  struct Term {
    std::size_t to;
    std::size_t from;
    float coefficient;
    float added;
  };
  std::vector<Term> terms_;
};

std::unique_ptr<ElectronicsStage> make(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  return std::make_unique<CouplingStage>(parameters, model, stream);
}

}  // namespace

PartKind coupling_part() {
  return {.entry = {.name = "coupling",
                    .summary = "Crosstalk between axes: one value leaks into another by a coefficient fixed for a device.",
                    .law = "y_i = x_i + sum_j c_ij*x_j,  c_ij uniform in [-scale*limit_ij, scale*limit_ij]\n"
                           "i, j: the coupled pairs of the sensor; limit_ij: largest coefficient of the pair",
                    .source = "the distribution is assumed",
                    .parameters = {scale_parameter()}},
          .drawn_per = DrawnPer::device,
          .make = &make};
}

}  // namespace slipbench
