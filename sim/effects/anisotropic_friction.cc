#include <array>
#include <cmath>
#include <cstddef>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

// Elliptic cone with the grain along `angle` in the surface plane: (t_1/mu)^2 + (t_2/(ratio mu))^2
// <= f_n^2.
class AnisotropicFriction final : public ConeEffect {
 public:
  explicit AnisotropicFriction(const Parameters& p)
      : ratio_(p.number("ratio")), gx_(math::cos(p.number("angle"))), gy_(math::sin(p.number("angle"))) {
    for (std::size_t face = 0; face < faces_.size(); ++face) {
      double n[3] = {0.0, 0.0, 0.0};
      n[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
      faces_[face] = frame_on(n);
    }
  }

  [[nodiscard]] Projected project(const double t[3], const double n[3], double limit_stick, double limit_slide) const override {
    const Frame& frame = frame_at(n);
    const double t1 = dot(t, frame.along), t2 = dot(t, frame.across);
    if (!(norm(t1, t2 / ratio_) > limit_stick)) return {t[0], t[1], t[2], false};
    double f1 = 0.0, f2 = 0.0;
    if (limit_slide > 0.0) closest_point(t1, t2, limit_slide, limit_slide * ratio_, f1, f2);
    return {f1 * frame.along[0] + f2 * frame.across[0], f1 * frame.along[1] + f2 * frame.across[1],
            f1 * frame.along[2] + f2 * frame.across[2], true};
  }

  [[nodiscard]] double gauge(const double t[3], const double n[3], double limit) const override {
    const Frame& frame = frame_at(n);
    return norm(dot(t, frame.along), dot(t, frame.across) / ratio_) / limit;
  }

 private:
  struct Frame {
    double along[3], across[3];
  };

  // No overflow guard as in std::hypot, which is slow: forces are far from where a square over- or
  // underflows.
  static double norm(double a, double b) { return std::sqrt(a * a + b * b); }
  static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  // The surface is a plane or a face of a box, so its normal lies along an axis.
  [[nodiscard]] const Frame& frame_at(const double n[3]) const {
    const std::size_t axis = n[0] != 0.0 ? 0 : n[1] != 0.0 ? 1 : 2;
    return faces_[2 * axis + (n[axis] < 0.0 ? 1 : 0)];
  }

  // Projects the grain direction onto the tangent plane of n. On the side faces of a box (n in XY)
  // it is a horizontal line at any angle; by continuity in the angle, also where the grain is
  // normal to the face and has no projection.
  [[nodiscard]] Frame frame_on(const double n[3]) const {
    const double lift = gx_ * n[0] + gy_ * n[1];
    Frame frame{{gx_ - lift * n[0], gy_ - lift * n[1], -lift * n[2]}, {}};
    if (frame.along[0] == 0.0 && frame.along[1] == 0.0 && frame.along[2] == 0.0) {
      frame.along[0] = -n[1];
      frame.along[1] = n[0];
    }
    const double size = std::sqrt(dot(frame.along, frame.along));
    for (double& component : frame.along) component /= size;
    frame.across[0] = n[1] * frame.along[2] - n[2] * frame.along[1];
    frame.across[1] = n[2] * frame.along[0] - n[0] * frame.along[2];
    frame.across[2] = n[0] * frame.along[1] - n[1] * frame.along[0];
    return frame;
  }

  // Finds the closest point of the ellipse with half axes a, b to a point outside: f_i = a_i^2
  // t_i/(a_i^2 + lambda), where lambda is the root of the convex, falling function sum (a_i
  // t_i/(a_i^2 + lambda))^2 - 1. Newton's iteration from lambda = 0 approaches the root from below
  // and never overshoots.
  static void closest_point(double t1, double t2, double a, double b, double& f1, double& f2) {
    double lambda = 0.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double d1 = a * a + lambda, d2 = b * b + lambda;
      const double q1 = a * t1 / d1, q2 = b * t2 / d2;
      const double excess = q1 * q1 + q2 * q2 - 1.0;
      const double slope = -2.0 * (q1 * q1 / d1 + q2 * q2 / d2);
      const double step = -excess / slope;
      lambda += step;
      if (!(step > 1e-15 * lambda)) break;
    }
    f1 = a * a * t1 / (a * a + lambda);
    f2 = b * b * t2 / (b * b + lambda);
  }

  double ratio_, gx_, gy_;
  std::array<Frame, 6> faces_;
};

}  // namespace

EffectKind anisotropic_friction() {
  return {
      {"anisotropic_friction",
       "Friction that depends on the direction of sliding (felt, brushed metal, fabric): an elliptic cone.",
       "(t_1/mu)^2 + (t_2/(ratio mu))^2 <= f_n^2, t_1 along the grain. Slip is normal to the ellipse (maximum dissipation), so the friction on a slide along d is\n"
       "f = -f_n (mu_1^2 d_1, mu_2^2 d_2)/sqrt(mu_1^2 d_1^2 + mu_2^2 d_2^2), mu_1 = mu, mu_2 = ratio mu",
       "Zmitrowicz, Int. J. Solids Struct. 43 (2006) 4407; associated flow",
       {number_spec("ratio", Quantity::none, "0.6", {0.01, 100.0}, "Friction across the grain over friction along it.",
                    "assumed: felt, +-25 %"),
        number_spec(
            "angle", Quantity::angle, "0 deg", any_value,
            "Direction of the grain in the surface, from the surface's X axis; on the side faces of a box the grain is horizontal.",
            "assumed")}},
      {Change::static_friction, Change::kinetic_friction},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        // On a curved surface the grain's direction would jump where the surface normal is parallel
        // to it.
        if (!context.flat_surface)
          throw SceneValueError("effects", "anisotropic_friction needs a flat surface; allowed shapes: plane, box");
        effects.cone = std::make_unique<AnisotropicFriction>(p);
      }};
}

}  // namespace slipbench
