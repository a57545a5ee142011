// The elements of a field as a structure of arrays.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include <Eigen/Core>

namespace slipbench::kernel {

// A vector of each element, by component.
struct VectorColumns {
  double *x, *y, *z;

  [[nodiscard]] std::array<double*, 3> components() const { return {x, y, z}; }
  [[nodiscard]] Eigen::Vector3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Eigen::Vector3d& v) const {
    x[i] = v.x();
    y[i] = v.y();
    z[i] = v.z();
  }
};

// Results of a step, from which the next one starts.
struct StepColumns {
  VectorColumns contact;  // contact point [m]
  double* gap;            // [m], negative: penetration
  double* f_normal;       // raw [N], negative while separated
  double* limit;          // mu_s f_n [N]
  VectorColumns force;    // tangential, of the pad on the surface [N]
  double* mode;           // 0 detached, 1 stick, 2 slip; double, so that loops vectorise
};

// The columns of every field.
struct PlainColumns : StepColumns {
  StepColumns before;               // at the end of the last step
  VectorColumns tip, axis;          // pad frame P [m], [1]
  double *k_normal, *k_tangential;  // [N/m]
  double* compliance;               // 1/k_tangential [m/N]
  double *mu_static, *mu_kinetic;
  VectorColumns normal;          // of the surface
  VectorColumns anchor;          // [m]
  VectorColumns slip;            // of the last step if it goes on [m]
  double* path;                  // slipped since the start [m]
  double *faces, *faces_before;  // SurfacePoint::faces; 0: plane
  double* depth_offset;          // s of field.h [m]
  struct {
    VectorColumns force;       // of the surface on the pad [N]
    VectorColumns deflection;  // deformed - undeformed tip [m]
    VectorColumns slip;        // [m]
  } pad;                       // in P
};

// The columns of a field, one entry per element, 32-byte aligned, with a length that is a multiple
// of `lanes`. In the surface frame S unless stated otherwise.
struct Columns : PlainColumns {
  // Without effects and dashpots only `spring` exists, and is k_normal and k_tangential.
  struct {
    double *k_normal, *k_tangential;  // [N/m]
  } spring;                           // before effects
  struct {
    double *mu_static, *mu_kinetic;
  } surface;  // before effects
  // Rheology: f = k u + h [N]. Without a rheology tangential.x is null.
  struct {
    double* normal;
    VectorColumns tangential;
  } history;
  // Read by effects
  VectorColumns velocity;     // [m/s]
  double *depth, *load;       // [m], [N]
  VectorColumns stretch;      // [m]
  VectorColumns place;        // position at which the tip reads effects (SurfaceEffect) [m]
  VectorColumns transmitted;  // force of spring and dashpot on a tip with mass [N]
  double* trial;              // size of the trial force [N]
  double* slide;              // mu_k f_n [N]

  // Exchanges the values of the step with those before it.
  void swap_before() { std::swap(static_cast<StepColumns&>(*this), before); }
};

inline constexpr std::size_t plain_columns = sizeof(PlainColumns) / sizeof(double*);
inline constexpr std::size_t all_columns = sizeof(Columns) / sizeof(double*);

}  // namespace slipbench::kernel
