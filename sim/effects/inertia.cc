#include <algorithm>
#include <numbers>

#include "sim/contact/kernel.h"
#include "sim/contact/vectorise.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/stick_slip.h"

namespace slipbench {
namespace {

// Largest angle [rad] by which a tip swings while the direction of its friction is kept: a quarter
// of what stick_slip.h needs for a single turn.
constexpr double longest_swing = std::numbers::pi / 8.0;

using kernel::Lanes;
using kernel::Mask;

constexpr double slipping = 2.0, sticking = 1.0, undecided = -1.0;

// A step in which no tip changes its state, for all tips at once.
struct Swing {
  // N/m, m/N, N s/m, rad^2/s^2, 1/s: 2 zeta omega
  const double *k, *compliance, *dashpot, *omega2, *damping;
  const double *xx, *xv, *vx, *vv;  // Propagator over the step
  double *speed_x, *speed_y;        // m/s, of the tip
};

// Moves the tips whose state lasts through the step. Marks the others as undecided and leaves them
// unchanged. Returns true if there are any of these.
SLIPBENCH_DISPATCHED bool swing(const Swing& s, const TipColumns& t) {
  const Lanes none{}, rate = none + 1.0 / t.dt;
  Mask any_changes{};
  for (std::size_t i = 0; i < t.padded; i += kernel::lanes) {
    const auto at = [i](const double* column) SLIPBENCH_INLINE_BODY { return kernel::lanes_at(column + i); };
    const auto put = [i](double* column, const Lanes& values) SLIPBENCH_INLINE_BODY { kernel::put_lanes(column + i, values); };
    const Lanes mode = at(t.mode_before);
    const Mask sticks = mode == sticking, slips = mode == slipping;
    const Lanes raw = at(t.f_normal), raw_before = at(t.f_normal_before);
    const Lanes f_n = raw > 0.0 ? raw : none, f_n_before = raw_before > 0.0 ? raw_before : none;
    const Lanes x = at(t.x), y = at(t.y), x_before = at(t.x_before), y_before = at(t.y_before);
    const Lanes tip_x = at(t.tip_x), tip_y = at(t.tip_y), k = at(s.k), dashpot = at(s.dashpot);
    const Lanes vx = (x - x_before) * rate, vy = (y - y_before) * rate;
    const Lanes ux = x_before - tip_x, uy = y_before - tip_y;

    // Stuck: the holding force, at both ends of the step.
    const Lanes drag_x = dashpot * vx, drag_y = dashpot * vy;
    const Lanes held_x = k * (x - tip_x) + drag_x, held_y = k * (y - tip_y) + drag_y;
    const Lanes begun_x = k * ux + drag_x, begun_y = k * uy + drag_y;
    const Lanes beyond = k * kernel::shortest_slip;
    const Lanes reach = at(t.limit) + beyond, reach_before = at(t.limit_before) + beyond;
    const Mask lets_go = (held_x * held_x + held_y * held_y > reach * reach) |
                         (begun_x * begun_x + begun_y * begun_y > reach_before * reach_before);

    // Slipping, or free: the oscillator.
    const Lanes speed_x = at(s.speed_x), speed_y = at(s.speed_y), mu = at(t.mu_kinetic);
    const Lanes inverse = 1.0 / kernel::root(speed_x * speed_x + speed_y * speed_y);
    const Lanes along_x = slips ? speed_x * inverse : none, along_y = slips ? speed_y * inverse : none;
    const Lanes rest = mu * (0.5 * (f_n_before + f_n)) * at(s.compliance), rest_x = rest * along_x, rest_y = rest * along_y;
    const Lanes x0 = ux - rest_x, y0 = uy - rest_y, a0 = vx - speed_x, b0 = vy - speed_y;
    const Lanes xx = at(s.xx), xv = at(s.xv), vx_of = at(s.vx), vv = at(s.vv);
    const Lanes x1 = xx * x0 + xv * a0, y1 = xx * y0 + xv * b0;
    const Lanes a1 = vx_of * x0 + vv * a0, b1 = vx_of * y0 + vv * b0;
    const Lanes end_x = vx - a1, end_y = vy - b1;
    const Lanes omega2 = at(s.omega2), damping = at(s.damping);
    const Lanes slope_before = along_x * (omega2 * x0 + damping * a0) + along_y * (omega2 * y0 + damping * b0);
    const Lanes slope = along_x * (omega2 * x1 + damping * a1) + along_y * (omega2 * y1 + damping * b1);
    const Mask goes_on = along_x * end_x + along_y * end_y > 0.0, dips = (slope_before < 0.0) & (slope > 0.0);

    const Mask changes = ((f_n > 0.0) ^ (sticks | slips)) | (sticks & lets_go) | (slips & (~goes_on | dips));
    const Mask stays = changes | sticks;
    const Lanes place_x = stays ? tip_x : x - (x1 + rest_x), place_y = stays ? tip_y : y - (y1 + rest_y);
    const Lanes way_x = slips ? place_x - tip_x : none, way_y = slips ? place_y - tip_y : none;
    const Lanes kept_x = sticks ? none : end_x, kept_y = sticks ? none : end_y;
    put(t.slip_x, way_x);
    put(t.slip_y, way_y);
    put(t.path, at(t.path) + kernel::root(way_x * way_x + way_y * way_y));
    put(t.tip_x, place_x);
    put(t.tip_y, place_y);
    put(s.speed_x, changes ? speed_x : kept_x);
    put(s.speed_y, changes ? speed_y : kept_y);
    put(t.friction_x, sticks ? held_x : mu * f_n * along_x);
    put(t.friction_y, sticks ? held_y : mu * f_n * along_y);
    put(t.transmitted_x, k * (x - place_x) + dashpot * (vx - kept_x));
    put(t.transmitted_y, k * (y - place_y) + dashpot * (vy - kept_y));
    put(t.mode, changes ? none + undecided : mode);
    any_changes |= changes;
  }
  return kernel::any(any_changes);
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
      const double omega = 2.0 * std::numbers::pi * p.number("frequency") * math::exp(p.number("scatter") * stream.normal());
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
      const Swing coefficients{
          k_.data(),  compliance_.data(), dashpot_.data(), omega2_.data(), damping_.data(),        xx_.data(),
          xv_.data(), vx_.data(),         vv_.data(),      speed_.data(),  speed_.data() + padded_};
      if (!swing(coefficients, tips)) return;
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
      for (double* column : {tips.slip_x, tips.slip_y, tips.friction_x, tips.friction_y, tips.transmitted_x, tips.transmitted_y})
        column[i] = 0.0;
      tips.mode[i] = tips.f_normal[i] > 0.0 ? sticking : 0.0;
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

  // Moves element i by stick_slip.h: one step from the state at its start.
  void move_one(const TipColumns& t, std::size_t i, std::vector<ElementEvent>& events) {
    TipDrive drive{{t.x_before[i], t.y_before[i]},
                   Eigen::Vector2d(t.x[i] - t.x_before[i], t.y[i] - t.y_before[i]) / t.dt,
                   t.dt,
                   {t.f_normal_before[i], t.f_normal[i]},
                   {t.limit_before[i], t.limit[i]},
                   t.mu_kinetic[i],
                   longest_swing / (omega_[i] * t.dt)};
    // A separated element has no limit: extrapolate the limit of the touching part linearly below
    // zero.
    if (drive.f_normal[0] <= 0.0 && drive.f_normal[1] > 0.0)
      drive.limit[0] = drive.limit[1] * drive.f_normal[0] / drive.f_normal[1];
    if (drive.f_normal[1] <= 0.0 && drive.f_normal[0] > 0.0)
      drive.limit[1] = drive.limit[0] * drive.f_normal[1] / drive.f_normal[0];
    Tip tip{{t.tip_x[i], t.tip_y[i]},
            {speed_[i], speed_[padded_ + i]},
            static_cast<ElementState>(static_cast<int>(t.mode_before[i]))};
    TipTrace trace;
    move_tip(law(i), drive, static_cast<std::uint32_t>(i), tip, trace, events);
    const Eigen::Vector2d root(t.x[i], t.y[i]);
    const Eigen::Vector2d transmitted = k_[i] * (root - tip.place) + dashpot_[i] * (drive.speed - tip.speed);
    t.tip_x[i] = tip.place.x();
    t.tip_y[i] = tip.place.y();
    t.slip_x[i] = trace.slip.x();
    t.slip_y[i] = trace.slip.y();
    t.path[i] += trace.path;
    t.friction_x[i] = trace.friction.x();
    t.friction_y[i] = trace.friction.y();
    t.transmitted_x[i] = transmitted.x();
    t.transmitted_y[i] = transmitted.y();
    t.mode[i] = static_cast<double>(tip.state);
    speed_[i] = tip.speed.x();
    speed_[padded_ + i] = tip.speed.y();
  }

  double damping_ratio_;
  std::size_t count_, padded_;
  std::vector<double> k_, compliance_, dashpot_, omega_, omega2_, damping_;
  double fastest_ = 0.0;  // rad/s
  double step_ = 0.0;     // s, step for which these hold:
  std::vector<double> xx_, xv_, vx_, vv_;
  std::vector<double> speed_;  // [2][padded] m/s, of the tips over the surface
};

}  // namespace

EffectKind inertia() {
  return {
      {"inertia",
       "The tips have mass: elements ring, and alternate between stick and slip spontaneously.",
       "m a'' = k u + c u' - F in the plane; a: position of the tip on the surface, u = r - a: stretch, r: root, k: the sensor's tangential stiffness,\n"
       "m = k/(2 pi f)^2, c = 2 damping sqrt(k m), f = frequency exp(scatter g), g normal, drawn for each element\n"
       "stick: a is constant, F = k u + c r' up to mu_s f_n; slip: F = mu_k f_n along a', until a' is zero; integrated exactly at any step\n"
       "felt force: k u + c u', also of a free tip. Friction limits the contact force, not the felt force.\n"
       "The mass acts in the surface's frame, and only along the surface.",
       "K. L. Johnson, Contact Mechanics (1985), ch. 7; stick-slip of a driven mass: J. P. Den Hartog, Mechanical Vibrations (1956), ch. 7",
       {number_spec("frequency", Quantity::frequency, "180 Hz", {1.0, 1e5},
                    "Median of the elements' undamped natural frequencies.",
                    "assumed: a stroked PVDF finger rings at 148 to 180 Hz"),
        number_spec("scatter", Quantity::none, "0.1", {0.0, 1.0}, "Standard deviation of ln f over the elements.",
                    "assumed: elements of one skin differ; with equal frequencies they would ring as one"),
        number_spec("damping", Quantity::none, "0.1", {0.0, 10.0}, "Damping ratio; elements with a ratio below 1 ring.",
                    "assumed: a stroked PVDF finger has 0.06")}},
      {Change::tip_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (!context.plane) throw SceneValueError("effects", "inertia needs a plane (surface.shape: plane)");
        if (context.dashpots) {
          throw SceneValueError(
              "effects",
              "inertia adds dashpots to the elements (damping), but the sensor has dashpots already; use a sensor without damping");
        }
        effects.tip = std::make_unique<Inertia>(p, context);
      }};
}

}  // namespace slipbench
