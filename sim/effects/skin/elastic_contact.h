// The contact of an elastic body with a rigid one, at the elements of a pad: where it presses,
// sticks and slips.
//
// Normal: forces p >= 0 with gap + C p >= 0 and p (gap + C p) = 0, where C is the compliance
// (below). The contact area is solved for, not assumed: conjugate gradients on the pressing
// elements. Elements that would pull leave the set, and elements that would be penetrated join it
// [polonsky1999].
//
// Tangential, in steps: let g be the shift of the tips if all stuck, u = C q their actual shift,
// and L each element's friction limit. The forces q minimise q'C q/2 - q'g under |q| <= L. Then
// s = g - u is the slip of the step: 0 where |q| < L, along q where |q| = L ([kalker1990], ch. 4).
// Projected gradients with Nesterov's momentum, which restarts when it leads uphill
// [odonoghue2015].
//
// Both first guesses extrapolate the last step's increment as far as that lowers the energy: under
// a steady drive they are right to second order.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/effects/skin/influence.h"

namespace slipbench {

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
