// How the surface of an incompressible elastic body gives way where it is loaded.
//
// Half-space with shear modulus G, Poisson's ratio 1/2, so that normal and tangential problems do not couple. A point load at distance r moves
// the surface by (Johnson, Contact Mechanics, 1985, sec. 3.2 and 3.6)
//   u_z = p/(4 pi G r)                                     (Boussinesq)
//   u_x = [(1/r + x^2/r^3) q_x + (x y/r^3) q_y]/(4 pi G)   (Cerruti), u_y alike.
// Layer of thickness t on a rigid back, incompressible: in Fourier space, with the wave number k and s = k t, a load moves the surface by
//   normal              N(s)/(2 G k),  N = (sinh 2s - 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential along k  A(s)/(2 G k),  A = (sinh 2s + 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential across   B(s)/(G k),    B = tanh s
// (Johnson, sec. 5.8; Menga, Int. J. Solids Struct. 164, 2019). All three go to 1 as s grows: the half-space. What else couples normal and
// tangential load, of order s^2 exp(-2 s), is left out: it is small where the layer is thick against the contact.
#pragma once

#include <memory>

#include "sim/core/pad_layout.h"

namespace slipbench {

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
  // How far forces [n] N move the surface at the elements, [n] m, along the normal; `x`, `y`: the same of tangential forces.
  virtual void press(const double* force, double* way) = 0;
  virtual void shear(const double* force_x, const double* force_y, double* way_x, double* way_y) = 0;
  // How far an element moves itself, m/N.
  [[nodiscard]] double own_normal() const { return own_normal_; }
  [[nodiscard]] double own_tangential() const { return own_tangential_; }

 protected:
  double own_normal_ = 0.0, own_tangential_ = 0.0;
};

// Elements on a full grid of one height or several, all along -Z of the pad: by FFT on a grid twice as large, exact up to rounding. FFTW plans
// without vector code, so that all processors give the same bytes. All others: a dense matrix over the places of the tips, for a half-space
// alone, where each stands for a square of the edge `patch` [m]; 0: of the mean distance to the nearest. Throws SceneValueError where neither fits,
// or where a patch is given that a grid has.
std::unique_ptr<Influence> make_influence(const PadLayout& layout, const ElasticBody& body, double patch);

}  // namespace slipbench
