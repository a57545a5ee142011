// The contact of an elastic body with a rigid one, at the elements of a pad: where it presses, where it sticks, where it slips.
//
// Normal: forces p >= 0 with  gap + C p >= 0  and  p (gap + C p) = 0,  C the compliance (below). Contact is found, not assumed: conjugate
// gradients on the elements that press, of which those fall out that would pull, and which those join that would be passed through (Polonsky and
// Keer, Wear 231, 1999).
// Tangential, in steps: with g the shift that the tips would have if all stuck to where they were, u = C q the shift that they have, and the
// limit L of each element's friction, the forces q minimise  q'C q/2 - q'g  under |q| <= L. Then s = g - u is the slip of the step: 0 where
// |q| < L, along q where |q| = L (Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, ch. 4). Projected gradients with Nesterov's
// momentum, which starts anew where it leads uphill (O'Donoghue and Candes, Found. Comput. Math. 15, 2015).
// Both first guesses go on the way of the last step, as far as that lowers the energy: under a steady drive they are right to second order.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"

namespace slipbench {

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
// without vector code, so that processors differ in the last digits only. All others: a dense matrix over the places of the tips, for a half-space
// alone, where each stands for a square of the edge `patch` [m]; 0: of the mean distance to the nearest. Throws SceneValueError where neither fits,
// or where a patch is given that a grid has.
std::unique_ptr<Influence> make_influence(const PadLayout& layout, const ElasticBody& body, double patch);

class ElasticContact {
 public:
  using Values = Eigen::Map<Eigen::ArrayXd>;  // [n]
  using Pairs = Eigen::Map<Eigen::ArrayX2d>;  // [n, 2], x and y

  // `tolerance`: what the solvers leave undone, overlap as a share of the greatest depth, friction as one of the greatest friction.
  ElasticContact(std::unique_ptr<Influence> influence, std::size_t elements, double tolerance);

  // Finds pressure() at the gaps [m] of the undeformed surface, negative where it would pass through. Starts from that of the step before: where
  // nothing has changed nothing is worked out. Throws InputError where no solution is found.
  void press(const Eigen::Ref<const Eigen::ArrayXd>& gap);
  // Finds friction() under `limit` [N], 0 where nothing touches, at the shifts `target` g [m].
  void shear(const Eigen::ArrayX2d& target, const Eigen::Ref<const Eigen::ArrayXd>& limit);

  [[nodiscard]] Values pressure() { return column(0); }  // N
  [[nodiscard]] Values sunk() { return column(1); }      // m, C p
  [[nodiscard]] Pairs friction() { return pair(2); }     // N
  [[nodiscard]] Pairs shift() { return pair(4); }        // m, C q
  // 1 where |q| = L, else 0.
  [[nodiscard]] const Eigen::ArrayXd& slides() const { return slides_; }
  // All that goes from step to step. All zero: nothing has been pressed.
  [[nodiscard]] std::span<double> memory() { return memory_; }
  [[nodiscard]] const Influence& influence() const { return *influence_; }

 private:
  [[nodiscard]] Values column(std::size_t k) { return {memory_.data() + k * n_, static_cast<Eigen::Index>(n_)}; }
  [[nodiscard]] Pairs pair(std::size_t k) { return {memory_.data() + k * n_, static_cast<Eigen::Index>(n_), 2}; }
  [[nodiscard]] Pairs gain() { return pair(6); }      // N, of friction() in the last step
  [[nodiscard]] Pairs gain_way() { return pair(8); }  // m, of shift()
  [[nodiscard]] Values pressure_gain() { return column(10); }
  [[nodiscard]] Values sunk_gain() { return column(11); }
  // How many elements touched when the largest curvature of q'C q over them was found, and that [m/N].
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
  Eigen::ArrayXd residual_, direction_, moved_;        // of press()
  Eigen::ArrayX2d guess_, at_guess_, next_, at_next_;  // of shear(): forces and the shifts by them
  Eigen::ArrayX2d change_;                             // of both: forces that go through the compliance
  Eigen::ArrayXd slides_;
};

}  // namespace slipbench
