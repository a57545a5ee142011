// The contact of an elastic body with a rigid one, at the elements of a pad: where it presses,
// sticks and slips.
//
// Normal: forces p >= 0 with gap + C p >= 0 and p (gap + C p) = 0, where C is the compliance
// (below). The contact area is solved for, not assumed: conjugate gradients on the pressing
// elements. Elements that would pull leave the set, and elements that would be penetrated join it
// (Polonsky and Keer, Wear 231, 1999).
//
// Tangential, in steps: let g be the shift of the tips if all stuck, u = C q their actual shift,
// and L each element's friction limit. The forces q minimise q'C q/2 - q'g under |q| <= L. Then
// s = g - u is the slip of the step: 0 where |q| < L, along q where |q| = L (Kalker,
// Three-Dimensional Elastic Bodies in Rolling Contact, 1990, ch. 4). Projected gradients with
// Nesterov's momentum, which restarts when it leads uphill (O'Donoghue and Candes, Found. Comput.
// Math. 15, 2015).
//
// Both first guesses extrapolate the last step's increment as far as that lowers the energy: under
// a steady drive they are right to second order.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"

namespace slipbench {

// Displacement of the surface of an incompressible elastic body under load.
//
// Half-space with shear modulus G and Poisson's ratio 1/2, so that normal and tangential problems
// do not couple. A point load at distance r moves the surface by (Johnson, Contact Mechanics, 1985,
// sec. 3.2 and 3.6)
//   u_z = p/(4 pi G r)                                     (Boussinesq)
//   u_x = [(1/r + x^2/r^3) q_x + (x y/r^3) q_y]/(4 pi G)   (Cerruti), u_y alike.
// Layer of thickness t on a rigid back, incompressible: in Fourier space, with the wave number k
// and s = k t, a load moves the surface by
//   normal              N(s)/(2 G k),  N = (sinh 2s - 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential along k  A(s)/(2 G k),  A = (sinh 2s + 2s)/(cosh 2s + 1 + 2 s^2)
//   tangential across   B(s)/(G k),    B = tanh s
// (Johnson, sec. 5.8; Menga, Int. J. Solids Struct. 164, 2019). All three tend to 1 as s grows: the
// half-space. The coupling of normal and tangential load, of order s^2 exp(-2 s), is neglected: it
// is small where the layer is thick compared with the contact.
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

class ElasticContact {
 public:
  using Values = Eigen::Map<Eigen::ArrayXd>;  // [n]
  using Pairs = Eigen::Map<Eigen::ArrayX2d>;  // [n, 2], x and y

  // `tolerance`: residual of the solvers, as a share of the greatest depth (overlap) and of the
  // greatest friction force (friction).
  ElasticContact(std::unique_ptr<Influence> influence, std::size_t elements, double tolerance);

  // Solves for pressure() at the gaps [m] of the undeformed surface, negative where it would be
  // penetrated. Starts from the last step's pressure and returns at once if nothing has changed.
  // Throws InputError if it does not converge.
  void press(const Eigen::Ref<const Eigen::ArrayXd>& gap);
  // Solves for friction() under `limit` [N], 0 without touch, at the shifts `target` g [m]. Throws
  // InputError if it does not converge.
  void shear(const Eigen::ArrayX2d& target, const Eigen::Ref<const Eigen::ArrayXd>& limit);

  [[nodiscard]] Values pressure() { return column(0); }  // N
  [[nodiscard]] Values sunk() { return column(1); }      // m, C p
  [[nodiscard]] Pairs friction() { return pair(2); }     // N
  [[nodiscard]] Pairs shift() { return pair(4); }        // m, C q
  // 1 where |q| = L, else 0.
  [[nodiscard]] const Eigen::ArrayXd& slides() const { return slides_; }
  // The state carried from step to step. All zero: nothing has been pressed.
  [[nodiscard]] std::span<double> memory() { return memory_; }
  [[nodiscard]] const Influence& influence() const { return *influence_; }

 private:
  [[nodiscard]] Values column(std::size_t k) { return {memory_.data() + k * n_, static_cast<Eigen::Index>(n_)}; }
  [[nodiscard]] Pairs pair(std::size_t k) { return {memory_.data() + k * n_, static_cast<Eigen::Index>(n_), 2}; }
  [[nodiscard]] Pairs gain() { return pair(6); }      // N, of friction() in the last step
  [[nodiscard]] Pairs gain_way() { return pair(8); }  // m, of shift()
  [[nodiscard]] Values pressure_gain() { return column(10); }
  [[nodiscard]] Values sunk_gain() { return column(11); }
  // Number of elements in contact when the largest curvature of q'C q over them was found, and that
  // curvature [m/N].
  [[nodiscard]] double& counted() { return memory_[12 * n_]; }
  [[nodiscard]] double& curvature() { return memory_[12 * n_ + 1]; }
  void guess_pressure(const Eigen::Ref<const Eigen::ArrayXd>& gap);
  void project(Eigen::ArrayX2d& force, const Eigen::Ref<const Eigen::ArrayXd>& limit);
  void guess(const Eigen::ArrayX2d& target, const Eigen::Ref<const Eigen::ArrayXd>& limit);
  void find_curvature(const Eigen::Ref<const Eigen::ArrayXd>& limit);
  void apply(const Eigen::ArrayX2d& force, Eigen::ArrayX2d& way);
  void take_pressure(const Eigen::Ref<const Eigen::ArrayXd>& next);

  std::unique_ptr<Influence> influence_;
  std::size_t n_;
  double tolerance_;
  std::vector<double> memory_;
  Eigen::ArrayXd residual_, direction_, moved_;  // of press()
  // of shear(): forces and their shifts
  Eigen::ArrayX2d guess_, at_guess_, next_, at_next_;
  Eigen::ArrayX2d change_;  // of both: forces that go through the compliance
  Eigen::ArrayXd slides_;
};

}  // namespace slipbench
