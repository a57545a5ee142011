// Effects that use every property that an EffectKind can declare, each by a law of its own where that
// is short. They are in the catalogue of the test program only.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

// |t_x/mu|^p + |t_y/mu|^p <= f_n^p on a plane, slip normal to the curve.
class SuperellipseCone final : public ConeEffect {
 public:
  explicit SuperellipseCone(const Parameters& p) : exponent_(p.number("exponent")), tolerance_(p.number("tolerance")) {}

  [[nodiscard]] Projected project(const double t[3], const double n[3], double limit_stick, double limit_slide) const override {
    if (!(gauge(t, n, 1.0) > limit_stick)) return {t[0], t[1], t[2], false};
    // The distance from the point outside to (x, y)(angle), both in the first quadrant, has one
    // minimum, which the sections enclose.
    const double x = std::abs(t[0]), y = std::abs(t[1]);
    double low = 0.0, high = 0.5 * std::numbers::pi;
    while (high - low > tolerance_) {
      const double third = (high - low) / 3.0;
      const bool is_left = distance(x, y, limit_slide, low + third) < distance(x, y, limit_slide, high - third);
      (is_left ? high : low) += is_left ? -third : third;
    }
    const auto [to_x, to_y] = point(limit_slide, 0.5 * (low + high));
    return {std::copysign(to_x, t[0]), std::copysign(to_y, t[1]), 0.0, true};
  }

  [[nodiscard]] double gauge(const double t[3], const double* /*n*/, double limit) const override {
    const double sum = math::pow(std::abs(t[0]), exponent_) + math::pow(std::abs(t[1]), exponent_);
    return math::pow(sum, 1.0 / exponent_) / limit;
  }

 private:
  struct Point {
    double x, y;
  };
  [[nodiscard]] Point point(double limit, double angle) const {
    const auto along = [&](double share) { return limit * math::pow(std::max(0.0, share), 2.0 / exponent_); };
    return {along(math::cos(angle)), along(math::sin(angle))};
  }
  [[nodiscard]] double distance(double x, double y, double limit, double angle) const {
    const auto [to_x, to_y] = point(limit, angle);
    return math::hypot(x - to_x, y - to_y);
  }

  double exponent_, tolerance_;
};

EffectKind cone_named(std::string name, std::vector<Change> changes) {
  return {
      {std::move(name),
       "Example: a cone between a circle and a square.",
       "|t_x|^exponent + |t_y|^exponent <= (mu f_n)^exponent",
       "this test",
       {number_spec("exponent", Quantity::none, "4", {1.0, 20.0}, "2: a circle; more: towards a square.", "this test"),
        number_spec("tolerance", Quantity::none, "1e-06", {1e-10, 1e-2}, "Angle at which the search stops [rad].", "this test")}},
      std::move(changes),
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!context.plane) throw SceneValueError("effects", "the example cone needs a plane");
        effects.cone = std::make_unique<SuperellipseCone>(p);
      },
      false,
      {"Example Solver"},
      "tolerance"};
}

class SlowWave final : public SurfaceEffect {
 public:
  explicit SlowWave(const Parameters& p)
      : wavelength_(p.number("wavelength")),
        height_(p.number("height")),
        along_x_(math::cos(p.number("angle"))),
        along_y_(math::sin(p.number("angle"))) {}

  void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) override {
    for (std::size_t i = 0; i < count; ++i) {
      if (nz[i] != 1.0) continue;
      const double way = along_x_ * x[i] + along_y_ * y[i];
      gap[i] -= height_ * math::sin(2.0 * std::numbers::pi * way / wavelength_);
    }
  }
  [[nodiscard]] double longest_step(double speed) const override { return step_per_wave(wavelength_, speed); }

 private:
  double wavelength_, height_, along_x_, along_y_;
};

class WeakSlide final : public FrictionEffect {
 public:
  explicit WeakSlide(const Parameters& p) : factor_(p.number("factor")) {}
  void scale(const ElementColumns& elements, double* /*mu_s*/, double* mu_k) override {
    for (std::size_t i = 0; i < elements.count; ++i) mu_k[i] *= factor_;
  }
  [[nodiscard]] bool by_speed() const override { return false; }

 private:
  double factor_;
};

// g(w) = 1 + w/speed: T - k dt w = L (1 + w/speed).
class LinearRate final : public RateEffect {
 public:
  explicit LinearRate(const Parameters& p) : speed_(p.number("speed")) {}
  void strengthen(std::size_t first, std::size_t count, double dt, const double* trial, const double* stiffness,
                  const double* limit, double* factor_of) override {
    for (std::size_t i = first; i < first + count; ++i) {
      const std::size_t k = i - first;
      if (limit[k] > 0.0 && trial[k] > limit[k])
        factor_of[k] *= factor((trial[k] - limit[k]) / (stiffness[k] * dt + limit[k] / speed_));
    }
  }
  [[nodiscard]] double factor(double speed) const override { return 1.0 + speed / speed_; }
  [[nodiscard]] double growth(double speed) const override { return 1.0 / (speed_ + speed); }

 private:
  double speed_;
};

// Adds a vibration along X to the force of every element, in contact or not.
class Hum final : public RingingEffect {
 public:
  explicit Hum(const Parameters& p) : amplitude_(p.number("amplitude")), frequency_(p.number("frequency")) {}
  void ring(const TipColumns& tips) override {
    phase_ += 2.0 * std::numbers::pi * frequency_ * tips.dt;
    for (std::size_t i = 0; i < tips.count; ++i) tips.transmitted_x[i] += amplitude_ * math::sin(phase_);
  }
  [[nodiscard]] std::span<double> memory() override { return {&phase_, 1}; }

 private:
  double amplitude_, frequency_, phase_ = 0.0;
};

}  // namespace

EffectKind example_cone() { return cone_named("example_cone", {Change::static_friction, Change::kinetic_friction}); }

// The same law without its changes, whose labels `verify` must call wrong.
EffectKind undeclared_cone() { return cone_named("undeclared_cone", {}); }

EffectKind example_wave() {
  return {{"example_wave",
           "Example: a surface with one wave.",
           "height sin(2 pi s/wavelength), s across the crests",
           "this test",
           {number_spec("wavelength", Quantity::length, "2 mm", positive, "Length of the wave.", "this test"),
            number_spec("height", Quantity::length, "20 um", non_negative, "Amplitude.", "this test"),
            number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction across the crests.", "this test")}},
          {Change::normal_force},
          [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
            if (!context.flat_surface) throw SceneValueError("effects", "example_wave needs a flat surface");
            effects.surface.push_back(std::make_unique<SlowWave>(p));
          },
          false,
          {},
          nullptr,
          {{.length = "wavelength", .amplitude = "height", .angle = "angle"}}};
}

EffectKind example_weak_slide() {
  return {{"example_weak_slide",
           "Example: less kinetic friction.",
           "factor mu_k",
           "this test",
           {number_spec("factor", Quantity::none, "0.8", fraction, "Factor.", "this test")}},
          {Change::less_kinetic_friction},
          [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
            effects.friction.push_back(std::make_unique<WeakSlide>(p));
          }};
}

EffectKind example_rate() {
  return {
      {"example_rate",
       "Example: kinetic friction that grows with the speed of the tip.",
       "mu_k (1 + w/speed)",
       "this test",
       {number_spec("speed", Quantity::speed, "4 mm/s", positive, "Speed at which the friction is twice mu_k.", "this test")}},
      {Change::more_kinetic_friction},
      [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
        if (effects.rate) throw SceneValueError("effects", "two effects strengthen the friction with the speed");
        effects.rate = std::make_unique<LinearRate>(p);
      }};
}

EffectKind example_hum() {
  return {{"example_hum",
           "Example: elements that vibrate by themselves; needs an effect that gives tips mass.",
           "amplitude sin(2 pi frequency t)",
           "this test",
           {number_spec("amplitude", Quantity::force, "1 mN", non_negative, "Amplitude of an element's force.", "this test"),
            number_spec("frequency", Quantity::frequency, "100 Hz", positive, "Frequency.", "this test")}},
          {Change::tip_force, Change::stick_force},
          [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
            if (!effects.tip) throw SceneValueError("effects", "example_hum needs tips with mass");
            effects.ringing.push_back(std::make_unique<Hum>(p));
          },
          true};
}

// The law of elastic_skin under a name that no folder can know: it declares a body.
EffectKind example_body() {
  EffectKind kind = elastic_skin();
  kind.about.name = "example_body";
  return kind;
}

}  // namespace slipbench
