#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Core>

#include "sim/contact/lean.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// One element in one step, in the surface frame. Springs and rheology of an upright column give k u
// + `history` tangentially and k_normal depth + history_normal along the normal.
struct LeaningElement {
  Eigen::Vector3d stretch, history;           // m, N: tangential, of the trial
  double k, k_normal, depth, history_normal;  // N/m, N/m, m, N
  double mu_slide;                            // without a rate law
};

struct LeaningForce {
  double normal;               // N, >= 0
  Eigen::Vector3d tangential;  // N, of the pad on the surface
};

double normal_force(const Lean& lean, const LeaningElement& element, double q) {
  return std::max(0.0, element.k_normal * (element.depth - lean.drop(q)) + element.history_normal);
}

// Returns the force at the stretch u [m], by effect.h's Lean.
LeaningForce leaning_force(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& u) {
  const double q = u.norm(), normal = normal_force(lean, element, q);
  const double stopped = q > lean.stop_deflection ? lean.stop_stiffness * (1.0 - lean.stop_deflection / q) : 0.0;
  return {normal, (element.k - normal / lean.length + stopped) * u + element.history};
}

// Returns the slip s >= 0 [m] of the tip along the unit vector e of its trial force, which is
// beyond mu_slide f_n: the first root of
//   e.f_t(u - s e) = mu_slide f_n(u - s e) g(s/dt),
// with g = 1 without a `rate` law. Where the column's stiffness is negative the tip slides
// outwards, up to the stop: a tip without mass snaps there within the step. `guess`: a slip near
// the root [m].
double leaning_slip(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& e, double guess, double dt,
                    const RateEffect* rate) {
  const double kept = element.history.dot(e), ahead = element.stretch.dot(e);
  const double size = element.stretch.norm();
  const double across2 = std::max(0.0, element.stretch.squaredNorm() - ahead * ahead);
  const double per_length = 1.0 / lean.length, per_dt = dt > 0.0 ? 1.0 / dt : 0.0;
  const auto excess = [&](double s, double& slope) {
    const double along = ahead - s, q = std::sqrt(across2 + along * along), normal = normal_force(lean, element, q);
    // increase of the normal force with s
    const double grows = normal > 0.0 ? element.k_normal * along * per_length : 0.0;
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
  // Newton's steps from the guess, kept inside a bracket. At first there is no upper bound: where
  // Newton's step does not lead upwards, growing steps do, the first of which is the displacement
  // of the stiffest column.
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

// Returns L g(w) [N] of the rate law for a trial force t that slides by associated flow on the cone
// of size `at_rest` L. The slip s(L) is the distance of t from the cone of L, divided by k: a
// convex function with the slope -h/k, h = f.e/L, e the direction of the slip. So each L from the
// tangent at the last one is too small, and they converge from below, quadratically.
double strengthened(const ConeEffect& cone, RateEffect& rate, double dt, std::size_t i, const Eigen::Vector3d& t,
                    const Eigen::Vector3d& n, double k, double at_rest) {
  double sliding = at_rest;
  if (!(at_rest > 0.0) || !(cone.gauge(t.data(), n.data(), at_rest) > 1.0)) return sliding;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto on_cone = cone.project(t.data(), n.data(), 0.0, sliding);
    const Eigen::Vector3d f(on_cone.fx, on_cone.fy, on_cone.fz);
    const double left = (t - f).norm();
    const double h = f.dot(t - f) / (left * sliding);
    if (!(left > 0.0) || !(h > 0.0)) break;
    const double along = sliding + left / h, softer = k / h;
    double factor = 1.0;
    rate.strengthen(i, 1, dt, &along, &softer, &at_rest, &factor);
    const double next = at_rest * factor;
    const bool done = !(std::abs(next - sliding) > 1e-14 * next);
    sliding = next;
    if (done) break;
  }
  return sliding;
}

}  // namespace

kernel::Projected project_onto_cone(const Lean& lean, const RateEffect* rate, double dt, const kernel::Columns& c, std::size_t i,
                                    const kernel::Trial& trial) {
  const double k = c.k_tangential[i];
  const LeaningElement element{.stretch = {trial.ux, trial.uy, trial.uz},
                               .history = {trial.hx, trial.hy, trial.hz},
                               .k = k,
                               .k_normal = c.k_normal[i],
                               .depth = -c.gap[i],
                               .history_normal = c.history.normal[i],
                               .mu_slide = c.mu_kinetic[i]};
  LeaningForce force = leaning_force(lean, element, element.stretch);
  const double size = force.tangential.norm(), limit_stick = c.mu_static[i] * force.normal;
  c.trial[i] = size;
  c.slide[i] = limit_stick;
  double slip = 0.0;
  Eigen::Vector3d along(0.0, 0.0, 0.0);
  if (size > kernel::slips_beyond<double, true>(c, i, limit_stick, element.mu_slide * force.normal)) {
    along = force.tangential / size;
    const double trailed = element.stretch.norm() - (c.contact.at(i) - c.place.at(i)).norm();
    slip = leaning_slip(lean, element, along, trailed, dt, rate);
  }
  const bool slides =
      slip > kernel::shortest_slip || (rate != nullptr && slip > 0.0 && size > kernel::clearly_beyond * limit_stick);
  if (slides) {
    force.normal = leaning_force(lean, element, element.stretch - slip * along).normal;
    const double strengthened = rate != nullptr ? rate->factor(slip / dt) : 1.0;
    force.tangential = element.mu_slide * force.normal * strengthened * along;
  } else {
    slip = 0.0;
  }
  if (force.normal > (k + lean.stop_stiffness) * lean.length) {
    throw SceneValueError("effects", "lean: element " + std::to_string(i) + " carries " + format_number(force.normal) +
                                         " N, more than a column with a stop can carry, (k_t + stop_stiffness) length = " +
                                         format_number((k + lean.stop_stiffness) * lean.length) +
                                         " N; reduce the load or raise stop_stiffness");
  }
  const Eigen::Vector3d f = force.tangential, s = slip * along;
  return {force.normal, f.x(), f.y(), f.z(), s.x(), s.y(), s.z(), s.norm(), slides};
}

kernel::Projected project_onto_cone(const ConeEffect& cone, RateEffect* rate, double dt, const kernel::Columns& c, std::size_t i,
                                    const kernel::Trial& trial) {
  const Eigen::Vector3d n = c.normal.at(i);
  const Eigen::Vector3d t(trial.tx, trial.ty, trial.tz);
  double limit_slide = c.mu_kinetic[i] * trial.f_n;
  if (rate != nullptr) limit_slide = strengthened(cone, *rate, dt, i, t, n, c.k_tangential[i], limit_slide);
  const double limit_stick = c.mu_static[i] * trial.f_n;
  const auto mapped =
      cone.project(t.data(), n.data(), kernel::slips_beyond<double, true>(c, i, limit_stick, limit_slide), limit_slide);
  const Eigen::Vector3d force(mapped.fx, mapped.fy, mapped.fz);
  Eigen::Vector3d slip(0.0, 0.0, 0.0);
  if (mapped.slides) slip = (t - force) * c.compliance[i];
  return {trial.raw, mapped.fx, mapped.fy, mapped.fz, slip.x(), slip.y(), slip.z(), slip.norm(), mapped.slides};
}

}  // namespace slipbench
