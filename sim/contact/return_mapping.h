// The return mapping of one element onto its friction cone (field.h), common to all cones.
//
// It takes a trial force with the anchor unchanged, its projection onto the cone
// (map_onto_circle; map_onto for other cones), and the element's new state. The kernel inlines all
// three and, for the circular cone, works on several elements at once.
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
SLIPBENCH_INLINE Real entry(const Columns& c, Column column, std::size_t i) {
  return vector_at<Real>(c[column] + i);
}
template <class Real>
using Flag = decltype(Real{} < Real{});

// Forces of an element if its anchor stays. Vectors are tangential.
template <class Real>
struct TrialOf {
  Real raw, f_n;    // normal force: raw is negative while separated, f_n is 0 then [N]
  Real ux, uy, uz;  // stretch [m]
  Real hx, hy, hz;  // history of the rheology [N]
  Real tx, ty, tz;  // force k u + h [N]
};
using Trial = TrialOf<double>;

template <class Real, bool kPlane, bool kExtended>
SLIPBENCH_INLINE TrialOf<Real> trial_of(const Columns& c, std::size_t i) {
  const auto at = [&c, i](Column column) SLIPBENCH_INLINE_BODY { return entry<Real>(c, column, i); };
  TrialOf<Real> t{};
  t.raw = raw_normal_force<Real>(at(gap), at(k_normal), kExtended ? at(h_normal) : Real{});
  t.f_n = positive(t.raw);
  const Real k = at(k_tangential), nx = at(normal_x), ny = at(normal_y), nz = at(normal_z);
  t.ux = at(contact_x) - at(anchor_x);
  t.uy = at(contact_y) - at(anchor_y);
  if constexpr (!kPlane) {
    t.uz = at(contact_z) - at(anchor_z);
    const Real along = t.ux * nx + t.uy * ny + t.uz * nz;
    t.ux -= along * nx;
    t.uy -= along * ny;
    t.uz -= along * nz;
  }
  t.tx = k * t.ux;
  t.ty = k * t.uy;
  if constexpr (!kPlane) t.tz = k * t.uz;
  if constexpr (kExtended) {
    if (c[h_x] != nullptr) {
      t.hx = at(h_x);
      t.hy = at(h_y);
      if constexpr (!kPlane) {  // the history was computed in an earlier tangent plane
        t.hz = at(h_z);
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
struct MappedOf {
  Real raw;         // normal force, negative while separated [N]
  Real fx, fy, fz;  // tangential force [N]
  Real sx, sy, sz;  // slip, by which the stretch is reduced [m]
  Real path;        // its length [m]
  Flag<Real> slides;
};
using Mapped = MappedOf<double>;

template <class Real, bool kPlane>
SLIPBENCH_INLINE Real size_of(const TrialOf<Real>& t) {
  const Real squared = t.tx * t.tx + t.ty * t.ty;
  return root(kPlane ? squared : squared + t.tz * t.tz);
}

// Returns the size of a trial force [N] beyond which element i slips: `stick` mu_s f_n or, if it
// slipped before, `slide` mu_k f_n. By a rate law mu_k may be the larger one. A slip shorter than
// shortest_slip does not count.
template <class Real, bool kExtended>
SLIPBENCH_INLINE Real slips_beyond(const Columns& c, std::size_t i, const Real& stick, const Real& slide) {
  const Real onset = kExtended ? (slide > stick ? slide : stick) : stick;
  return (entry<Real>(c, mode_before, i) == 2.0 ? slide : onset) + entry<Real>(c, k_tangential, i) * shortest_slip;
}

// Projects onto Coulomb's circular cone, also for elements without contact.
template <class Real, bool kPlane, bool kExtended>
SLIPBENCH_INLINE MappedOf<Real> map_onto_circle(const Columns& c, std::size_t i, const TrialOf<Real>& t) {
  const Real none{}, one = none + 1.0, softness = entry<Real>(c, compliance, i);
  const Flag<Real> touches = t.f_n > none;
  const Real limit_stick = entry<Real>(c, mu_static, i) * t.f_n, limit_slide = entry<Real>(c, mu_kinetic, i) * t.f_n;
  const Real size = size_of<Real, kPlane>(t);
  const Flag<Real> slides = touches & (size > slips_beyond<Real, kExtended>(c, i, limit_stick, limit_slide));
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
SLIPBENCH_INLINE void take_over(const Columns& c, std::size_t i, const TrialOf<Real>& t, const MappedOf<Real>& m) {
  const Real none{}, one = none + 1.0;
  const Flag<Real> touches = t.f_n > none, stays = touches != m.slides;
  const auto set = [&c, i](Column column, const Real& value) SLIPBENCH_INLINE_BODY { put_vector(c[column] + i, value); };
  const auto move_anchor = [&](Column anchor, Column contact, const Real& stretch, const Real& slip) SLIPBENCH_INLINE_BODY {
    const Real left = stretch - slip, moved = entry<Real>(c, contact, i) - (touches ? left : none);
    set(anchor, kKeepsAnchor ? (stays ? entry<Real>(c, anchor, i) : moved) : moved);
  };
  set(f_normal, m.raw);
  set(slip_x, m.sx);
  set(slip_y, m.sy);
  move_anchor(anchor_x, contact_x, t.ux, m.sx);
  move_anchor(anchor_y, contact_y, t.uy, m.sy);
  set(force_x, m.fx);
  set(force_y, m.fy);
  if constexpr (!kPlane) {
    set(slip_z, m.sz);
    move_anchor(anchor_z, contact_z, t.uz, m.sz);
    set(force_z, m.fz);
  }
  set(limit, entry<Real>(c, mu_static, i) * positive(m.raw));
  set(path, entry<Real>(c, path, i) + m.path);
  set(mode, (touches ? one : none) + (m.slides ? one : none));
}

// Maps `count` elements one by one; `map_onto(i, trial)` projects those that touch onto the cone.
// `plane`, `extended`: as for map().
template <class Cone>
void map_each(const Columns& c, bool plane, bool extended, std::size_t count, const Cone& map_onto) {
  for (std::size_t i = 0; i < count; ++i) {
    const Trial trial = extended ? trial_of<double, false, true>(c, i) : trial_of<double, false, false>(c, i);
    Mapped mapped{};
    mapped.raw = trial.raw;
    if (trial.f_n > 0.0) mapped = map_onto(i, trial);
    plane ? take_over<double, true, true>(c, i, trial, mapped) : take_over<double, false, false>(c, i, trial, mapped);
  }
}

}  // namespace slipbench::kernel
