// Vectors of column entries, and helpers that the kernel's files share.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "sim/contact/kernel.h"
#include "sim/core/vectorise.h"

namespace slipbench::kernel {

// Entries of a column processed at once: for loops that compilers do not vectorise, and for sums
// whose order must not depend on the compiler.
using Lanes = Quad;
using Mask = decltype(Lanes{} == Lanes{});
static_assert(lanes == quad);
using Ints __attribute__((vector_size(lanes * sizeof(int)))) = int;
using Bytes __attribute__((vector_size(lanes))) = unsigned char;
using slipbench::any;
SLIPBENCH_INLINE bool any(bool one) { return one; }

SLIPBENCH_INLINE Lanes lanes_at(const double* from) { return vector_at<Lanes>(from); }
SLIPBENCH_INLINE void put_lanes(double* to, const Lanes& values) { put_vector(to, values); }

// Vectors of several elements, by component.
struct LaneVectors {
  Lanes x, y, z;
};
SLIPBENCH_INLINE LaneVectors operator+(const LaneVectors& a, const LaneVectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
SLIPBENCH_INLINE LaneVectors operator-(const LaneVectors& a, const LaneVectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
SLIPBENCH_INLINE LaneVectors operator*(const Lanes& s, const LaneVectors& a) { return {s * a.x, s * a.y, s * a.z}; }
SLIPBENCH_INLINE Lanes dot(const LaneVectors& a, const LaneVectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SLIPBENCH_INLINE LaneVectors cross(const LaneVectors& a, const LaneVectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SLIPBENCH_INLINE LaneVectors select(const Mask& mask, const LaneVectors& a, const LaneVectors& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}

// Entries of columns from element i on.
SLIPBENCH_INLINE Lanes at(const double* column, std::size_t i) { return lanes_at(column + i); }
SLIPBENCH_INLINE LaneVectors at(const VectorColumns& columns, std::size_t i) {
  return {at(columns.x, i), at(columns.y, i), at(columns.z, i)};
}
SLIPBENCH_INLINE void put(double* column, std::size_t i, const Lanes& values) { put_lanes(column + i, values); }
SLIPBENCH_INLINE void put(const VectorColumns& columns, std::size_t i, const LaneVectors& values) {
  put(columns.x, i, values.x);
  put(columns.y, i, values.y);
  put(columns.z, i, values.z);
}

// Stores vectors given by three components, one vector after the other.
SLIPBENCH_INLINE void put_vectors(double* to, const Lanes& x, const Lanes& y, const Lanes& z) {
  const Lanes even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(y, z, 1, 5, 3, 7);
  const Lanes across = __builtin_shufflevector(z, x, 0, 5, 2, 7);
  put_lanes(to, __builtin_shufflevector(even, across, 0, 1, 4, 5));
  put_lanes(to + lanes, __builtin_shufflevector(odd, even, 0, 1, 6, 7));
  put_lanes(to + 2 * lanes, __builtin_shufflevector(across, odd, 2, 3, 6, 7));
}
// The same for two components.
SLIPBENCH_INLINE void put_vectors(double* to, const Lanes& x, const Lanes& y) {
  put_lanes(to, __builtin_shufflevector(x, y, 0, 4, 1, 5));
  put_lanes(to + lanes, __builtin_shufflevector(x, y, 2, 6, 3, 7));
}

// The same for one element.
SLIPBENCH_INLINE void put_vectors(double* to, double x, double y, double z) { to[0] = x, to[1] = y, to[2] = z; }
SLIPBENCH_INLINE void put_vectors(double* to, double x, double y) { to[0] = x, to[1] = y; }

// max(0, x), exact, and never -0.
template <class Real>
SLIPBENCH_INLINE Real positive(const Real& x) {
  const Real none{};
  return (x < none ? none : x) + none;
}

SLIPBENCH_INLINE Lanes root(const Lanes& values) {
  Lanes roots;
  for (std::size_t lane = 0; lane < lanes; ++lane) roots[lane] = std::sqrt(values[lane]);
  return roots;
}
SLIPBENCH_INLINE double root(double value) { return std::sqrt(value); }

// The entries of a rotation, so that loops keep them in registers.
struct Rotation {
  double r00, r01, r02, r10, r11, r12, r20, r21, r22;
};

SLIPBENCH_INLINE Rotation entries_of(const Eigen::Matrix3d& r) {
  return {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)};
}

// The entries of its transpose.
SLIPBENCH_INLINE Rotation entries_back(const Eigen::Matrix3d& r) {
  return {r(0, 0), r(1, 0), r(2, 0), r(0, 1), r(1, 1), r(2, 1), r(0, 2), r(1, 2), r(2, 2)};
}

SLIPBENCH_INLINE LaneVectors turned(const Rotation& r, const LaneVectors& v) {
  return {r.r00 * v.x + r.r01 * v.y + r.r02 * v.z, r.r10 * v.x + r.r11 * v.y + r.r12 * v.z,
          r.r20 * v.x + r.r21 * v.y + r.r22 * v.z};
}

}  // namespace slipbench::kernel
