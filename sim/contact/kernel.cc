// The passes of a step over all elements, vectorised; field.h states the law.
//
// Backward Euler for one element, over a step with the contact point c, the anchor a and the normal
// n at its end (return mapping: [simo1998], sec. 1.2 and 3):
//   trial    f_n = max(0, k_n (-gap) + h_n), u = P (c - a), T = k_t u + h_t; P = I - n n'
//   project  |T| <= mu_s f_n (mu_k f_n if the element slipped): f = T, otherwise f = mu_k f_n T/|T|,
//            the closest point of the circle of radius mu_k f_n
//   commit   slip s = (T - f)/k_t, anchor a' = c - (u - s), dissipated energy f . s >= 0
// h: history of a rheology, 0 without one. T and f are parallel, so f needs one square root and no
// iteration. s = 0 for a sticking element, so its anchor stays.
#include "sim/contact/kernel.h"

#include <algorithm>

#include "sim/contact/return_mapping.h"
#include "sim/contact/vectorise.h"

namespace slipbench::kernel {
namespace {

SLIPBENCH_INLINE double total(const Lanes& sums) { return (sums[0] + sums[1]) + (sums[2] + sums[3]); }
SLIPBENCH_INLINE Eigen::Vector3d total(const LaneVectors& sums) { return {total(sums.x), total(sums.y), total(sums.z)}; }

// Row `row` of a rotated vector, in the order in which Eigen adds up a product, for bit-identical
// results.
SLIPBENCH_INLINE Lanes turned(const Eigen::Matrix3d& r, int row, const Lanes& x, const Lanes& y, const Lanes& z) {
  return row < 2 ? r(row, 0) * x + r(row, 1) * y + r(row, 2) * z : r(row, 0) * x + (r(row, 1) * y + r(row, 2) * z);
}

// The three stages for one vector of elements.
template <bool kPlane, bool kExtended>
SLIPBENCH_INLINE void return_map_group(const Columns& c, std::size_t i) {
  const auto t = find_trial<Lanes, kPlane, kExtended>(c, i);
  commit_state<Lanes, kPlane, kPlane && kExtended>(c, i, t, project_onto_circle<Lanes, kPlane, kExtended>(c, i, t));
}

template <bool kPlane, bool kExtended>
SLIPBENCH_INLINE void return_map_all(const Columns& c, const Groups& groups) {
  for (std::size_t k = 0; k < groups.count; ++k) return_map_group<kPlane, kExtended>(c, groups[k]);
}

SLIPBENCH_DISPATCHED void return_map_on_plane(const Columns& c, const Groups& groups) { return_map_all<true, false>(c, groups); }
SLIPBENCH_DISPATCHED void return_map_on_plane_extended(const Columns& c, const Groups& groups) {
  return_map_all<true, true>(c, groups);
}
SLIPBENCH_DISPATCHED void return_map_on_curve(const Columns& c, const Groups& groups) { return_map_all<false, false>(c, groups); }
SLIPBENCH_DISPATCHED void return_map_on_curve_extended(const Columns& c, const Groups& groups) {
  return_map_all<false, true>(c, groups);
}

// The sizes of the trial forces and their limits while slipping, for a rate law.
template <bool kPlane>
SLIPBENCH_INLINE void find_all_trials(const Columns& c, std::size_t count) {
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto t = find_trial<Lanes, kPlane, true>(c, i);
    put(c.trial, i, size_of<Lanes, kPlane>(t));
    put(c.slide, i, at(c.mu_kinetic, i) * t.f_n);
  }
}

SLIPBENCH_DISPATCHED void find_trials_on_plane(const Columns& c, std::size_t count) { find_all_trials<true>(c, count); }
SLIPBENCH_DISPATCHED void find_trials_on_curve(const Columns& c, std::size_t count) { find_all_trials<false>(c, count); }

// Contact points and gaps below a plane: the tips, projected along its normal.
SLIPBENCH_INLINE void locate_group(const Columns& c, const Pose& pose, std::size_t i) {
  const Eigen::Matrix3d& r = pose.rotation;
  const Eigen::Vector3d& p = pose.position;
  const Lanes x = at(c.tip.x, i), y = at(c.tip.y, i), z = at(c.tip.z, i);
  put(c.contact.x, i, r(0, 0) * x + r(0, 1) * y + r(0, 2) * z + p.x());
  put(c.contact.y, i, r(1, 0) * x + r(1, 1) * y + r(1, 2) * z + p.y());
  put(c.gap, i, r(2, 0) * x + r(2, 1) * y + r(2, 2) * z + p.z());
}

}  // namespace

SLIPBENCH_DISPATCHED void plane_gap(const Columns& c, const Pose& pose, std::size_t count) {
  for (std::size_t i = 0; i < count; i += lanes) locate_group(c, pose, i);
}

// An element that points away from the plane does not enter it.
SLIPBENCH_DISPATCHED void turn_away(const Columns& c, const Pose& pose, std::size_t count) {
  const double rx = pose.rotation(2, 0), ry = pose.rotation(2, 1), rz = pose.rotation(2, 2);
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double upward = rx * c.axis.x[i] + ry * c.axis.y[i] + rz * c.axis.z[i];
    c.gap[i] = upward < 0.0 ? c.gap[i] : std::abs(c.gap[i]);
  }
}

namespace {

// Each tip is moved into the surface frame; the shape gives its gap, normal and face.
template <bool kThin, class Shape>
SLIPBENCH_INLINE void meet_all(const Columns& c, const Shape& shape, const Pose& pose, const Groups& groups, double column) {
  const Eigen::Matrix3d& r = pose.rotation;
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    const Lanes x = at(c.tip.x, i), y = at(c.tip.y, i), z = at(c.tip.z, i);
    const Lanes u = at(c.axis.x, i), v = at(c.axis.y, i), w = at(c.axis.z, i);
    const Lanes tip[3] = {turned(r, 0, x, y, z) + pose.position.x(), turned(r, 1, x, y, z) + pose.position.y(),
                          turned(r, 2, x, y, z) + pose.position.z()};
    const Lanes axis[3] = {turned(r, 0, u, v, w), turned(r, 1, u, v, w), turned(r, 2, u, v, w)};
    const NearestPoint<Lanes> met = shape.template nearest<kThin>(tip, axis, column);
    put(c.gap, i, met.gap);
    put(c.normal, i, {met.nx, met.ny, met.nz});
    put(c.contact, i, {tip[0] - met.gap * met.nx, tip[1] - met.gap * met.ny, tip[2] - met.gap * met.nz});
    put(c.faces, i, met.faces);
  }
}

}  // namespace

SLIPBENCH_DISPATCHED void meet_box(const Columns& c, const Box& box, const Pose& pose, const Groups& groups, double column) {
  box.is_thin(column) ? meet_all<true>(c, box, pose, groups, column) : meet_all<false>(c, box, pose, groups, column);
}

SLIPBENCH_DISPATCHED void meet_cylinder(const Columns& c, const Cylinder& cylinder, const Pose& pose, const Groups& groups,
                                        double column) {
  cylinder.is_thin(column) ? meet_all<true>(c, cylinder, pose, groups, column)
                           : meet_all<false>(c, cylinder, pose, groups, column);
}

// A group stays active while one of its elements touches or has touched in the last two steps.
SLIPBENCH_DISPATCHED Sorted sort_groups(const Columns& c, const Groups& candidates, std::uint32_t* active, std::uint32_t* idle) {
  const Lanes none{};
  Sorted found{};
  Mask touches{};
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const std::size_t i = candidates[k];
    const Lanes raw = raw_normal_force(at(c.gap, i), at(c.k_normal, i), none), before = at(c.before.mode, i);
    const Mask pressed = raw > 0.0, apart = before == 0.0;
    touches |= pressed & apart;
    // The column of modes still holds those of two steps ago; this step will overwrite it.
    if (any(pressed | ~apart | (at(c.mode, i) != 0.0))) {
      active[found.active++] = static_cast<std::uint32_t>(i);
      continue;
    }
    idle[found.idle++] = static_cast<std::uint32_t>(i);
    put(c.f_normal, i, raw);
    put(c.anchor, i, at(c.contact, i));
  }
  found.touches = any(touches);
  return found;
}

// Idle groups have no contact: their anchors follow their roots.
SLIPBENCH_DISPATCHED void reset_idle(const Columns& c, const Groups& groups) {
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    const Lanes raw = raw_normal_force(at(c.gap, i), at(c.k_normal, i), Lanes{});
    put(c.f_normal, i, raw);
    put(c.before.f_normal, i, raw);
    put(c.before.gap, i, at(c.gap, i));
    put(c.faces_before, i, at(c.faces, i));
    const LaneVectors place = at(c.contact, i);
    put(c.before.contact, i, place);
    put(c.anchor, i, place);
  }
}

// Compares the states with those of the last step.
SLIPBENCH_DISPATCHED bool any_changes(const Columns& c, const Groups& groups) {
  Mask changed{};
  for (std::size_t k = 0; k < groups.count; ++k) changed |= at(c.mode, groups[k]) != at(c.before.mode, groups[k]);
  return any(changed);
}

SLIPBENCH_DISPATCHED bool any_deeper(const Columns& c, double depth, const Groups& groups) {
  Mask deeper{};
  for (std::size_t k = 0; k < groups.count; ++k) deeper |= -at(c.gap, groups[k]) > depth;
  return any(deeper);
}

// A stuck tip is at its anchor; a slipping one trails its root by its stretch after the last step.
SLIPBENCH_DISPATCHED void place_tips(const Columns& c, std::size_t count) {
  for (std::size_t i = 0; i < count; i += lanes) {
    const LaneVectors contact = at(c.contact, i), anchor = at(c.anchor, i), normal = at(c.normal, i), way = contact - anchor;
    const LaneVectors stretch = way - dot(way, normal) * normal, before = at(c.before.contact, i) - anchor;
    const Lanes stretch2 = dot(stretch, stretch), before2 = dot(before, before), state = at(c.before.mode, i), none{};
    // A detached tip, state 0, is under its root.
    const Lanes trails = stretch2 > before2 ? root(before2 / stretch2) : none + 1.0;
    const Lanes share = state == 2.0 ? trails : none;
    put(c.place, i, select(state == 1.0, anchor, contact - share * stretch));
  }
}

// Looks for a face that changed inside the surface, or an offset that remains from such a change.
SLIPBENCH_DISPATCHED bool all_keep_faces(const Columns& c, const Groups& groups) {
  Mask changed{};
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    changed |= (at(c.depth_offset, i) != 0.0) | ((at(c.gap, i) < 0.0) & (at(c.faces, i) != at(c.faces_before, i)));
  }
  return !any(changed);
}

// Writes what commit_state() would write for elements without contact.
SLIPBENCH_DISPATCHED bool update_if_separated(const Columns& c, std::size_t count) {
  Mask near{};
  for (std::size_t i = 0; i < count; i += lanes) near |= (at(c.gap, i) < 0.0) | (at(c.depth_offset, i) != 0.0);
  if (any(near)) return false;
  const Lanes none{};
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto t = find_trial<Lanes, false, true>(c, i);
    put(c.f_normal, i, t.raw);
    put(c.slip, i, {none * t.tx, none * t.ty, none * t.tz});
    put(c.anchor, i, at(c.contact, i));
    put(c.force, i, {none, none, none});
    put(c.limit, i, none);
    put(c.mode, i, none);
  }
  return true;
}

// Looks for an element that has a normal force and had no contact before.
SLIPBENCH_DISPATCHED bool any_touches(const Columns& c, bool memory, std::size_t count) {
  Mask touched{};
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes history = memory ? at(c.history.normal, i) : Lanes{};
    touched |= (at(c.before.mode, i) == 0.0) & (raw_normal_force(at(c.gap, i), at(c.k_normal, i), history) > 0.0);
  }
  return any(touched);
}

// Both passes in one loop, so that the contact points stay in registers.
SLIPBENCH_DISPATCHED void slide_on_plane(const Columns& c, const Pose& pose, std::size_t count) {
  for (std::size_t i = 0; i < count; i += lanes) {
    locate_group(c, pose, i);
    return_map_group<true, false>(c, i);
  }
}

// The normal force and the friction limit; the tips themselves are moved by the TipEffect.
SLIPBENCH_DISPATCHED void load_tips(const Columns& c, std::size_t count) {
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double raw = raw_normal_force(c.gap[i], c.k_normal[i], 0.0);
    c.f_normal[i] = raw;
    c.limit[i] = c.mu_static[i] * (0.5 * (raw + std::abs(raw)));
  }
}

SLIPBENCH_DISPATCHED void clear_ended_slip(const Columns& c, std::size_t count) {
  const Lanes none{};
  for (std::size_t i = 0; i < count; i += lanes) {
    const Mask slips = at(c.mode, i) == 2.0;
    put(c.slip.x, i, slips ? at(c.slip.x, i) : none);
    put(c.slip.y, i, slips ? at(c.slip.y, i) : none);
  }
}

// Rotates forces, deflections and slip from S into the pad frame.
SLIPBENCH_DISPATCHED void view_from_pad(const Columns& c, const Eigen::Matrix3d& rotation, const VectorColumns& transmitted,
                                        const Groups& groups, std::size_t vectors) {
  const VectorColumns felt = transmitted;
  const Rotation r = entries_back(rotation);
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    const LaneVectors normal = at(c.normal, i);
    put(c.pad.force, i, turned(r, positive(at(c.f_normal, i)) * normal - at(felt, i)));
    if (vectors == 1) continue;
    const Lanes indentation = positive<Lanes>(-at(c.gap, i));
    put(c.pad.deflection, i, turned(r, indentation * normal - (at(c.contact, i) - at(c.anchor, i))));
    if (vectors == 2) continue;
    put(c.pad.slip, i, turned(r, at(c.slip, i)));
  }
}

// Adds depths, and the deflections of the tips along the surface.
SLIPBENCH_DISPATCHED void add_elements(const Columns& c, const Eigen::Matrix3d& to_pad, const Groups& groups, double* depth,
                                       const std::array<double*, 3>& shear, std::size_t count) {
  const Rotation r = entries_of(to_pad);
  double *const sx = shear[0], *const sy = shear[1], *const sz = shear[2];
  const auto add = [&](std::size_t first, std::size_t end) SLIPBENCH_INLINE_BODY {
    SLIPBENCH_VECTORISE
    for (std::size_t i = first; i < end; ++i) {
      // The anchor lies in the surface's tangent plane through the contact point, so the difference
      // has no normal part.
      const double dx = c.anchor.x[i] - c.contact.x[i], dy = c.anchor.y[i] - c.contact.y[i], dz = c.anchor.z[i] - c.contact.z[i];
      depth[i] += 0.5 * (std::abs(c.gap[i]) - c.gap[i]);
      sx[i] += r.r00 * dx + r.r01 * dy + r.r02 * dz;
      sy[i] += r.r10 * dx + r.r11 * dy + r.r12 * dz;
      sz[i] += r.r20 * dx + r.r21 * dy + r.r22 * dz;
    }
  };
  if (groups.first == nullptr) {
    add(0, count);
  } else {
    for (std::size_t k = 0; k < groups.count; ++k) add(groups.first[k], std::min(count, groups.first[k] + lanes));
  }
}

// Tangential velocity of the roots: v + w x arm without its part along n, or the mean of the step.
SLIPBENCH_DISPATCHED void rate(const Columns& c, const Pose& pose, const Twist* motion, double dt, bool memory, bool speeds,
                               std::size_t count) {
  const Eigen::Matrix3d& r = pose.rotation;
  const Lanes none{};
  for (std::size_t i = 0; i < count; i += lanes) {
    if (speeds) {
      LaneVectors v{none, none, none};
      if (motion != nullptr) {
        const Eigen::Vector3d &linear = motion->linear, &w = motion->angular;
        const LaneVectors tip = at(c.tip, i);
        const Lanes ax = turned(r, 0, tip.x, tip.y, tip.z), ay = turned(r, 1, tip.x, tip.y, tip.z),
                    az = turned(r, 2, tip.x, tip.y, tip.z);
        v = {linear.x() + (w.y() * az - w.z() * ay), linear.y() + (w.z() * ax - w.x() * az),
             linear.z() + (w.x() * ay - w.y() * ax)};
      } else if (dt > 0.0) {
        const LaneVectors way = at(c.contact, i) - at(c.before.contact, i);
        v = {way.x / dt, way.y / dt, way.z / dt};
      }
      const LaneVectors n = at(c.normal, i);
      const Lanes away = n.x * v.x + (n.y * v.y + n.z * v.z);
      put(c.velocity, i, v - away * n);
    }
    const Lanes history = memory ? at(c.history.normal, i) : none;
    const Lanes inward = -at(c.gap, i), raw = raw_normal_force(at(c.gap, i), at(c.k_normal, i), history);
    put(c.depth, i, inward > 0.0 ? inward : none);
    put(c.load, i, raw > 0.0 ? raw : none);
  }
}

// Force f_n n - f, energy f_n^2/2k_n + |f|^2/2k_t and loss f . s of each spring.
SLIPBENCH_DISPATCHED SpringSums sum_springs(const Columns& c, const Groups& groups) {
  const Lanes none{};
  LaneVectors force{};
  Lanes elastic{}, loss{};
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    const Lanes raw = at(c.f_normal, i), pressed = raw > 0.0 ? raw : none;
    const LaneVectors t = at(c.force, i);
    force = force + (pressed * at(c.normal, i) - t);
    const Lanes stored = pressed * pressed / at(c.spring.k_normal, i) + dot(t, t) / at(c.spring.k_tangential, i);
    elastic += at(c.mode, i) != 0.0 ? stored : none;
    loss += dot(t, at(c.slip, i));
  }
  return {total(force), 0.5 * total(elastic), total(loss)};
}

// Adds tau k times the velocity to each spring and scales tangential forces back into the cone.
SLIPBENCH_DISPATCHED Wrench damped_wrench_on_pad(const Columns& c, const Eigen::Vector3d& origin, const Twist& motion, double tau,
                                                 const ConeEffect* cone, const Groups& groups) {
  const Eigen::Vector3d &v = motion.linear, &w = motion.angular;
  const Lanes none{};
  LaneVectors force{}, torque{};
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t i = groups[k];
    const LaneVectors normal = at(c.normal, i), place = at(c.contact, i);
    const LaneVectors arm{place.x - origin.x(), place.y - origin.y(), place.z - origin.z()};
    const LaneVectors velocity{v.x() + w.y() * arm.z - w.z() * arm.y, v.y() + w.z() * arm.x - w.x() * arm.z,
                               v.z() + w.x() * arm.y - w.y() * arm.x};
    const Lanes approach = -dot(normal, velocity), state = at(c.mode, i), reach = at(c.limit, i);
    const Lanes viscous = state == 1.0 ? tau * at(c.spring.k_tangential, i) : none;
    const LaneVectors t = at(c.force, i) + viscous * (velocity + approach * normal);
    Lanes held = none + 1.0;
    if (cone != nullptr) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        if (!(viscous[lane] > 0.0 && reach[lane] > 0.0)) continue;
        const double along[3] = {t.x[lane], t.y[lane], t.z[lane]}, n[3] = {normal.x[lane], normal.y[lane], normal.z[lane]};
        const double gauge = cone->gauge(along, n, reach[lane]);
        if (gauge > 1.0) held[lane] = 1.0 / gauge;
      }
    } else {
      const Lanes size = root(dot(t, t));
      held = ((viscous > 0.0) & (size > reach)) ? reach / size : held;
    }
    const Lanes raw = at(c.f_normal, i);
    const Lanes stopped = (raw > 0.0 ? raw : none) + tau * at(c.spring.k_normal, i) * approach;
    const Lanes pressed = ((state != 0.0) & (stopped > 0.0)) ? stopped : none;
    const LaneVectors f = pressed * normal - held * t;
    force = force + f;
    torque = torque + cross(arm, f);
  }
  return {total(force), total(torque)};
}

void find_trials(const Columns& columns, bool plane, std::size_t count) {
  plane ? find_trials_on_plane(columns, count) : find_trials_on_curve(columns, count);
}

void return_map(const Columns& columns, bool plane, bool extended, const Groups& groups) {
  if (plane) {
    extended ? return_map_on_plane_extended(columns, groups) : return_map_on_plane(columns, groups);
  } else {
    extended ? return_map_on_curve_extended(columns, groups) : return_map_on_curve(columns, groups);
  }
}

}  // namespace slipbench::kernel
