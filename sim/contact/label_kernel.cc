// Vectorised passes: from elements to labels.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "sim/contact/label_kernel.h"
#include "sim/contact/vectorise.h"

namespace slipbench::kernel {
namespace {

template <bool kLevel>
SLIPBENCH_INLINE void label_all(const UnitColumns& c, const Eigen::Matrix3d& turn, double rate, std::size_t first,
                                std::size_t end, ContactFrame& frame) {
  double* const force = frame.force.data();
  double* const contact_force = frame.contact_force.data();
  double* const displacement = frame.displacement.data();
  double* const slip_velocity = frame.slip_velocity.data();
  double* const slip_distance = frame.slip_distance.data();
  double* const margin = frame.margin.data();
  const auto [r00, r01, r02, r10, r11, r12, r20, r21, r22] = entries_of(turn);
  SLIPBENCH_VECTORISE
  for (std::size_t u = first; u < end; ++u) {
    const double share = c.share[u], pace = share * rate;
    const double fx = c.force[0][u], fy = c.force[1][u], fz = c.force[2][u];
    const double sx = c.slip[0][u], sy = c.slip[1][u], sz = c.slip[2][u];
    force[3 * u] = fx;
    force[3 * u + 1] = fy;
    force[3 * u + 2] = fz;
    // In the order in which Eigen adds up a product, for bit-identical results.
    contact_force[3 * u] = kLevel ? fx : r00 * fx + r01 * fy + r02 * fz;
    contact_force[3 * u + 1] = kLevel ? fy : r10 * fx + r11 * fy + r12 * fz;
    contact_force[3 * u + 2] = kLevel ? fz : r20 * fx + (r21 * fy + r22 * fz);
    displacement[3 * u] = share * c.deflection[0][u];
    displacement[3 * u + 1] = share * c.deflection[1][u];
    displacement[3 * u + 2] = share * c.deflection[2][u];
    slip_velocity[2 * u] = pace * (kLevel ? sx : r00 * sx + r01 * sy + r02 * sz);
    slip_velocity[2 * u + 1] = pace * (kLevel ? sy : r10 * sx + r11 * sy + r12 * sz);
    slip_distance[u] = share * c.path[u];
    const double tx = c.tangential[0][u], ty = c.tangential[1][u], tz = c.tangential[2][u], limit = c.limit[u];
    const double gauge = std::sqrt(tx * tx + ty * ty + tz * tz) / limit;
    const double left = limit == 0.0 ? 0.0 : 1.0 - gauge;
    margin[u] = c.touching[u] == 0.0 ? std::numeric_limits<double>::quiet_NaN() : left;
  }
}

SLIPBENCH_DISPATCHED void label_level(const UnitColumns& units, const Eigen::Matrix3d& turn, double rate, std::size_t first,
                                      std::size_t end, ContactFrame& frame) {
  label_all<true>(units, turn, rate, first, end, frame);
}
SLIPBENCH_DISPATCHED void label_turned(const UnitColumns& units, const Eigen::Matrix3d& turn, double rate, std::size_t first,
                                       std::size_t end, ContactFrame& frame) {
  label_all<false>(units, turn, rate, first, end, frame);
}

// Transposes four columns of `lanes` entries into rows of four entries.
SLIPBENCH_INLINE void turn_round(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace

// Adds an element's entries of four columns at once: lanes are columns, so that each column is
// summed in the order of the elements.
SLIPBENCH_DISPATCHED UnitSum sum_unit(const UnitSum::Summed& columns, std::size_t first, std::size_t count) {
  constexpr std::size_t quads = UnitSum::vector_columns / lanes;
  const auto& from = columns.vectors;
  const Lanes none{};
  Lanes total[quads], modes = none, squares = none;
  for (std::size_t q = 0; q < quads; ++q) {
    for (std::size_t k = 0; k < lanes; ++k) total[q][k] = from[lanes * q + k][first];
  }
  const auto of_own = [&columns](std::size_t i) {
    return Lanes{columns.path[i], columns.limit[i], std::max(0.0, columns.f_normal[i]), 0.0};
  };
  Lanes own = none + of_own(first);
  double mode = columns.mode[first], square = mode * mode;
  std::size_t i = first + 1;
  const std::size_t end = first + count;
  for (; i + lanes <= end; i += lanes) {
    for (std::size_t q = 0; q < quads; ++q) {
      Lanes a = lanes_at(from[lanes * q] + i), b = lanes_at(from[lanes * q + 1] + i), c = lanes_at(from[lanes * q + 2] + i),
            d = lanes_at(from[lanes * q + 3] + i);
      turn_round(a, b, c, d);
      total[q] += a;
      total[q] += b;
      total[q] += c;
      total[q] += d;
    }
    const Lanes raw = lanes_at(columns.f_normal + i);
    Lanes a = lanes_at(columns.path + i), b = lanes_at(columns.limit + i), c = raw > 0.0 ? raw : none, d = none;
    turn_round(a, b, c, d);
    own += a;
    own += b;
    own += c;
    own += d;
    const Lanes now = lanes_at(columns.mode + i);
    modes += now;
    squares += now * now;
  }
  for (; i < end; ++i) {
    for (std::size_t q = 0; q < quads; ++q) {
      Lanes entries;
      for (std::size_t k = 0; k < lanes; ++k) entries[k] = from[lanes * q + k][i];
      total[q] += entries;
    }
    own += of_own(i);
    mode += columns.mode[i];
    square += columns.mode[i] * columns.mode[i];
  }
  UnitSum sum;
  for (std::size_t q = 0; q < quads; ++q) put_lanes(sum.vectors.data() + lanes * q, total[q]);
  sum.path = own[0];
  sum.limit = own[1];
  sum.normal_force = own[2];
  // Modes are the whole numbers 0, 1 and 2, so the order of the sum does not matter.
  for (std::size_t k = 0; k < lanes; ++k) {
    mode += modes[k];
    square += squares[k];
  }
  sum.slipping = 0.5 * (square - mode);
  sum.touching = mode - sum.slipping;
  return sum;
}

namespace {

// The rotation of unit_rules::ContactPlane, with entries computed in the same order as there: entry
// 10 equals 01.
template <class Real>
struct Turn {
  Real r00, r01, r02, r11, r12, r20, r21, r22;

  SLIPBENCH_INLINE Turn(const Real& nx, const Real& ny, const Real& nz) {
    const Real none{}, one = none + 1.0, mz = nz + 1.0;
    r00 = one - nx * nx / mz;
    r01 = none - nx * ny / mz;
    r02 = none - nx * mz / mz;
    r11 = one - ny * ny / mz;
    r12 = none - ny * mz / mz;
    r20 = r02 + 2.0 * nx;
    r21 = r12 + 2.0 * ny;
    r22 = one - mz * mz / mz + 2.0 * nz;
    const auto opposite = (nx == 0.0) & (ny == 0.0) & (nz == -1.0);
    if (!any(opposite)) return;
    r00 = opposite ? one : r00;
    r11 = opposite ? -one : r11;
    r22 = opposite ? -one : r22;
    for (Real* entry : {&r01, &r02, &r12, &r20, &r21}) *entry = opposite ? none : *entry;
  }
};

// Addresses of the labels of the units from `first` on.
struct Labels {
  double *force, *contact_force, *displacement, *slip_velocity, *slip_distance, *margin;
};
SLIPBENCH_INLINE Labels labels_at(ContactFrame& frame, std::size_t u) {
  return {frame.force.data() + 3 * u,         frame.contact_force.data() + 3 * u, frame.displacement.data() + 3 * u,
          frame.slip_velocity.data() + 2 * u, frame.slip_distance.data() + u,     frame.margin.data() + u};
}

template <class Real>
SLIPBENCH_INLINE Real margin_of(const Real& tangential_squared, const Real& limit, const Real& touching) {
  const Real none{}, gauge = root(tangential_squared) / limit, left = limit == 0.0 ? none : 1.0 - gauge;
  return touching == 0.0 ? none + std::numeric_limits<double>::quiet_NaN() : left;
}

template <class Real>
SLIPBENCH_INLINE void label_at(const UnitColumns& c, const Rotation& to, double rate, std::size_t u, ContactFrame& frame) {
  const Labels labels = labels_at(frame, u);
  const auto at = [u](const auto& vector, std::size_t k) SLIPBENCH_INLINE_BODY { return vector_at<Real>(vector[k] + u); };
  const Real sx = at(c.normal, 0), sy = at(c.normal, 1), sz = at(c.normal, 2);
  const Turn<Real> r(to.r00 * sx + to.r01 * sy + to.r02 * sz, to.r10 * sx + to.r11 * sy + to.r12 * sz,
                     to.r20 * sx + to.r21 * sy + to.r22 * sz);
  const Real fx = at(c.force, 0), fy = at(c.force, 1), fz = at(c.force, 2);
  put_vectors(labels.force, fx, fy, fz);
  put_vectors(labels.contact_force, r.r00 * fx + r.r01 * fy + r.r02 * fz, r.r01 * fx + r.r11 * fy + r.r12 * fz,
              r.r20 * fx + (r.r21 * fy + r.r22 * fz));
  put_vectors(labels.displacement, at(c.deflection, 0), at(c.deflection, 1), at(c.deflection, 2));
  const Real vx = at(c.slip, 0), vy = at(c.slip, 1), vz = at(c.slip, 2);
  put_vectors(labels.slip_velocity, rate * (r.r00 * vx + r.r01 * vy + r.r02 * vz), rate * (r.r01 * vx + r.r11 * vy + r.r12 * vz));
  put_vector(labels.slip_distance, vector_at<Real>(c.path + u));
  const Real tx = at(c.tangential, 0), ty = at(c.tangential, 1), tz = at(c.tangential, 2);
  put_vector(labels.margin,
             margin_of<Real>(tx * tx + ty * ty + tz * tz, vector_at<Real>(c.limit + u), vector_at<Real>(c.touching + u)));
}

}  // namespace

SLIPBENCH_DISPATCHED void label_groups(const UnitColumns& c, const Eigen::Matrix3d& to_pad, double rate, const Groups& groups,
                                       std::size_t count, ContactFrame& frame) {
  const Rotation to = entries_of(to_pad);
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t first = groups[k];
    if (first + lanes <= count) {
      label_at<Lanes>(c, to, rate, first, frame);
    } else {  // the last group is incomplete: columns are padded, the frame is not
      for (std::size_t u = first; u < count; ++u) label_at<double>(c, to, rate, u, frame);
    }
  }
}

SLIPBENCH_DISPATCHED void label_felt(const UnitColumns& c, std::size_t first, std::size_t end, bool displacement,
                                     ContactFrame& frame) {
  for (std::size_t u = first; u + lanes <= end; u += lanes) {
    const auto at = [u](const double* column) SLIPBENCH_INLINE_BODY { return lanes_at(column + u); };
    const Labels labels = labels_at(frame, u);
    put_vectors(labels.force, at(c.force[0]), at(c.force[1]), at(c.force[2]));
    if (!displacement) continue;
    const Lanes share = at(c.share);
    put_vectors(labels.displacement, share * at(c.deflection[0]), share * at(c.deflection[1]), share * at(c.deflection[2]));
  }
  for (std::size_t u = end - (end - first) % lanes; u < end; ++u) {
    for (std::size_t k = 0; k < 3; ++k) {
      frame.force.data()[3 * u + k] = c.force[k][u];
      if (displacement) frame.displacement.data()[3 * u + k] = c.share[u] * c.deflection[k][u];
    }
  }
}

namespace {

SLIPBENCH_INLINE void put_states(UnitState* to, const Lanes& modes) {
  const auto states = __builtin_convertvector(__builtin_convertvector(modes, Ints), Bytes);
  std::memcpy(to, &states, sizeof states);
}
SLIPBENCH_INLINE void put_states(UnitState* to, double mode) { *to = static_cast<UnitState>(static_cast<int>(mode)); }

// Bit-identical to view_from_pad() and label_units() for level elements, but without products with
// zeros and ones, and without intermediate columns.
template <class Real>
SLIPBENCH_INLINE void label_level_at(const Columns& c, const Rotation& r, const VectorColumns& transmitted, double rate,
                                     std::size_t i, FramePart part, ContactFrame& frame) {
  const Real none{};
  const Labels labels = labels_at(frame, i);
  const auto along_x = [&](const Real& x, const Real& y) SLIPBENCH_INLINE_BODY { return r.r00 * x + r.r01 * y + none; };
  const auto along_y = [&](const Real& x, const Real& y) SLIPBENCH_INLINE_BODY { return r.r10 * x + r.r11 * y + none; };
  const auto at = [i](const double* column) SLIPBENCH_INLINE_BODY { return vector_at<Real>(column + i); };
  const Real f_n = positive<Real>(at(c.f_normal)), depth = positive<Real>(-at(c.gap));
  const Real fx = none - at(transmitted.x), fy = none - at(transmitted.y);
  const Real force_x_of_pad = along_x(fx, fy), force_y_of_pad = along_y(fx, fy);
  put_vectors(labels.force, force_x_of_pad, force_y_of_pad, f_n);
  const Real dx = none - (at(c.contact.x) - at(c.anchor.x)), dy = none - (at(c.contact.y) - at(c.anchor.y));
  put_vectors(labels.displacement, along_x(dx, dy), along_y(dx, dy), depth);
  if (part != FramePart::all) return;
  put_vectors(labels.contact_force, force_x_of_pad, force_y_of_pad, f_n);
  const Real moving = at(c.mode), sx = at(c.slip.x), sy = at(c.slip.y);
  put_vectors(labels.slip_velocity, rate * along_x(sx, sy), rate * along_y(sx, sy));
  put_vector(labels.slip_distance, at(c.path));
  put_vector(labels.margin, margin_of<Real>(at(c.force.x) * at(c.force.x) + at(c.force.y) * at(c.force.y), at(c.limit), moving));
  put_states(frame.unit_state.data() + i, moving);
}

}  // namespace

// The last entries one by one: overlapping lanes would wait for the values written before.
SLIPBENCH_DISPATCHED void label_level_elements(const Columns& c, const Eigen::Matrix3d& rotation,
                                               const VectorColumns& transmitted, double rate, std::size_t count, FramePart part,
                                               ContactFrame& frame) {
  const Rotation r = entries_back(rotation);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) label_level_at<Lanes>(c, r, transmitted, rate, i, part, frame);
  for (; i < count; ++i) label_level_at<double>(c, r, transmitted, rate, i, part, frame);
}

void label_units(const UnitColumns& units, const Eigen::Matrix3d* turn, double rate, const ConeEffect* cone, std::size_t first,
                 std::size_t end, ContactFrame& frame) {
  turn == nullptr ? label_level(units, Eigen::Matrix3d::Identity(), rate, first, end, frame)
                  : label_turned(units, *turn, rate, first, end, frame);
  if (cone == nullptr) return;
  for (std::size_t u = first; u < end; ++u) {
    if (units.touching[u] == 0.0 || units.limit[u] == 0.0) continue;
    const double t[3] = {units.tangential[0][u], units.tangential[1][u], units.tangential[2][u]};
    const double n[3] = {units.normal[0][u], units.normal[1][u], units.normal[2][u]};
    frame.margin[static_cast<Eigen::Index>(u)] = 1.0 - cone->gauge(t, n, units.limit[u]);
  }
}

}  // namespace slipbench::kernel
