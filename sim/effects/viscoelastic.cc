#include <array>
#include <cmath>

#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

// A Maxwell branch parallel to each spring, for each element and each of the four deflections
// (normal, three tangential components).
class Viscoelastic final : public RheologyEffect {
 public:
  Viscoelastic(const Parameters& p, const EffectContext& context)
      : relaxing_(p.number("relaxation")),
        time_(p.number("time")),
        k_normal_(context.k_normal),
        k_tangential_(context.k_tangential),
        memory_(2 * deflections * context.elements) {}

  void prepare(const ElementColumns& elements, const AffineForce& force) override {
    set_step(elements.dt);
    for (std::size_t i = 0; i < elements.count; ++i) {
      force.k_normal[i] += relaxing_ * k_normal_[i] * (gain_ - 1.0);
      force.h_normal[i] += history(i, 0, k_normal_[i]);
      force.k_tangential[i] += relaxing_ * k_tangential_[i] * (gain_ - 1.0);
      force.h_x[i] += history(i, 1, k_tangential_[i]);
      force.h_y[i] += history(i, 2, k_tangential_[i]);
      force.h_z[i] += history(i, 3, k_tangential_[i]);
    }
  }

  void commit(const ElementColumns& elements, const double* ux, const double* uy, const double* uz) override {
    for (std::size_t i = 0; i < elements.count; ++i) {
      const std::array<double, deflections> now{elements.penetration[i], ux[i], uy[i], uz[i]};
      for (std::size_t c = 0; c < deflections; ++c) {
        const double k = c == 0 ? k_normal_[i] : k_tangential_[i];
        branch(i, c) = relaxing_ * k * gain_ * now[c] + history(i, c, k);
        before(i, c) = now[c];
      }
    }
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }
  void pass_on(std::size_t i, Effect& next, const Eigen::Matrix3d& turn) override {
    auto& there = static_cast<Viscoelastic&>(next);
    // Moves four deflections from `first` on; the last three are a vector in the surface's frame.
    const auto pass = [&](std::size_t first) {
      double *const from = memory_.data() + 2 * deflections * i + first, *const to =
                                                                             there.memory_.data() + 2 * deflections * i + first;
      Eigen::Map<Eigen::Vector3d>(to + 1) = turn * Eigen::Map<const Eigen::Vector3d>(from + 1);
      to[0] = from[0];
      std::fill_n(from, deflections, 0.0);
    };
    pass(0);
    pass(deflections);
  }

 private:
  static constexpr std::size_t deflections = 4;

  // Exact for a deflection that changes at a constant rate within the step: q' = -q/time + k u'.
  void set_step(double dt) {
    const double x = dt / time_;
    decay_ = math::exp(-x);
    gain_ = x > 0.0 ? -math::expm1(-x) / x : 1.0;
  }
  [[nodiscard]] double history(std::size_t i, std::size_t c, double k) {
    return decay_ * branch(i, c) - relaxing_ * k * gain_ * before(i, c);
  }
  // N, force of the Maxwell branch
  double& branch(std::size_t i, std::size_t c) { return memory_[2 * deflections * i + c]; }
  // m, deflection at the end of the last step
  double& before(std::size_t i, std::size_t c) { return memory_[2 * deflections * i + deflections + c]; }

  double relaxing_, time_;
  std::vector<double> k_normal_, k_tangential_;
  double decay_ = 1.0, gain_ = 1.0;
  std::vector<double> memory_;  // [elements][branch 4, before 4]
};

}  // namespace

EffectKind viscoelastic() {
  return {
      {"viscoelastic",
       "Elements relax under load and creep: a standard linear solid instead of a spring.",
       "f = (1 - relaxation) k u + q,  dq/dt = -q/time + relaxation k du/dt  (normal and tangential alike)\n"
       "k: the sensor's stiffness, which fast loading feels; after a long time (1 - relaxation) k remains. Updated exactly by exp(-dt/time).",
       "Zener, Elasticity and Anelasticity of Metals (1948); recorded PapillArray holds lose 3.2 % in 3 s, with the logarithm of time, so one time constant is a simplification",
       {number_spec("relaxation", Quantity::none, "0.05", {0.0, 0.99}, "Share of the stiffness that relaxes.",
                    "assumed; recordings show about 4 % per decade of time"),
        number_spec("time", Quantity::time, "1 s", positive, "Relaxation time at constant deflection.", "assumed")}},
      {Change::normal_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        effects.rheology.push_back(std::make_unique<Viscoelastic>(p, context));
      }};
}

}  // namespace slipbench
