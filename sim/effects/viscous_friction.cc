#include <cmath>

#include "sim/effects/effects.h"

namespace slipbench {
namespace {

class ViscousFriction final : public FrictionEffect {
 public:
  explicit ViscousFriction(const Parameters& p) : gain_(p.number("gain")), speed_(p.number("speed")) {}

  void scale(const ElementColumns& elements, double* mu_s, double* mu_k) override {
    for (std::size_t i = 0; i < elements.count; ++i) {
      if (elements.normal_force[i] == 0.0) continue;
      const double v =
          std::sqrt(elements.vx[i] * elements.vx[i] + elements.vy[i] * elements.vy[i] + elements.vz[i] * elements.vz[i]);
      const double factor = 1.0 + gain_ * std::log10(1.0 + v / speed_);
      mu_s[i] *= factor;
      mu_k[i] *= factor;
    }
  }

 private:
  double gain_, speed_;
};

}  // namespace

EffectKind viscous_friction() {
  return {
      {"viscous_friction",
       "Friction grows with sliding speed (velocity strengthening), as that of rubber does far below its peak.",
       "mu_s, mu_k times 1 + gain log10(1 + v/speed)\n"
       "v: speed at which the element's root moves over the surface; an element that stretches while it sticks lets go at the "
       "friction of that speed, so that slip never begins with a jump upwards",
       "the logarithm: Grosch, Proc. R. Soc. Lond. A 274 (1963) 21, rubber below its peak; the figures are assumed",
       {{"gain",
         ParameterType::number,
         Quantity::none,
         "0.1",
         {0.0, 10.0, false},
         {},
         1,
         "growth of friction for every ten times the speed, far above `speed`",
         "assumed: the gradual slip of the published PTFE trials asks for some strengthening"},
        {"speed",
         ParameterType::number,
         Quantity::speed,
         "1 mm/s",
         positive,
         {},
         1,
         "speed from which on it counts",
         "assumed"}}},
      [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
        effects.friction.push_back(std::make_unique<ViscousFriction>(p));
      }};
}

}  // namespace slipbench
