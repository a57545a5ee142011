#include "sim/field/lean.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipbench {
namespace {

double normal_force(const Lean& lean, const LeaningElement& element, double q) {
  return std::max(0.0, element.k_normal * (element.depth - lean.drop(q)) + element.history_normal);
}

}  // namespace

LeaningForce leaning_force(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& u) {
  const double q = u.norm(), normal = normal_force(lean, element, q);
  const double stopped = q > lean.stop_deflection ? lean.stop_stiffness * (1.0 - lean.stop_deflection / q) : 0.0;
  return {normal, (element.k - normal / lean.length + stopped) * u + element.history};
}

double leaning_slip(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& e, double guess, double dt,
                    const RateEffect* rate) {
  const double kept = element.history.dot(e), ahead = element.stretch.dot(e);
  const double size = element.stretch.norm();
  const double across2 = std::max(0.0, element.stretch.squaredNorm() - ahead * ahead);
  const double per_length = 1.0 / lean.length, per_dt = dt > 0.0 ? 1.0 / dt : 0.0;
  const auto excess = [&](double s, double& slope) {
    const double along = ahead - s, q = std::sqrt(across2 + along * along), normal = normal_force(lean, element, q);
    const double grows = normal > 0.0 ? element.k_normal * along * per_length : 0.0;  // of the normal force with s
    double added = -normal * per_length, added_grows = -grows * per_length;
    if (q > lean.stop_deflection) {
      const double share = lean.stop_deflection / q;
      added += lean.stop_stiffness * (1.0 - share);
      added_grows -= lean.stop_stiffness * share * along / (q * q);
    }
    const double factor = rate != nullptr ? rate->factor(s * per_dt) : 1.0;
    const double steepens = rate != nullptr ? factor * rate->growth(s * per_dt) * per_dt : 0.0;
    slope = -(element.k + added) + added_grows * along - element.mu_slide * (grows * factor + normal * steepens);
    return (element.k + added) * along + kept - element.mu_slide * normal * factor;
  };
  // Newton's steps from the guess, held between what is known to be below and above the root. Nothing is above at first: where Newton's step
  // does not lead upwards, growing ones do, of which the first is what the stiffest column would give way.
  double low = 0.0, high = std::numeric_limits<double>::infinity(), stride = 0.0, s = std::max(0.0, guess);
  for (int iteration = 0; iteration < 200; ++iteration) {
    double slope = 0.0;
    const double beyond = excess(s, slope), rounding = 1e-14 * (size + s);
    if (std::abs(beyond) <= -slope * rounding) return s;
    (beyond > 0.0 ? low : high) = s;
    if (!(high - low > rounding)) return s;
    const double newton = s - beyond / slope;
    if (newton > low && newton < high) {
      s = newton;
    } else if (std::isinf(high)) {
      stride = std::max(2.0 * stride, beyond / (element.k + lean.stop_stiffness));
      s = low + stride;
    } else {
      s = 0.5 * (low + high);
    }
  }
  return s;
}

}  // namespace slipbench
