#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

// Solves b y + ln y = a + b for y = 1 + w/speed > 1, with a > 0, b > 0; z = b y is Wright's omega
// function. Near the root: the fourth-order step of [fritsch1973]. Elsewhere: Newton's step, which
// never overshoots from below because the left side is concave. `y`: the last step's solution, 0
// for none. Each lane is solved as if alone. A steady slide needs one logarithm.
SLIPBENCH_INLINE Quad solve(const Quad& a, const Quad& b, decltype(Quad{} < Quad{}) wanted, Quad y) {
  const Quad one = Quad{} + 1.0;
  const auto fresh = ~(y >= 1.0);
  if (any(fresh)) {
    const Quad start = 1.0 / (math::exp(-a) + b / (a + b));
    y = fresh ? ((wanted & (start > 1.0)) ? start : one) : y;
  }
  for (int iteration = 0; iteration < 100 && any(wanted); ++iteration) {
    const Quad z1 = 1.0 + b * y, r = a + b * (1.0 - y) - math::log(y);
    const Quad newton = r / z1, p = 2.0 * z1 * (z1 + 2.0 / 3.0 * r);
    const auto near = (newton < 0.5) & (newton > -0.5);
    const Quad change = near ? newton * (p - r) / (p - 2.0 * r) : newton, next = y * (1.0 + change);
    y = wanted ? (next > 1.0 ? next : one) : y;
    wanted &= ~(near & (change < 1e-4) & (change > -1e-4));
  }
  return y;
}

// RateEffect::strengthen(). `ratio`: 1 + w/speed, on entry of the last step, on return of this
// one; 0 in stick.
SLIPBENCH_DISPATCHED void strengthen_all(double gain, double dt, double speed, std::size_t count, const double* trial,
                                         const double* stiffness, const double* limit, double* ratio, double* factor) {
  const Quad none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += quad) {
    const std::size_t bytes = std::min(quad, count - i) * sizeof(double);
    const auto at = [&](const double* column) SLIPBENCH_INLINE_BODY {
      if (bytes == sizeof(Quad)) return vector_at<Quad>(column + i);
      Quad some{};
      std::memcpy(&some, column + i, bytes);
      return some;
    };
    const auto put = [&](double* column, const Quad& values) SLIPBENCH_INLINE_BODY {
      bytes == sizeof(Quad) ? put_vector(column + i, values) : static_cast<void>(std::memcpy(column + i, &values, bytes));
    };
    const Quad held = at(limit), scale = gain * held;
    const auto slips = (at(trial) > held) & (scale > 0.0);
    Quad y{};
    if (any(slips)) {
      const Quad excess = slips ? (at(trial) - held) / scale : one, step = slips ? at(stiffness) * dt * speed / scale : one;
      y = solve(excess, step, slips, at(ratio));
      put(factor, at(factor) * (slips ? 1.0 + gain * (excess + step * (1.0 - y)) : one));
      y = slips ? y : none;
    }
    put(ratio, y);
  }
}

// g(w) = 1 + gain log10(1 + w/speed).
class ViscousFriction final : public RateEffect {
 public:
  ViscousFriction(const Parameters& p, const EffectContext& context)
      : gain_(p.number("gain") / std::numbers::ln10), speed_(p.number("speed")), ratio_(context.elements, 0.0) {}

  void strengthen(std::size_t first, std::size_t count, double dt, const double* trial, const double* stiffness,
                  const double* limit, double* factor) override {
    if (gain_ != 0.0) strengthen_all(gain_, dt, speed_, count, trial, stiffness, limit, ratio_.data() + first, factor);
  }

  [[nodiscard]] double factor(double speed) const override { return 1.0 + gain_ * math::log(1.0 + speed / speed_); }
  [[nodiscard]] double growth(double speed) const override { return gain_ / ((speed_ + speed) * factor(speed)); }

  [[nodiscard]] std::span<double> memory() override { return ratio_; }
  void pass_on(std::size_t i, Effect& next, const Eigen::Matrix3d& /*turn*/) override {
    static_cast<ViscousFriction&>(next).ratio_[i] = std::exchange(ratio_[i], 0.0);
  }

 private:
  double gain_, speed_;        // per factor e, m/s
  std::vector<double> ratio_;  // 1 + w/speed of the last step, 0 in stick
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
                    "assumed: the gradual slip of the published PTFE trials suggests some strengthening"),
        number_spec("speed", Quantity::speed, "1 mm/s", positive, "Speed of slip from which on friction grows.", "assumed")}},
      {Change::more_kinetic_friction},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        effects.rate = std::make_unique<ViscousFriction>(p, context);
      }};
}

}  // namespace slipbench
