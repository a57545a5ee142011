// The return mapping of one element onto its friction cone (field.h), common to all cones.
//
// Three stages: find_trial() computes the force with the anchor unchanged, project_onto_circle()
// (project_onto_cone() for other cones) projects it onto the cone, and commit_state() stores the
// element's new state. The kernel inlines all three and, for the circular cone, works on several
// elements at once.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "sim/api/effect.h"
#include "sim/contact/kernel.h"
#include "sim/contact/vectorise.h"

namespace slipbench::kernel {

// Returns an element's entry of a column, or those of several elements from it on. `Real`: double,
// or Lanes.
template <class Real>
SLIPBENCH_INLINE Real entry(const double* column, std::size_t i) {
  return vector_at<Real>(column + i);
}
template <class Real>
using Flag = decltype(Real{} < Real{});

// Forces of an element if its anchor stays. Vectors are tangential.
template <class Real>
struct TrialState {
  Real raw, f_n;    // normal force: raw is negative while separated, f_n is 0 then [N]
  Real ux, uy, uz;  // stretch [m]
  Real hx, hy, hz;  // history of the rheology [N]
  Real tx, ty, tz;  // force k u + h [N]
};
using Trial = TrialState<double>;

template <class Real, bool kPlane, bool kExtended>
SLIPBENCH_INLINE TrialState<Real> find_trial(const Columns& c, std::size_t i) {
  const auto at = [i](const double* column) SLIPBENCH_INLINE_BODY { return entry<Real>(column, i); };
  TrialState<Real> t{};
  t.raw = raw_normal_force<Real>(at(c.gap), at(c.k_normal), kExtended ? at(c.history.normal) : Real{});
  t.f_n = positive(t.raw);
  const Real k = at(c.k_tangential), nx = at(c.normal.x), ny = at(c.normal.y), nz = at(c.normal.z);
  t.ux = at(c.contact.x) - at(c.anchor.x);
  t.uy = at(c.contact.y) - at(c.anchor.y);
  if constexpr (!kPlane) {
    t.uz = at(c.contact.z) - at(c.anchor.z);
    const Real along = t.ux * nx + t.uy * ny + t.uz * nz;
    t.ux -= along * nx;
    t.uy -= along * ny;
    t.uz -= along * nz;
  }
  t.tx = k * t.ux;
  t.ty = k * t.uy;
  if constexpr (!kPlane) t.tz = k * t.uz;
  if constexpr (kExtended) {
    if (c.history.tangential.x != nullptr) {
      t.hx = at(c.history.tangential.x);
      t.hy = at(c.history.tangential.y);
      if constexpr (!kPlane) {  // the history was computed in an earlier tangent plane
        t.hz = at(c.history.tangential.z);
        const Real along = t.hx * nx + t.hy * ny + t.hz * nz;
        t.hx -= along * nx;
        t.hy -= along * ny;
        t.hz -= along * nz;
      }
    }
    t.tx += t.hx;  // also adding 0 matters: it removes the sign of a zero
    t.ty += t.hy;
    if constexpr (!kPlane) t.tz += t.hz;
  }
  return t;
}

// Projection of a trial onto a cone: the element after the step.
template <class Real>
struct ProjectedState {
  Real raw;         // normal force, negative while separated [N]
  Real fx, fy, fz;  // tangential force [N]
  Real sx, sy, sz;  // slip, by which the stretch is reduced [m]
  Real path;        // its length [m]
  Flag<Real> slides;
};
using Projected = ProjectedState<double>;

template <class Real, bool kPlane>
SLIPBENCH_INLINE Real size_of(const TrialState<Real>& t) {
  const Real squared = t.tx * t.tx + t.ty * t.ty;
  return root(kPlane ? squared : squared + t.tz * t.tz);
}

// A trial force of more than this share of mu_s f_n is beyond it by more than rounding.
inline constexpr double clearly_beyond = 1.0 + 1e-6;

// Returns the size of a trial force [N] beyond which element i slips: `stick` mu_s f_n or, if it
// slipped before, `slide` mu_k f_n. By a rate law mu_k may be the larger one. A slip shorter than
// shortest_slip does not count, unless a rate law holds the tip beyond mu_s f_n while it creeps.
template <class Real, bool kExtended>
SLIPBENCH_INLINE Real slips_beyond(const Columns& c, std::size_t i, const Real& stick, const Real& slide) {
  const Real onset = kExtended ? (slide > stick ? slide : stick) : stick;
  const Real asked = entry<Real>(c.before.mode, i) == 2.0 ? slide : onset, most = clearly_beyond * stick;
  const Real beyond = asked > most ? most : asked;
  return (kExtended ? beyond : asked) + entry<Real>(c.k_tangential, i) * shortest_slip;
}

// Projects onto Coulomb's circular cone, also for elements without contact.
template <class Real, bool kPlane, bool kExtended>
SLIPBENCH_INLINE ProjectedState<Real> project_onto_circle(const Columns& c, std::size_t i, const TrialState<Real>& t) {
  const Real none{}, one = none + 1.0, softness = entry<Real>(c.compliance, i);
  const Flag<Real> touches = t.f_n > none;
  const Real limit_stick = entry<Real>(c.mu_static, i) * t.f_n;
  Real limit_slide = entry<Real>(c.mu_kinetic, i) * t.f_n;
  const Real size = size_of<Real, kPlane>(t);
  const Flag<Real> slides = touches & (size > slips_beyond<Real, kExtended>(c, i, limit_stick, limit_slide));
  // That of a rate law may exceed the force of a creeping tip by rounding.
  if (kExtended) limit_slide = limit_slide < size ? limit_slide : size;
  const Real ratio = limit_slide / size, scale = slides ? ratio : one;
  const Real loss = (size - limit_slide) * softness;
  // With u = (f - h) / k the anchor lies at c - u; the slip of this step is the loss of stretch, 0
  // for a sticking element.
  const Real lost = (one - scale) * softness;
  const Real fx = scale * t.tx, fy = scale * t.ty, fz = scale * t.tz;
  // Without contact every zero has the same sign, whatever it comes from: it is part of the state.
  return {t.raw,       touches ? fx : none, touches ? fy : none,         touches ? fz : none,
          lost * t.tx, lost * t.ty,         kPlane ? none : lost * t.tz, slides ? loss : none,
          slides};
}

// Stores the projected trial. `kKeepsAnchor`: on a plane a sticking anchor stays bit-identical,
// whereas c - (c - a) keeps it only up to rounding.
template <class Real, bool kPlane, bool kKeepsAnchor>
SLIPBENCH_INLINE void commit_state(const Columns& c, std::size_t i, const TrialState<Real>& t,
                                   const ProjectedState<Real>& projected) {
  const Real none{}, one = none + 1.0;
  const Flag<Real> touches = t.f_n > none, stays = touches != projected.slides;
  const auto set = [i](double* column, const Real& value) SLIPBENCH_INLINE_BODY { put_vector(column + i, value); };
  const auto move_anchor = [&](double* anchor, const double* contact, const Real& stretch, const Real& slip)
                               SLIPBENCH_INLINE_BODY {
                                 const Real left = stretch - slip, moved = entry<Real>(contact, i) - (touches ? left : none);
                                 set(anchor, kKeepsAnchor ? (stays ? entry<Real>(anchor, i) : moved) : moved);
                               };
  set(c.f_normal, projected.raw);
  set(c.slip.x, projected.sx);
  set(c.slip.y, projected.sy);
  move_anchor(c.anchor.x, c.contact.x, t.ux, projected.sx);
  move_anchor(c.anchor.y, c.contact.y, t.uy, projected.sy);
  set(c.force.x, projected.fx);
  set(c.force.y, projected.fy);
  if constexpr (!kPlane) {
    set(c.slip.z, projected.sz);
    move_anchor(c.anchor.z, c.contact.z, t.uz, projected.sz);
    set(c.force.z, projected.fz);
  }
  set(c.limit, entry<Real>(c.mu_static, i) * positive(projected.raw));
  set(c.path, entry<Real>(c.path, i) + projected.path);
  set(c.mode, (touches ? one : none) + (projected.slides ? one : none));
}

// Maps `count` elements one by one; `project_onto_cone(i, trial)` projects those that touch onto the
// cone. `plane`, `extended`: as for return_map().
template <class Cone>
void return_map_each(const Columns& c, bool plane, bool extended, std::size_t count, const Cone& project_onto_cone) {
  for (std::size_t i = 0; i < count; ++i) {
    const Trial trial = extended ? find_trial<double, false, true>(c, i) : find_trial<double, false, false>(c, i);
    Projected projected{};
    projected.raw = trial.raw;
    if (trial.f_n > 0.0) projected = project_onto_cone(i, trial);
    plane ? commit_state<double, true, true>(c, i, trial, projected) : commit_state<double, false, false>(c, i, trial, projected);
  }
}

}  // namespace slipbench::kernel
