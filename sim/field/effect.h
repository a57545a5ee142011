// The places where an effect may enter the element field. A field without effects calls none of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace slipbench {

struct PadLayout;

// Read-only columns of a field with `count` elements, in the surface frame S; the entries up to a multiple of kernel::lanes are there, and say nothing.
struct ElementColumns {
  std::size_t count;
  double dt;                   // s, 0 in the first step
  const double *x, *y, *z;     // where the tip meets the surface [m], see SurfaceEffect
  const double *nx, *ny, *nz;  // unit outward normal of the surface
  const double* penetration;   // m, >= 0
  const double* normal_force;  // N
  const double *vx, *vy, *vz;  // velocity of the undeformed tip over the surface, tangential [m/s]
  const double* mode;          // state after the last step: 0 detached, 1 stick, 2 slip
};

class Effect {
 public:
  virtual ~Effect() = default;
  // The longest step [s] that resolves the effect when pad and surface move at up to `speed` [m/s].
  [[nodiscard]] virtual double longest_step(double /*speed*/) const { return std::numeric_limits<double>::infinity(); }
  // All that the effect carries from one step to the next, to be saved and overwritten by whoever keeps the field's state (Field::save_state).
  // Always the same length; all zero is a field that has not been stepped. Empty: the effect has no memory.
  [[nodiscard]] virtual std::span<double> memory() { return {}; }
  // Element `i` goes on at another surface of the pad (Field::hand_over): what is remembered of it moves to `next`, the same effect there, whose
  // frame `turn` turns vectors into. Without a memory of elements there is nothing to do.
  virtual void pass_on(std::size_t /*i*/, Effect& /*next*/, const Eigen::Matrix3d& /*turn*/) {}
};

// Changes where the surface is: texture, waviness.
//
// It is met where the tip is, and so are patches of friction. A tip that sticks stays where it is to the bit, however its root moves: it is
// silent. One that slips trails its root by the stretch that it had after the step before, or stays if the root has come nearer than
// that: exact in a steady slide, else behind by what the stretch changes within one step. What its own ridges do to the stretch of a
// sliding tip settles while mu k_n/k_t times their slope is less than 1; beyond that a tip without mass has no one place. In the step of
// a touch the tip is still under its root, in that of an onset where it stuck.
class SurfaceEffect : public Effect {
 public:
  // Adds to `gap` [m] at the points (x, y) [m] of S; a bump lowers the gap. Only where the normal is +Z (nz = 1): sides are smooth.
  virtual void displace(std::size_t count, const double* x, const double* y, const double* nz, double* gap) = 0;
};

// Changes how much friction there is: load, age, place, speed of the root.
class FrictionEffect : public Effect {
 public:
  // Multiplies mu_s and mu_k of every element that is pressed (normal_force > 0); those of the others are not looked at.
  virtual void scale(const ElementColumns& elements, double* mu_s, double* mu_k) = 0;
  // Whether scale() may look at velocities. Where no effect of a field does they are not worked out.
  [[nodiscard]] virtual bool by_speed() const { return true; }
};

// Strengthens the friction of a tip with the speed w at which it slips itself: mu_k g(w), g(0) = 1, g never falling. An element is then a
// spring and a viscous slider in series. Backward Euler finds w at the end of a step: with the trial force T, the stiffness k and
// L = mu_k f_n
//   T - k dt w = L g(w),
// which has one root w > 0 when T > L and none else, at any step and however steep g is. So slip begins at mu_s f_n, without a jump where
// mu_s = mu_k, and one that has begun goes on until the tip has stopped; a pad that is left alone creeps, and its tips say so. Of a field that
// touches nothing it is not asked: what it remembers is then as after the step that let go.
class RateEffect : public Effect {
 public:
  // Solves that for `count` elements from `first` on, of which the arrays are, dt > 0 [s]: multiplies `factor` by g(w) of `trial` T [N],
  // `stiffness` k > 0 [N/m] and `limit` L >= 0 [N]; by 1 where T <= L or L = 0.
  virtual void strengthen(std::size_t first, std::size_t count, double dt, const double* trial, const double* stiffness,
                          const double* limit, double* factor) = 0;
  // g(w), and g'(w)/g(w) [s/m], at the slip speed w >= 0 [m/s].
  [[nodiscard]] virtual double factor(double speed) const = 0;
  [[nodiscard]] virtual double growth(double speed) const = 0;
};

// Changes how an element's force follows its deflection. The force of a step is affine in the deflection at its end,
// f = k u + h, for the normal direction (deflection: penetration) and for the three components of the tangential one.
struct AffineForce {
  double *k_normal, *h_normal;             // [N/m], [N]
  double *k_tangential, *h_x, *h_y, *h_z;  // [N/m], [N], [N], [N]
};
class RheologyEffect : public Effect {
 public:
  // Adds this effect's share to the coefficients; elements carries no forces yet.
  virtual void prepare(const ElementColumns& elements, const AffineForce& force) = 0;
  // Takes over the deflections at the end of the step: penetration [m] and tangential stretch [m].
  virtual void commit(const ElementColumns& elements, const double* ux, const double* uy, const double* uz) = 0;
};

// Replaces the circular friction cone.
class ConeEffect : public Effect {
 public:
  // What one element's tangential force becomes.
  struct Projected {
    double fx, fy, fz;
    bool slides;
  };
  // Trial force t [N] tangential to the unit normal n; sticks inside the cone of mu = `limit_stick` / f_n, slides on that of
  // `limit_slide` [N].
  [[nodiscard]] virtual Projected project(const double t[3], const double n[3], double limit_stick, double limit_slide) const = 0;
  // 1 on the cone of `limit`, less inside.
  [[nodiscard]] virtual double gauge(const double t[3], const double n[3], double limit) const = 0;
};

// State of one element.
enum class ElementState : std::uint8_t { detached = 0, stick = 1, slip = 2 };

// An element changed its state inside the last step.
struct ElementEvent {
  double fraction;  // of the step, in [0, 1]
  std::uint32_t element;
  ElementState from, to;
};

// Columns of a field on the plane z = 0 of S for tips with mass, an entry an element. All vectors are tangential. "root": the contact
// point of the undeformed element, which carries the tip by spring and dashpot. The entries from `count` to `padded`, a multiple of
// kernel::lanes, never touch.
struct TipColumns {
  std::size_t count, padded;
  double dt;                                  // s, 0 in the first step
  const double *x, *y, *x_before, *y_before;  // root at the end and at the start of the step [m]
  const double *f_normal, *f_normal_before;   // raw normal force [N], negative while apart: linear in the step
  const double *limit, *limit_before;         // mu_s f_n [N]: linear in the step
  const double *mu_kinetic, *mode_before;     // [1]; 0 detached, 1 stick, 2 slip
  double *tip_x, *tip_y;                      // place of the tip [m]: comes from the start of the step, goes to its end
  double *slip_x, *slip_y, *path;  // way of the touching tip over the surface in the step [m]; its length, added up [m]
  double *friction_x, *friction_y, *transmitted_x,
      *transmitted_y;  // of the tip on the surface; of spring and dashpot on the tip [N]
  double* mode;        // at the end of the step
};

// Gives the tips of the elements mass, in place of the return mapping of massless ones. Only on a plane, with the circular cone and
// without a rheology: the effect has the springs, and dashpots of its own.
class TipEffect : public Effect {
 public:
  // Moves the tips through a step and appends the changes of their states, in order of element and of time within one. With dt = 0 what
  // touches sticks unstrained and everything rests.
  virtual void move(const TipColumns& tips, std::vector<ElementEvent>& events) = 0;
  // Natural frequency [rad/s] and damping ratio of element i.
  [[nodiscard]] virtual double natural_frequency(std::size_t i) const = 0;
  [[nodiscard]] virtual double damping_ratio() const = 0;
};

// Adds to the force that the pad feels of the elements, beside what their tips transmit. Needs a TipEffect, after which it is called.
class RingingEffect : public Effect {
 public:
  virtual void ring(const TipColumns& tips) = 0;
};

// Every element is a slender column: leaning by its stretch q it is q^2/2L lower, and its load pushes it over. With the springs' potential of an
// upright column V = k_n (d - q^2/2L)^2/2 + k_t q^2/2 + k_s max(0, q - q_b)^2/2,
//   f_n = k_n (d - q^2/2L),   f_t = k_t q - f_n q/L + k_s max(0, q - q_b):
// beyond the buckling load k_t L it leans by itself, as far as the stop at q_b. Where its tip sticks, q is given, and a negative stiffness is
// as good as any other. The step is exact in that; no tangent is taken. Beyond f_n = (k_t + k_s) L the stop does not hold either.
struct Lean {
  double length;           // L, m
  double stop_deflection;  // q_b, m
  double stop_stiffness;   // k_s, N/m

  // How much lower the tip of a column is that leans by q [m].
  [[nodiscard]] double drop(double q) const { return q * q / (2.0 * length); }
};

// Makes the pad one elastic body: what an element bears moves the surface at all others, in place of springs of their own. Arrays have an entry
// an element, in the element's own frame (element_frame). Pressure is that of the touched surface on the pad, shear that of the pad on the surface.
class SkinEffect : public Effect {
 public:
  // Finds the normal forces at the gaps [m] of the undeformed surface, seen along the axes and negative where it would pass through.
  virtual void press(const double* gap) = 0;
  // Finds the tangential forces under `limit` [N], 0 where nothing touches. `target_x`, `target_y`: the shift against the pad [m] that the
  // surface would have if all of it stuck. Only after press().
  virtual void shear(const double* target_x, const double* target_y, const double* limit) = 0;

  // What the last calls have found: forces [N], how far the surface has given along the axis and across [m], loaded or not, and which elements
  // bear all that friction holds (1, else 0).
  struct Solution {
    const double *pressure, *sunk;
    const double *shear_x, *shear_y, *shift_x, *shift_y, *slides;
  };
  [[nodiscard]] virtual Solution solution() = 0;
  // How far an element moves itself, m/N.
  [[nodiscard]] virtual double own_normal() const = 0;
  [[nodiscard]] virtual double own_tangential() const = 0;
  // What each element adds to the stiffness of the whole pad, pressed and moved by a rigid face that sticks to it [N/m]. No part of the pad is
  // stiffer than the whole.
  [[nodiscard]] virtual std::span<const double> punch_normal() const = 0;
  [[nodiscard]] virtual std::span<const double> punch_tangential() const = 0;
};

// Dashpots in parallel with the springs, as elements may have them. Kelvin-Voigt element: f = k u + c du/dt with the rate taken over the step
// (backward Euler, first order, never unstable). Normal: u is the penetration; tangential: the stretch, and the whole force f obeys the
// friction cone. Null when no element has a dashpot.
std::unique_ptr<RheologyEffect> make_dashpots(const PadLayout& layout);

// The effects of one field, in the order in which the scene names them.
struct FieldEffects {
  std::vector<std::unique_ptr<SurfaceEffect>> surface;
  std::vector<std::unique_ptr<FrictionEffect>> friction;
  std::unique_ptr<RateEffect> rate;  // at most one
  std::vector<std::unique_ptr<RheologyEffect>> rheology;
  std::unique_ptr<ConeEffect> cone;                     // at most one
  std::optional<Lean> lean;                             // not together with a cone
  std::unique_ptr<TipEffect> tip;                       // at most one, without rate, rheology, cone and lean
  std::unique_ptr<SkinEffect> skin;                     // at most one, without all these
  std::vector<std::unique_ptr<RingingEffect>> ringing;  // only with a tip

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
