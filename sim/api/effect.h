// The interfaces by which an effect changes the element field. A field without effects calls none
// of them.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/element_columns.h"
#include "sim/api/element_event.h"

namespace slipbench {

class Effect {
 public:
  virtual ~Effect() = default;
  // Returns the longest step [s] that resolves the effect when pad and surface move at up to
  // `speed` [m/s].
  [[nodiscard]] virtual double longest_step(double /*speed*/) const { return std::numeric_limits<double>::infinity(); }
  // The state that the effect carries from one step to the next, saved and restored with the
  // field's (Field::save_state). Its length is constant; all zero is a field that has not been
  // stepped. Empty: the effect has no state.
  [[nodiscard]] virtual std::span<double> memory() { return {}; }
  // Element `i` moves to another surface of the pad (Field::hand_over): moves its state to `next`,
  // the same effect there; `turn` rotates vectors into that surface's frame. Effects without a
  // state per element need not override this.
  virtual void pass_on(std::size_t /*i*/, Effect& /*next*/, const Eigen::Matrix3d& /*turn*/) {}
};

// Changes the surface's height: texture, waviness.
//
// The height is read at the tip's position; patches of friction are, too. A tip that sticks keeps
// its position bit-exactly however its root moves, so it causes no noise. A slipping tip trails its
// root by the stretch after the last step, or keeps its position if the root has come nearer than
// that: exact in a steady slide, otherwise late by the change of the stretch within one step. The
// feedback of the ridges on the stretch of a sliding tip settles while mu k_n/k_t times their slope
// is less than 1; beyond that a tip without mass has no unique position. In the step of a touch the
// tip is still under its root; in that of an onset, where it stuck.
class SurfaceEffect : public Effect {
 public:
  // Adds to `gap` [m] at the points (x, y) [m] of S; a bump lowers the gap. Only where the normal
  // is +Z (nz = 1): sides are smooth.
  virtual void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) = 0;
};

// Changes the amount of friction by load, age, position, speed of the root.
class FrictionEffect : public Effect {
 public:
  // Multiplies mu_s and mu_k of every pressed element (normal_force > 0); those of the others are
  // ignored.
  virtual void scale(const ElementColumns& elements, double* mu_s, double* mu_k) = 0;
  // True if scale() may read velocities. They are computed only if an effect of the field reads
  // them.
  [[nodiscard]] virtual bool by_speed() const { return true; }
};

// Strengthens the friction of a tip with its own slip speed w: mu_k g(w), with g(0) = 1 and g never
// falling. An element is then a spring and a viscous slider in series. Backward Euler finds w at
// the end of a step: with the trial force T, the stiffness k and L = mu_k f_n
//   T - k dt w = L g(w),
// which has exactly one root w > 0 if T > L and none otherwise, at any step and for any slope of g.
// So slip begins at mu_s f_n, without a jump if mu_s = mu_k, and goes on until the tip has
// stopped; a pad that is left alone creeps, and its tips count as slipping. It is not called for a
// field without contact: its state then stays as after the step of separation.
class RateEffect : public Effect {
 public:
  // Solves that equation for `count` elements from `first` on, the first entries of the arrays, dt
  // > 0 [s]. Multiplies `factor` by g(w) for `trial` T [N], `stiffness` k > 0 [N/m] and `limit` L
  // >= 0 [N]; by 1 if T <= L or L = 0.
  virtual void strengthen(std::size_t first, std::size_t count, double dt, const double* trial, const double* stiffness,
                          const double* limit, double* factor) = 0;
  // Return g(w), and g'(w)/g(w) [s/m], at the slip speed w >= 0 [m/s].
  [[nodiscard]] virtual double factor(double speed) const = 0;
  [[nodiscard]] virtual double growth(double speed) const = 0;
};

// Changes how an element's force follows its deflection (AffineForce).
class RheologyEffect : public Effect {
 public:
  // Adds this effect's share to the coefficients; `elements` has no forces yet.
  virtual void prepare(const ElementColumns& elements, const AffineForce& force) = 0;
  // Stores the deflections at the end of the step: penetration [m] and tangential stretch [m].
  virtual void commit(const ElementColumns& elements, const double* ux, const double* uy, const double* uz) = 0;
};

// Replaces the circular friction cone.
class ConeEffect : public Effect {
 public:
  // An element's tangential force after projection.
  struct Projected {
    double fx, fy, fz;
    bool slides;
  };
  // Projects the trial force t [N], tangential to the unit normal n: it sticks inside the cone of
  // mu = `limit_stick` / f_n, and slides on that of `limit_slide` [N].
  [[nodiscard]] virtual Projected project(const double t[3], const double n[3], double limit_stick, double limit_slide) const = 0;
  // Returns 1 on the cone of `limit`, less inside.
  [[nodiscard]] virtual double gauge(const double t[3], const double n[3], double limit) const = 0;
};

// Gives the tips of the elements mass, instead of the return mapping of massless ones. Only on a
// plane, with the circular cone and without a rheology: the effect has the springs, and its own
// dashpots.
class TipEffect : public Effect {
 public:
  // Moves the tips through a step and appends their changes of state, in order of element and then
  // of time. With dt = 0 touching tips stick unstrained and all tips rest.
  virtual void move(const TipColumns& tips, std::vector<ElementEvent>& events) = 0;
  // Natural frequency [rad/s] and damping ratio of element i.
  [[nodiscard]] virtual double natural_frequency(std::size_t i) const = 0;
  [[nodiscard]] virtual double damping_ratio() const = 0;
};

// Adds to the elements' force on the pad, on top of the force that their tips transmit. Needs a
// TipEffect; called after it.
class RingingEffect : public Effect {
 public:
  virtual void ring(const TipColumns& tips) = 0;
};

// Makes the pad one elastic body: a load on one element moves the surface at all others; elements
// have no springs of their own. Arrays have one entry per element, in the element's own frame
// (element_frame). Pressure is that of the touched surface on the pad, shear that of the pad on the
// surface.
class SkinEffect : public Effect {
 public:
  // Finds the normal forces at the gaps [m] of the undeformed surface, measured along the axes,
  // negative where it would be penetrated.
  virtual void press(const double* gap) = 0;
  // Finds the tangential forces under `limit` [N], 0 without touch. `target_x`, `target_y`: the
  // shift relative to the pad [m] that the surface would have if all of it stuck. Only after
  // press().
  virtual void shear(const double* target_x, const double* target_y, const double* limit) = 0;

  // Result of the last calls: forces [N], displacements of the surface along the axis and across
  // [m], loaded or not, and which elements carry their friction limit (1, else 0).
  struct Solution {
    const double *pressure, *sunk;
    const double *shear_x, *shear_y, *shift_x, *shift_y, *slides;
  };
  [[nodiscard]] virtual Solution solution() = 0;
  // Displacement of an element under a unit force on itself, m/N.
  [[nodiscard]] virtual double own_normal() const = 0;
  [[nodiscard]] virtual double own_tangential() const = 0;
  // Share of each element in the stiffness of the whole pad, pressed and moved by a rigid face that
  // sticks to it [N/m]. No part of the pad is stiffer than the whole.
  [[nodiscard]] virtual std::span<const double> punch_normal() const = 0;
  [[nodiscard]] virtual std::span<const double> punch_tangential() const = 0;
};

// The effects of one field, in the order in which the scene names them.
struct FieldEffects {
  std::vector<std::unique_ptr<SurfaceEffect>> surface;
  std::vector<std::unique_ptr<FrictionEffect>> friction;
  std::unique_ptr<RateEffect> rate;  // at most one
  std::vector<std::unique_ptr<RheologyEffect>> rheology;
  std::unique_ptr<ConeEffect> cone;  // at most one
  std::unique_ptr<TipEffect> tip;    // at most one, without rate, rheology and cone
  std::unique_ptr<SkinEffect> skin;  // at most one, without any of these
  // only with a tip
  std::vector<std::unique_ptr<RingingEffect>> ringing;

  // Calls visit(effect) for each Effect, always in the same order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    const auto visit_all = [&](const auto& effects) {
      for (const auto& effect : effects) visit(*effect);
    };
    visit_all(surface);
    visit_all(friction);
    visit_all(rheology);
    for (Effect* effect : std::initializer_list<Effect*>{rate.get(), cone.get(), tip.get(), skin.get()}) {
      if (effect != nullptr) visit(*effect);
    }
    visit_all(ringing);
  }
};

}  // namespace slipbench
