#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/core/error.h"
#include "sim/effects/effects.h"
#include "sim/effects/stick_slip.h"
#include "sim/field/kernel.h"
#include "sim/field/vectorise.h"

namespace slipbench {
namespace {

// As far as a tip swings [rad] while the direction of its friction is kept: a quarter of what stick_slip.h needs for a single turn.
constexpr double longest_swing = std::numbers::pi / 8.0;

constexpr double slipping = 2.0, sticking = 1.0, undecided = -1.0;

// A step in which nothing changes its state, of all tips at once.
struct Swing {
  const double *k, *compliance, *dashpot, *omega2, *damping;  // N/m, m/N, N s/m, rad^2/s^2, 1/s: 2 zeta omega
  const double *xx, *xv, *vx, *vv;                            // Propagator over the step
  double *speed_x, *speed_y;                                  // m/s, of the tip
};

// Moves the tips whose state lasts through the step, marks the others as undecided, leaves them where they were and returns how many.
SLIPBENCH_DISPATCHED double swing(const Swing& s, const TipColumns& t) {
  const double rate = 1.0 / t.dt;
  double left = 0.0;
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < t.padded; ++i) {
    const bool sticks = t.mode_before[i] == sticking, slips = t.mode_before[i] == slipping;
    const bool touched = sticks | slips;
    const double f_n = 0.5 * (t.press[i] + std::abs(t.press[i]));
    const double f_n_before = 0.5 * (t.press_before[i] + std::abs(t.press_before[i]));
    const double vx = (t.x[i] - t.x_before[i]) * rate, vy = (t.y[i] - t.y_before[i]) * rate;
    const double ux = t.x_before[i] - t.tip_x[i], uy = t.y_before[i] - t.tip_y[i];

    // stuck: the force that it takes, at both ends
    const double stretch_x = t.x[i] - t.tip_x[i], stretch_y = t.y[i] - t.tip_y[i];
    const double held_x = s.k[i] * stretch_x + s.dashpot[i] * vx, held_y = s.k[i] * stretch_y + s.dashpot[i] * vy;
    const double begun_x = s.k[i] * ux + s.dashpot[i] * vx, begun_y = s.k[i] * uy + s.dashpot[i] * vy;
    const double beyond = s.k[i] * kernel::shortest_slip;
    const double reach = t.limit[i] + beyond, reach_before = t.limit_before[i] + beyond;
    const bool lets_go = (held_x * held_x + held_y * held_y > reach * reach) |
                         (begun_x * begun_x + begun_y * begun_y > reach_before * reach_before);

    // slipping, or free: the oscillator
    const double speed_x = s.speed_x[i], speed_y = s.speed_y[i];
    const double speed = std::sqrt(speed_x * speed_x + speed_y * speed_y);
    const double along_x = slips ? speed_x / speed : 0.0, along_y = slips ? speed_y / speed : 0.0;
    const double friction = slips ? t.mu_kinetic[i] * (0.5 * (f_n_before + f_n)) : 0.0;
    const double rest_x = friction * s.compliance[i] * along_x, rest_y = friction * s.compliance[i] * along_y;
    const double x0 = ux - rest_x, y0 = uy - rest_y, a0 = vx - speed_x, b0 = vy - speed_y;
    const double x1 = s.xx[i] * x0 + s.xv[i] * a0, y1 = s.xx[i] * y0 + s.xv[i] * b0;
    const double a1 = s.vx[i] * x0 + s.vv[i] * a0, b1 = s.vx[i] * y0 + s.vv[i] * b0;
    const double end_x = vx - a1, end_y = vy - b1;
    const double end_along = along_x * end_x + along_y * end_y;
    const double slope_before =
        along_x * (s.omega2[i] * x0 + s.damping[i] * a0) + along_y * (s.omega2[i] * y0 + s.damping[i] * b0);
    const double slope = along_x * (s.omega2[i] * x1 + s.damping[i] * a1) + along_y * (s.omega2[i] * y1 + s.damping[i] * b1);
    const bool stops = (!(end_along > 0.0)) | ((slope_before < 0.0) & (slope > 0.0));

    const bool changes = ((f_n > 0.0) != touched) | (sticks & lets_go) | (slips & stops);
    const bool stays = changes | sticks;
    const double place_x = stays ? t.tip_x[i] : t.x[i] - (x1 + rest_x), place_y = stays ? t.tip_y[i] : t.y[i] - (y1 + rest_y);
    const double way_x = slips ? place_x - t.tip_x[i] : 0.0, way_y = slips ? place_y - t.tip_y[i] : 0.0;
    const double kept_x = sticks ? 0.0 : end_x, kept_y = sticks ? 0.0 : end_y;
    t.slip_x[i] = way_x;
    t.slip_y[i] = way_y;
    t.path[i] += std::sqrt(way_x * way_x + way_y * way_y);
    t.tip_x[i] = place_x;
    t.tip_y[i] = place_y;
    s.speed_x[i] = changes ? speed_x : kept_x;
    s.speed_y[i] = changes ? speed_y : kept_y;
    const double end_friction = t.mu_kinetic[i] * f_n;
    t.friction_x[i] = sticks ? held_x : end_friction * along_x;
    t.friction_y[i] = sticks ? held_y : end_friction * along_y;
    t.felt_x[i] = s.k[i] * (t.x[i] - place_x) + s.dashpot[i] * (vx - kept_x);
    t.felt_y[i] = s.k[i] * (t.y[i] - place_y) + s.dashpot[i] * (vy - kept_y);
    t.mode[i] = changes ? undecided : t.mode_before[i];
    left += changes ? 1.0 : 0.0;
  }
  return left;
}

class Inertia final : public TipEffect {
 public:
  Inertia(const Parameters& p, const EffectContext& context)
      : damping_ratio_(p.number("damping")),
        count_(context.elements),
        padded_((count_ + kernel::lanes - 1) / kernel::lanes * kernel::lanes) {
    for (auto* column : {&k_, &compliance_, &dashpot_, &omega_, &omega2_, &damping_, &xx_, &xv_, &vx_, &vv_})
      column->resize(padded_);
    speed_.resize(2 * padded_);
    RandomStream stream = context.stream("inertia");
    for (std::size_t i = 0; i < count_; ++i) {
      const double omega = 2.0 * std::numbers::pi * p.number("frequency") * std::exp(p.number("scatter") * stream.normal());
      k_[i] = context.k_tangential[i];
      compliance_[i] = 1.0 / k_[i];
      dashpot_[i] = law(i).dashpot();
      omega_[i] = omega;
      omega2_[i] = omega * omega;
      damping_[i] = 2.0 * damping_ratio_ * omega;
      dashpot_[i] = law(i).dashpot();
    }
    fastest_ = *std::ranges::max_element(omega_);
  }

  void move(const TipColumns& tips, std::vector<ElementEvent>& events) override {
    if (tips.dt == 0.0) {
      place(tips, events);
      return;
    }
    set_step(tips.dt);
    if (fastest_ * tips.dt <= longest_swing) {
      if (swing({k_.data(), compliance_.data(), dashpot_.data(), omega2_.data(), damping_.data(), xx_.data(), xv_.data(),
                 vx_.data(), vv_.data(), speed_.data(), speed_.data() + padded_},
                tips) == 0.0) {
        return;
      }
    } else {
      std::fill_n(tips.mode, padded_, 0.0);
      std::fill_n(tips.mode, count_, undecided);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (tips.mode[i] == undecided) move_one(tips, i, events);
    }
  }

  [[nodiscard]] double natural_frequency(std::size_t i) const override { return omega_[i]; }
  [[nodiscard]] double damping_ratio() const override { return damping_ratio_; }
  [[nodiscard]] std::span<double> memory() override { return speed_; }

 private:
  [[nodiscard]] TipLaw law(std::size_t i) const { return {k_[i], {omega_[i], damping_ratio_}}; }

  void place(const TipColumns& tips, std::vector<ElementEvent>& events) {
    for (std::size_t i = 0; i < padded_; ++i) {
      tips.tip_x[i] = tips.x[i];
      tips.tip_y[i] = tips.y[i];
      for (double* column : {tips.slip_x, tips.slip_y, tips.friction_x, tips.friction_y, tips.felt_x, tips.felt_y})
        column[i] = 0.0;
      tips.mode[i] = tips.press[i] > 0.0 ? sticking : 0.0;
      if (tips.mode[i] == sticking) {
        events.push_back({1.0, static_cast<std::uint32_t>(i), ElementState::detached, ElementState::stick});
      }
    }
  }

  void set_step(double dt) {
    if (dt == step_) return;
    step_ = dt;
    for (std::size_t i = 0; i < count_; ++i) {
      const Propagator moved = propagator(law(i).oscillator, dt);
      xx_[i] = moved.xx;
      xv_[i] = moved.xv;
      vx_[i] = moved.vx;
      vv_[i] = moved.vv;
    }
  }

  // What stick_slip.h does, for element i: a step from the state at its start.
  void move_one(const TipColumns& t, std::size_t i, std::vector<ElementEvent>& events) {
    TipDrive drive{{t.x_before[i], t.y_before[i]},
                   Eigen::Vector2d(t.x[i] - t.x_before[i], t.y[i] - t.y_before[i]) / t.dt,
                   t.dt,
                   {t.press_before[i], t.press[i]},
                   {t.limit_before[i], t.limit[i]},
                   t.mu_kinetic[i],
                   longest_swing / (omega_[i] * t.dt)};
    // While apart it has no limit; the line of the part that it touches goes on below zero.
    if (drive.press[0] <= 0.0 && drive.press[1] > 0.0) drive.limit[0] = drive.limit[1] * drive.press[0] / drive.press[1];
    if (drive.press[1] <= 0.0 && drive.press[0] > 0.0) drive.limit[1] = drive.limit[0] * drive.press[1] / drive.press[0];
    Tip tip{{t.tip_x[i], t.tip_y[i]},
            {speed_[i], speed_[padded_ + i]},
            static_cast<ElementState>(static_cast<int>(t.mode_before[i]))};
    TipTrace trace;
    move_tip(law(i), drive, static_cast<std::uint32_t>(i), tip, trace, events);
    const Eigen::Vector2d root(t.x[i], t.y[i]);
    const Eigen::Vector2d felt = k_[i] * (root - tip.place) + dashpot_[i] * (drive.speed - tip.speed);
    t.tip_x[i] = tip.place.x();
    t.tip_y[i] = tip.place.y();
    t.slip_x[i] = trace.slip.x();
    t.slip_y[i] = trace.slip.y();
    t.path[i] += trace.path;
    t.friction_x[i] = trace.friction.x();
    t.friction_y[i] = trace.friction.y();
    t.felt_x[i] = felt.x();
    t.felt_y[i] = felt.y();
    t.mode[i] = static_cast<double>(tip.state);
    speed_[i] = tip.speed.x();
    speed_[padded_ + i] = tip.speed.y();
  }

  double damping_ratio_;
  std::size_t count_, padded_;
  std::vector<double> k_, compliance_, dashpot_, omega_, omega2_, damping_;
  double fastest_ = 0.0;  // rad/s
  double step_ = 0.0;     // s, for which these hold:
  std::vector<double> xx_, xv_, vx_, vv_;
  std::vector<double> speed_;  // [2][padded] m/s, of the tips over the surface
};

}  // namespace

EffectKind inertia() {
  return {
      {"inertia",
       "The tips have mass: elements ring, and stick and slip by themselves.",
       "m a'' = k u + c u' - F in the plane; a: place of the tip on the surface, u = r - a: stretch, r: root, k: the sensor's "
       "tangential stiffness,\n"
       "m = k/(2 pi f)^2, c = 2 damping sqrt(k m), f = frequency exp(scatter g), g normal, one an element\n"
       "stick: a stands, F = k u + c r' up to mu_s f_n; slip: F = mu_k f_n along a', until a' is zero; moved exactly at any "
       "step\n"
       "felt: k u + c u', also of the free tip; it is in no contact force that the friction would limit. Mass counts in the "
       "surface's frame, and along the surface only",
       "K. L. Johnson, Contact Mechanics (1985), ch. 7; stick-slip of a driven mass: J. P. Den Hartog, Mechanical Vibrations "
       "(1956), ch. 7",
       {{"frequency",
         ParameterType::number,
         Quantity::frequency,
         "180 Hz",
         {1.0, 1e5, false},
         {},
         1,
         "natural frequency of an element, undamped, its median",
         "assumed: a stroked PVDF finger rings at 148 to 180 Hz"},
        {"scatter",
         ParameterType::number,
         Quantity::none,
         "0.1",
         {0.0, 1.0, false},
         {},
         1,
         "standard deviation of ln f over the elements",
         "assumed: elements of one skin differ, or they would ring as one"},
        {"damping",
         ParameterType::number,
         Quantity::none,
         "0.1",
         {0.0, 10.0, false},
         {},
         1,
         "damping ratio; below 1 an element rings",
         "assumed: a stroked PVDF finger has 0.06"}}},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!context.plane) throw SceneValueError("effects", "inertia needs a plane; allowed shapes: plane");
        if (context.dashpots) {
          throw SceneValueError("effects",
                                "inertia gives the elements dashpots (damping), and the sensor's have some of their "
                                "own; allowed: a sensor without");
        }
        effects.tip = std::make_unique<Inertia>(p, context);
      }};
}

}  // namespace slipbench
