// The contact of an elastic body with a rigid one, at the elements of a pad: where it presses, where it sticks, where it slips.
//
// Normal: forces p >= 0 with  gap + C p >= 0  and  p (gap + C p) = 0,  C the compliance (influence.h). Contact is found, not assumed: conjugate
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

#include "sim/effects/skin/influence.h"

namespace slipbench {

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
