// Displacement of the surface of an elastic body under load, at the elements of a pad.
#pragma once

#include <memory>

#include "sim/api/pad_layout.h"

namespace slipbench {

// Displacement of the surface of an incompressible elastic body under load.
//
// Half-space with shear modulus G and Poisson's ratio 1/2, so that normal and tangential problems
// do not couple. A point load at distance r moves the surface by ([johnson1985], sec. 3.2 and 3.6)
//   u_z = p/(4 pi G r)                                     (Boussinesq)
//   u_x = [(1/r + x^2/r^3) q_x + (x y/r^3) q_y]/(4 pi G)   (Cerruti), u_y alike.
// Layer of thickness t on a rigid back, incompressible: in Fourier space, with the wave number k
// and s = k t, a load moves the surface by
//   normal              N(s)/(2 G k),  N = (sinh 2s - 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential along k  A(s)/(2 G k),  A = (sinh 2s + 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential across   B(s)/(G k),    B = tanh s
// ([johnson1985], sec. 5.8; [menga2019]). All three tend to 1 as s grows: the half-space. The
// coupling of normal and tangential load, of order s^2 exp(-2 s), is neglected: it is small where
// the layer is thick compared with the contact.
struct ElasticBody {
  double shear_modulus;  // G [Pa]
  double thickness;      // t [m]; infinite: a half-space
};

// N, A and B of a layer at s = k t > 0.
struct LayerCompliance {
  double normal, along, across;
};
[[nodiscard]] LayerCompliance layer_compliance(double s);

// The compliance of n elements, each of which spreads its force evenly over its cell.
class Influence {
 public:
  virtual ~Influence() = default;
  // Computes the displacements [n] m of the surface at the elements under forces [n] N: press()
  // along the normal, shear() tangential, along x and y.
  virtual void press(const double* force, double* way) = 0;
  virtual void shear(const double* force_x, const double* force_y, double* way_x, double* way_y) = 0;
  // Displacement of an element under a unit force on itself, m/N.
  [[nodiscard]] double own_normal() const { return own_normal_; }
  [[nodiscard]] double own_tangential() const { return own_tangential_; }

 protected:
  double own_normal_ = 0.0, own_tangential_ = 0.0;
};

// Makes the compliance of a pad's elements. Elements that fill a grid, possibly at different
// heights, all along -Z of the pad: by FFT on a grid twice as large, exact up to rounding. FFTW
// plans without vector code, so that processors differ in the last digits only. All others: a dense
// matrix over the tips' positions, for a half-space only, where each element stands for a square
// with the edge `patch` [m]; 0: the mean distance to the nearest neighbour. Throws SceneValueError
// if neither fits, or if a patch is given for a grid.
std::unique_ptr<Influence> make_influence(const PadLayout& layout, const ElasticBody& body, double patch);

}  // namespace slipbench
