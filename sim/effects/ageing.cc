#include <cmath>

#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

constexpr double stick = 1.0;

class Ageing final : public FrictionEffect {
 public:
  Ageing(const Parameters& p, const EffectContext& context)
      : rate_(p.number("rate")), time_(p.number("time")), stuck_for_(context.elements, 0.0) {}

  void scale(const ElementColumns& elements, double* mu_s, double* /*mu_k*/) override {
    for (std::size_t i = 0; i < elements.count; ++i) {
      stuck_for_[i] = elements.mode[i] == stick ? stuck_for_[i] + elements.dt : 0.0;
      mu_s[i] *= 1.0 + rate_ * math::log1p(stuck_for_[i] / time_);
    }
  }

  [[nodiscard]] bool by_speed() const override { return false; }
  [[nodiscard]] std::span<double> memory() override { return stuck_for_; }
  void pass_on(std::size_t i, Effect& next, const Eigen::Matrix3d& /*turn*/) override {
    static_cast<Ageing&>(next).stuck_for_[i] = std::exchange(stuck_for_[i], 0.0);
  }

 private:
  double rate_, time_;
  std::vector<double> stuck_for_;  // s
};

}  // namespace

EffectKind ageing() {
  return {{"ageing",
           "Static friction grows with the logarithm of the time an element has stuck.",
           "mu_s(t) = mu_s (1 + rate ln(1 + t/time)), t: time stuck [s]",
           "J. H. Dieterich, J. Geophys. Res. 77 (1972) 3690; Baumberger and Caroli, Adv. Phys. 55 (2006) 279",
           {number_spec("rate", Quantity::none, "0.03", non_negative, "Growth of mu_s for each factor e of time.",
                        "assumed; 0.01 to 0.05 for polymers"),
            number_spec("time", Quantity::time, "100 ms", positive, "Time from which on the growth is logarithmic.", "assumed")}},
          {Change::static_friction},
          [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
            effects.friction.push_back(std::make_unique<Ageing>(p, context));
          }};
}

}  // namespace slipbench
