#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

// g(w) = 1 + gain log10(1 + w/speed).
class ViscousFriction final : public RateEffect {
 public:
  ViscousFriction(const Parameters& p, const EffectContext& context)
      : gain_(p.number("gain") / std::numbers::ln10), speed_(p.number("speed")), ratio_(context.elements, 0.0) {}

  void strengthen(std::size_t first, std::size_t count, double dt, const double* trial, const double* stiffness,
                  const double* limit, double* factor) override {
    if (gain_ == 0.0) return;
    for (std::size_t i = 0; i < count; ++i) {
      double& ratio = ratio_[first + i];
      const double scale = gain_ * limit[i];
      if (!(trial[i] > limit[i] && scale > 0.0)) {
        ratio = 0.0;
        continue;
      }
      const double excess = (trial[i] - limit[i]) / scale, step = stiffness[i] * dt * speed_ / scale;
      ratio = solve(excess, step, ratio);
      factor[i] *= 1.0 + gain_ * (excess + step * (1.0 - ratio));
    }
  }

  [[nodiscard]] double factor(double speed) const override { return 1.0 + gain_ * std::log(1.0 + speed / speed_); }
  [[nodiscard]] double growth(double speed) const override { return gain_ / ((speed_ + speed) * factor(speed)); }

  [[nodiscard]] std::span<double> memory() override { return ratio_; }

 private:
  // y = 1 + w/speed > 1 of b y + ln y = a + b, a > 0, b > 0: with z = b y Wright's omega function. Near the root the fourth-order step of
  // Fritsch, Shafer and Crowley (Commun. ACM 16 (1973) 123), elsewhere Newton's, which from below never overshoots: the left side is
  // concave. `guess`: y of the step before, 0 for none. In a steady slide one logarithm.
  static double solve(double a, double b, double guess) {
    double y = guess >= 1.0 ? guess : std::max(1.0, 1.0 / (std::exp(-a) + b / (a + b)));
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double z1 = 1.0 + b * y, r = a + b * (1.0 - y) - std::log(y);
      const double newton = r / z1;
      double change = newton;
      if (std::abs(newton) < 0.5) {
        const double p = 2.0 * z1 * (z1 + 2.0 / 3.0 * r);
        change = newton * (p - r) / (p - 2.0 * r);
      }
      y = std::max(1.0, y * (1.0 + change));
      if (std::abs(change) < 1e-4 && std::abs(newton) < 0.5) break;
    }
    return y;
  }

  double gain_, speed_;        // per factor e, m/s
  std::vector<double> ratio_;  // 1 + w/speed of the step before, 0 in stick
};

}  // namespace

EffectKind viscous_friction() {
  return {
      {"viscous_friction",
       "Friction grows with the speed of slip (velocity strengthening), as that of rubber does far below its peak.",
       "mu_k g(w), g = 1 + gain log10(1 + w/speed)\n"
       "w: speed at which the tip itself slips, solved for in every step: |trial force| - k_t dt w = mu_k f_n g(w). Slip begins at mu_s f_n.\n"
       "A held pad relaxes, k_t^-1 dF/dt = -w(F). Its tips count as slipping while they creep.",
       "the logarithm: Grosch, Proc. R. Soc. Lond. A 274 (1963) 21, rubber below its peak; the figures are assumed",
       {number_spec("gain", Quantity::none, "0.1", {0.0, 10.0},
                    "Growth of friction for every factor 10 of the speed, far above `speed`.",
                    "assumed: the gradual slip of the published PTFE trials asks for some strengthening"),
        number_spec("speed", Quantity::speed, "1 mm/s", positive, "Speed of slip from which on friction grows.", "assumed")}},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        effects.rate = std::make_unique<ViscousFriction>(p, context);
      }};
}

}  // namespace slipbench
