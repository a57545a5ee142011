#include <cmath>

#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

class LoadDependentFriction final : public FrictionEffect {
 public:
  LoadDependentFriction(const Parameters& p, const EffectContext& context)
      : reference_(p.number("reference")), exponent_(p.number("exponent")), share_(context.share) {}

  void scale(const ElementColumns& elements, double* mu_s, double* mu_k) override {
    for (std::size_t i = 0; i < elements.count; ++i) {
      if (!(elements.normal_force[i] > 0.0)) continue;  // no load, no friction to scale
      const double factor = math::pow(elements.normal_force[i] / (reference_ * share_[i]), -exponent_);
      mu_s[i] *= factor;
      mu_k[i] *= factor;
    }
  }
  [[nodiscard]] bool by_speed() const override { return false; }

 private:
  double reference_, exponent_;
  std::vector<double> share_;
};

}  // namespace

EffectKind load_dependent_friction() {
  return {
      {"load_dependent_friction",
       "Friction coefficients fall with load, as elastomers' do: the true contact area grows slower than the load.",
       "mu(f_n) = mu (f_n/reference)^(-exponent)\n"
       "f_n: normal force of the unit. A bristle's force is compared with its share of `reference`.",
       "exponent 1/3: smooth sphere, area ~ f_n^(2/3) (Hertz; Schallamach, Wear 1 (1958) 384)",
       {number_spec("reference", Quantity::force, "1 N", positive, "Normal force of a unit at which mu is the scene's.",
                    "assumed"),
        number_spec("exponent", Quantity::none, "0.3333333333333333", {0.0, 1.0}, "Exponent of the fall.", "Schallamach 1958")}},
      {Change::static_friction, Change::kinetic_friction},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        effects.friction.push_back(std::make_unique<LoadDependentFriction>(p, context));
      }};
}

}  // namespace slipbench
