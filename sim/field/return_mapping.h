// The return mapping of one element onto its friction cone (field.h): one for all cones.
//
// A trial force with the anchor where it was, what the cone makes of it (map_onto_circle; map_onto of other cones), and the element's new
// state. The kernel inlines all three and, of a circle, works on several elements at once.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "sim/core/vectorise.h"
#include "sim/field/effect.h"
#include "sim/field/kernel.h"

namespace slipbench::kernel {

// Of an element while its anchor stays. Vectors are tangential.
struct Trial {
  double raw, f_n;    // normal force: negative while apart, and 0 then [N]
  double ux, uy, uz;  // stretch [m]
  double hx, hy, hz;  // history of the rheology [N]
  double tx, ty, tz;  // force k u + h [N]
};

template <bool kPlane, bool kExtended>
SLIPBENCH_INLINE Trial trial_of(const Columns& c, std::size_t i) {
  Trial t{};
  t.raw = raw_normal_force(c[gap][i], c[k_normal][i], kExtended ? c[h_normal][i] : 0.0);
  t.f_n = 0.5 * (t.raw + std::abs(t.raw));  // max(0, raw), exactly; a select here would be threaded into jumps
  const double k = c[k_tangential][i];
  t.ux = c[contact_x][i] - c[anchor_x][i];
  t.uy = c[contact_y][i] - c[anchor_y][i];
  if constexpr (!kPlane) {
    t.uz = c[contact_z][i] - c[anchor_z][i];
    const double along = t.ux * c[normal_x][i] + t.uy * c[normal_y][i] + t.uz * c[normal_z][i];
    t.ux -= along * c[normal_x][i];
    t.uy -= along * c[normal_y][i];
    t.uz -= along * c[normal_z][i];
  }
  t.tx = k * t.ux;
  t.ty = k * t.uy;
  t.tz = kPlane ? 0.0 : k * t.uz;
  if constexpr (kExtended) {
    t.hx = c[h_x][i];
    t.hy = c[h_y][i];
    if constexpr (!kPlane) {  // the history was made in an earlier tangent plane
      t.hz = c[h_z][i];
      const double along = t.hx * c[normal_x][i] + t.hy * c[normal_y][i] + t.hz * c[normal_z][i];
      t.hx -= along * c[normal_x][i];
      t.hy -= along * c[normal_y][i];
      t.hz -= along * c[normal_z][i];
      t.tz += t.hz;
    }
    t.tx += t.hx;
    t.ty += t.hy;
  }
  return t;
}

// What a cone makes of a trial: the element after the step.
struct Mapped {
  double raw;         // normal force, negative while apart [N]
  double fx, fy, fz;  // tangential force [N]
  double sx, sy, sz;  // slip, by which the stretch is shorter [m]
  double path;        // its length [m]
  bool slides;
};

// The size of a trial force [N] beyond which element i slips: `stick` mu_s f_n, or, once it has begun, `slide` mu_k f_n. By a rate law mu_k may be
// the larger one, and slip is no slip while it is shorter than what counts.
template <bool kExtended>
SLIPBENCH_INLINE double slips_beyond(const Columns& c, std::size_t i, double stick, double slide) {
  const double onset = kExtended && slide > stick ? slide : stick;
  return (c[mode_before][i] == 2.0 ? slide : onset) + c[k_tangential][i] * shortest_slip;
}

// Coulomb's circular cone, also for what does not touch.
template <bool kPlane, bool kExtended>
SLIPBENCH_INLINE Mapped map_onto_circle(const Columns& c, std::size_t i, const Trial& t) {
  const double softness = c[compliance][i];
  const bool touches = t.f_n > 0.0;
  const double limit_slide = c[mu_kinetic][i] * t.f_n;
  const double size = std::sqrt(t.tx * t.tx + t.ty * t.ty + (kPlane ? 0.0 : t.tz * t.tz));
  const bool slides = touches & (size > slips_beyond<kExtended>(c, i, c[mu_static][i] * t.f_n, limit_slide));
  const double ratio = limit_slide / size;
  const double scale = slides ? ratio : 1.0;
  const double loss = (size - limit_slide) * softness;
  // With u = (f - h) / k the anchor lies at c - u; the slip of this step is what the stretch lost.
  const double lost = slides ? (1.0 - scale) * softness : 0.0;
  // Of what does not touch every zero has the same sign, whatever it has come from: it is part of the state.
  return {t.raw,
          touches ? scale * t.tx : 0.0,
          touches ? scale * t.ty : 0.0,
          touches ? scale * t.tz : 0.0,
          lost * t.tx,
          lost * t.ty,
          kPlane ? 0.0 : lost * t.tz,
          slides ? loss : 0.0,
          slides};
}

// Takes over what the cone has made of the trial. `kKeepsAnchor`: on a plane an anchor that sticks stays to the bit, which c - (c - a) does up to
// rounding only.
template <bool kPlane, bool kKeepsAnchor>
SLIPBENCH_INLINE void take_over(const Columns& c, std::size_t i, const Trial& t, const Mapped& m) {
  const bool touches = t.f_n > 0.0;
  const double vx = touches ? t.ux - m.sx : 0.0;
  const double vy = touches ? t.uy - m.sy : 0.0;
  const bool stays = kKeepsAnchor && touches && !m.slides;
  c[f_normal][i] = m.raw;
  c[slip_x][i] = m.sx;
  c[slip_y][i] = m.sy;
  c[anchor_x][i] = stays ? c[anchor_x][i] : c[contact_x][i] - vx;
  c[anchor_y][i] = stays ? c[anchor_y][i] : c[contact_y][i] - vy;
  c[force_x][i] = m.fx;
  c[force_y][i] = m.fy;
  if constexpr (!kPlane) {
    const double vz = touches ? t.uz - m.sz : 0.0;
    c[slip_z][i] = m.sz;
    c[anchor_z][i] = c[contact_z][i] - vz;
    c[force_z][i] = m.fz;
  }
  c[limit][i] = c[mu_static][i] * (0.5 * (m.raw + std::abs(m.raw)));
  c[path][i] += m.path;
  const double moving = m.slides ? 2.0 : 1.0;
  c[mode][i] = touches ? moving : 0.0;
}

// Maps `count` elements one after the other onto a cone `map_onto(i, trial)` of those that touch. `plane`, `extended`: as for map().
template <class Cone>
void map_each(const Columns& c, bool plane, bool extended, std::size_t count, const Cone& map_onto) {
  for (std::size_t i = 0; i < count; ++i) {
    const Trial trial = extended ? trial_of<false, true>(c, i) : trial_of<false, false>(c, i);
    Mapped mapped{};
    mapped.raw = trial.raw;
    if (trial.f_n > 0.0) mapped = map_onto(i, trial);
    plane ? take_over<true, true>(c, i, trial, mapped) : take_over<false, false>(c, i, trial, mapped);
  }
}

}  // namespace slipbench::kernel

namespace slipbench {

// What `cone` makes of the trial of element i, which touches. `rate`: null, or a rate law in a step of `dt` > 0 [s].
[[nodiscard]] kernel::Mapped map_onto(const ConeEffect& cone, RateEffect* rate, double dt, const kernel::Columns& columns,
                                      std::size_t i, const kernel::Trial& trial);

// What Coulomb's cone makes of it where elements are columns (effect.h's Lean); the trial is that of an upright one. Also writes the columns trial
// and slide. Throws InputError where the column is loaded beyond what its stop holds.
[[nodiscard]] kernel::Mapped map_onto(const Lean& lean, const RateEffect* rate, double dt, const kernel::Columns& columns,
                                      std::size_t i, const kernel::Trial& trial);

}  // namespace slipbench
