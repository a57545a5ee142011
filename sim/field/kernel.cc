#include "sim/field/kernel.h"

// Each pass is compiled for x86-64-v3 and for any x86-64, and the loader picks one by the CPU it finds. Sanitizers do not survive the
// loader's early calls, and other compilers lack the attribute: they get the portable version, which computes the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__OPTIMIZE__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SLIPBENCH_DISPATCHED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SLIPBENCH_DISPATCHED
#endif
#if defined(__clang__)
#define SLIPBENCH_VECTORISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define SLIPBENCH_VECTORISE _Pragma("GCC ivdep")
#endif
#define SLIPBENCH_INLINE inline __attribute__((always_inline))

namespace slipbench::kernel {
namespace {

template <bool kPlane, bool kMemory>
SLIPBENCH_INLINE void map_element(const Mapping& m, std::size_t i) {
  const double raw = raw_press(m.gap[i], m.k_normal[i], kMemory ? m.h_normal[i] : 0.0);
  const double f_n = 0.5 * (raw + std::abs(raw));  // max(0, raw), exactly; a select here would be threaded into jumps
  const double k = m.k_tangential[i], compliance = m.compliance[i];
  const bool touches = f_n > 0.0;
  const bool slid = m.mode_before[i] == 2.0;

  double ux = m.contact_x[i] - m.anchor_x[i];
  double uy = m.contact_y[i] - m.anchor_y[i];
  double uz = 0.0;
  if constexpr (!kPlane) {
    uz = m.contact_z[i] - m.anchor_z[i];
    const double along = ux * m.normal_x[i] + uy * m.normal_y[i] + uz * m.normal_z[i];
    ux -= along * m.normal_x[i];
    uy -= along * m.normal_y[i];
    uz -= along * m.normal_z[i];
  }
  double tx = k * ux, ty = k * uy, tz = kPlane ? 0.0 : k * uz;
  if constexpr (kMemory) {
    double hx = m.h_x[i], hy = m.h_y[i];
    if constexpr (!kPlane) {  // the history was made in an earlier tangent plane
      double hz = m.h_z[i];
      const double along = hx * m.normal_x[i] + hy * m.normal_y[i] + hz * m.normal_z[i];
      hx -= along * m.normal_x[i];
      hy -= along * m.normal_y[i];
      hz -= along * m.normal_z[i];
      tz += hz;
    }
    tx += hx;
    ty += hy;
  }

  const double limit_stick = m.mu_static[i] * f_n;
  const double limit_slide = m.mu_kinetic[i] * f_n;
  const double limit = slid ? limit_slide : limit_stick;
  const double t2 = tx * tx + ty * ty + (kPlane ? 0.0 : tz * tz);
  const double size = std::sqrt(t2);
  const bool slides = touches & (size > limit + k * shortest_slip);
  const double ratio = limit_slide / size;
  const double scale = slides ? ratio : 1.0;
  const double loss = (size - limit_slide) * compliance;

  const double held = touches ? scale : 0.0;
  const double fx = held * tx, fy = held * ty, fz = held * tz;
  // With u = (f - h) / k the anchor lies at c - u; the slip of this step is what the stretch lost.
  const double lost = slides ? (1.0 - scale) * compliance : 0.0;
  const double sx = lost * tx, sy = lost * ty, sz = kPlane ? 0.0 : lost * tz;
  const double vx = touches ? ux - sx : 0.0;
  const double vy = touches ? uy - sy : 0.0;

  m.press[i] = raw;
  m.slip_x[i] = sx;
  m.slip_y[i] = sy;
  m.anchor_x[i] = m.contact_x[i] - vx;
  m.anchor_y[i] = m.contact_y[i] - vy;
  m.force_x[i] = fx;
  m.force_y[i] = fy;
  if constexpr (!kPlane) {
    const double vz = touches ? uz - sz : 0.0;
    m.slip_z[i] = sz;
    m.anchor_z[i] = m.contact_z[i] - vz;
    m.force_z[i] = fz;
  }
  m.limit[i] = limit_stick;
  m.path[i] += slides ? loss : 0.0;
  const double moving = slides ? 2.0 : 1.0;
  m.mode[i] = touches ? moving : 0.0;
}

template <bool kPlane, bool kMemory>
SLIPBENCH_INLINE void map_all(const Mapping& m, std::size_t count) {
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) map_element<kPlane, kMemory>(m, i);
}

SLIPBENCH_DISPATCHED void map_on_plane(const Mapping& m, std::size_t count) { map_all<true, false>(m, count); }
SLIPBENCH_DISPATCHED void map_on_plane_with_memory(const Mapping& m, std::size_t count) { map_all<true, true>(m, count); }
SLIPBENCH_DISPATCHED void map_on_curve(const Mapping& m, std::size_t count) { map_all<false, false>(m, count); }
SLIPBENCH_DISPATCHED void map_on_curve_with_memory(const Mapping& m, std::size_t count) { map_all<false, true>(m, count); }

}  // namespace

SLIPBENCH_DISPATCHED void plane_gap(const PlaneGap& p, std::size_t count) {
  const double r00 = p.rotation(0, 0), r01 = p.rotation(0, 1), r02 = p.rotation(0, 2);
  const double r10 = p.rotation(1, 0), r11 = p.rotation(1, 1), r12 = p.rotation(1, 2);
  const double r20 = p.rotation(2, 0), r21 = p.rotation(2, 1), r22 = p.rotation(2, 2);
  const double x0 = p.position.x(), y0 = p.position.y(), z0 = p.position.z();
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double x = p.tip_x[i], y = p.tip_y[i], z = p.tip_z[i];
    p.contact_x[i] = r00 * x + r01 * y + r02 * z + x0;
    p.contact_y[i] = r10 * x + r11 * y + r12 * z + y0;
    p.gap[i] = r20 * x + r21 * y + r22 * z + z0;
  }
  if (p.axes_differ) {
    SLIPBENCH_VECTORISE
    for (std::size_t i = 0; i < count; ++i) {
      const double looks = r20 * p.axis_x[i] + r21 * p.axis_y[i] + r22 * p.axis_z[i];
      p.gap[i] = looks < 0.0 ? p.gap[i] : std::abs(p.gap[i]);
    }
  } else if (!(p.rotation.row(2).dot(p.axis_of_all) < 0.0)) {
    for (std::size_t i = 0; i < count; ++i) p.gap[i] = std::abs(p.gap[i]);
  }
}

SLIPBENCH_DISPATCHED void view_from_pad(const PadView& p, std::size_t count) {
  const double r00 = p.to_pad(0, 0), r01 = p.to_pad(0, 1), r02 = p.to_pad(0, 2);
  const double r10 = p.to_pad(1, 0), r11 = p.to_pad(1, 1), r12 = p.to_pad(1, 2);
  const double r20 = p.to_pad(2, 0), r21 = p.to_pad(2, 1), r22 = p.to_pad(2, 2);
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double nx = p.normal_x[i], ny = p.normal_y[i], nz = p.normal_z[i];
    const double f_n = 0.5 * (p.press[i] + std::abs(p.press[i]));
    const double depth = 0.5 * (std::abs(p.gap[i]) - p.gap[i]);
    const double fx = f_n * nx - p.force_x[i], fy = f_n * ny - p.force_y[i], fz = f_n * nz - p.force_z[i];
    const double dx = depth * nx - (p.contact_x[i] - p.anchor_x[i]);
    const double dy = depth * ny - (p.contact_y[i] - p.anchor_y[i]);
    const double dz = depth * nz - (p.contact_z[i] - p.anchor_z[i]);
    p.pad_force_x[i] = r00 * fx + r01 * fy + r02 * fz;
    p.pad_force_y[i] = r10 * fx + r11 * fy + r12 * fz;
    p.pad_force_z[i] = r20 * fx + r21 * fy + r22 * fz;
    p.deflection_x[i] = r00 * dx + r01 * dy + r02 * dz;
    p.deflection_y[i] = r10 * dx + r11 * dy + r12 * dz;
    p.deflection_z[i] = r20 * dx + r21 * dy + r22 * dz;
    p.pad_slip_x[i] = r00 * p.slip_x[i] + r01 * p.slip_y[i] + r02 * p.slip_z[i];
    p.pad_slip_y[i] = r10 * p.slip_x[i] + r11 * p.slip_y[i] + r12 * p.slip_z[i];
  }
}

void map(const Mapping& pass, bool plane, bool memory, std::size_t count) {
  if (plane) {
    memory ? map_on_plane_with_memory(pass, count) : map_on_plane(pass, count);
  } else {
    memory ? map_on_curve_with_memory(pass, count) : map_on_curve(pass, count);
  }
}

}  // namespace slipbench::kernel
