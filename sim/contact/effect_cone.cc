#include <cmath>

#include <Eigen/Core>

#include "sim/contact/effect_cone.h"

namespace slipbench {
namespace {

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
