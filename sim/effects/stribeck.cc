#include <cmath>

#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

class Stribeck final : public FrictionEffect {
 public:
  explicit Stribeck(const Parameters& p)
      : weakening_(p.number("weakening")), speed_(p.number("speed")), exponent_(p.number("exponent")) {}

  void scale(const ElementColumns& elements, double* /*mu_s*/, double* mu_k) override {
    for (std::size_t i = 0; i < elements.count; ++i) {
      const double v =
          std::sqrt(elements.vx[i] * elements.vx[i] + elements.vy[i] * elements.vy[i] + elements.vz[i] * elements.vz[i]);
      mu_k[i] *= 1.0 - weakening_ * -math::expm1(-math::pow(v / speed_, exponent_));
    }
  }

 private:
  double weakening_, speed_, exponent_;
};

}  // namespace

EffectKind stribeck() {
  return {{"stribeck",
           "Kinetic friction falls with sliding speed (Stribeck weakening).",
           "mu_k(v) = mu_k (1 - weakening (1 - exp(-(v/speed)^exponent)))\n"
           "v: speed of the element's root over the surface, as in the LuGre model; a tip without mass has no speed of its own",
           "Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995) 419, eq. 3",
           {number_spec("weakening", Quantity::none, "0.3", fraction, "Share of mu_k lost at high speed.", "assumed"),
            number_spec("speed", Quantity::speed, "2 mm/s", positive, "Stribeck speed.", "assumed"),
            number_spec("exponent", Quantity::none, "1", positive, "Shape of the fall; 2 in the LuGre paper, 0.5 to 2 in use.",
                        "assumed")}},
          {Change::less_kinetic_friction},
          [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
            effects.friction.push_back(std::make_unique<Stribeck>(p));
          }};
}

}  // namespace slipbench
