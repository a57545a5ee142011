#include "sim/motion/motor_vibration.h"

#include <cmath>
#include <numbers>

#include "sim/core/math.h"
#include "sim/core/random.h"

namespace slipbench {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

// Returns the powers of e^(i angle) for the spindle's orders, by repeated squaring: one sine and
// cosine for all of them.
std::array<std::complex<double>, 7> powers(double angle) {
  const auto [sine, cosine] = math::sincos(angle);
  const std::complex<double> p1(cosine, sine);
  const std::complex<double> p2 = p1 * p1, p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8, p24 = p16 * p8, p25 = p24 * p1,
                             p50 = p25 * p25, p100 = p50 * p50;
  return {p1, p2, p8, p24, p50, p100, p100 * p100};
}

constexpr std::size_t idle_axis = 3;

// Below this share of the amplitude a ringing mode counts as silent: far less than a float's
// rounding of any signal.
constexpr double silent = 1e-12;

}  // namespace

MotorVibration::MotorVibration(const MotorSettings& settings, RandomStream stream) : settings_(settings), stream_(stream) {
  amplitude_ = settings.level * unit_rms * math::exp(settings.sd * stream_.normal());
  const auto draw_phases = [this](std::size_t axis) {
    for (std::complex<double>& phase : line_phase_[axis]) {
      const auto [sine, cosine] = math::sincos(turn * stream_.uniform());
      phase = {cosine, sine};
    }
  };
  for (std::size_t axis = 0; axis < idle_axis; ++axis) draw_phases(axis);
  noise_ = stream_.normal();
  if (settings.idle_speed > 0.0) draw_phases(idle_axis);
  for (std::size_t r = 0; r < modes_.size(); ++r) {
    modes_[r].omega = turn * mode_frequencies[r];
    modes_[r].zeta = mode_damping[r];
  }
}

double MotorVibration::force(const BodyState& stage, bool touching, double dt) {
  const double now = drive(stage, dt);
  if (now == 0.0 && !rings_) return 0.0;
  if (dt != step_) set_step(dt);
  double sum = 0.0, motion = 0.0;
  for (Mode& mode : modes_) {
    const double q =
        mode.from_q[0] * mode.q + mode.from_v[0] * mode.v + mode.from_start[0] * last_drive_ + mode.from_end[0] * now;
    mode.v = mode.from_q[1] * mode.q + mode.from_v[1] * mode.v + mode.from_start[1] * last_drive_ + mode.from_end[1] * now;
    mode.q = q;
    const double held = mode.omega * mode.omega * mode.q + 2.0 * mode.zeta * mode.omega * mode.v;
    sum += now - held;
    motion += std::abs(mode.omega * mode.omega * mode.q) + std::abs(mode.omega * mode.v);
  }
  last_drive_ = now;
  rings_ = now != 0.0 || motion > silent * amplitude_;
  if (!rings_) {
    for (Mode& mode : modes_) mode.q = mode.v = 0.0;
  }
  return (touching ? settings_.in_contact : 1.0) * sum;
}

// Inlined: the compiler would not, and each moving axis calls it at every tick.
[[gnu::always_inline]] inline void MotorVibration::add_noise(Drive& drive, std::size_t axis, double speed) const {
  const double lead = settings_.lead[axis == idle_axis ? 0 : static_cast<Eigen::Index>(axis)];
  drive.speed += speed;
  drive.corner += speed * (orders.back() * speed / lead);
}

void MotorVibration::add_axis(Drive& drive, std::size_t axis, double speed, double turns) const {
  const auto orders_now = powers(turn * (turns - std::floor(turns)));
  double sum = 0.0;
  for (std::size_t o = 0; o < orders_now.size(); ++o) {
    const std::complex<double> phase = line_phase_[axis][o];
    sum += phase.real() * orders_now[o].real() - phase.imag() * orders_now[o].imag();
  }
  drive.lines += std::sqrt(speed / reference_speed) * sum;
  add_noise(drive, axis, speed);
}

// Returns the force of the motors on the frame [N].
double MotorVibration::drive(const BodyState& stage, double dt) {
  // A line of amplitude a has the mean square a^2/2; all lines together make half of the total.
  static const double line_share = 1.0 / std::sqrt(static_cast<double>(orders.size()));
  static const double noise_share = std::sqrt(0.5);
  Drive now;
  for (std::size_t axis = 0; axis < idle_axis; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    const double speed = std::abs(stage.velocity[k]);
    if (speed != 0.0) add_axis(now, axis, speed, stage.pose.position[k] / settings_.lead[k]);
  }
  if (settings_.idle_speed > 0.0) {
    if (time_ >= settings_.idle_start) {
      add_axis(now, idle_axis, settings_.idle_speed, settings_.idle_speed * time_ / settings_.lead[0]);
    }
    time_ += dt;
  }
  if (settings_.rest_speed > 0.0) add_noise(now, idle_axis, settings_.rest_speed);
  if (now.speed == 0.0) return 0.0;
  const double corner = now.corner / now.speed;
  if (corner * dt != noise_corner_) {
    noise_corner_ = corner * dt;
    noise_keeps_ = math::exp(-turn * noise_corner_);
  }
  noise_ = noise_keeps_ * noise_ + std::sqrt(1.0 - noise_keeps_ * noise_keeps_) * stream_.normal();
  return amplitude_ * (line_share * now.lines + noise_share * std::sqrt(now.speed / reference_speed) * noise_);
}

// q'' + 2 zeta w q' + w^2 q = u with u linear over the step. Advances the state by the homogeneous
// solution and the straight line q = (u - 2 zeta u'/w)/w^2.
void MotorVibration::set_step(double dt) {
  step_ = dt;
  for (Mode& mode : modes_) {
    const double w = mode.omega, decay = mode.zeta * w, damped = std::sqrt(w * w - decay * decay);
    const double even = math::exp(-decay * dt) * math::cos(damped * dt),
                 odd = math::exp(-decay * dt) * math::sin(damped * dt) / damped;
    mode.from_q = {even + decay * odd, -w * w * odd};
    mode.from_v = {odd, even - decay * odd};
    const double slope = 1.0 / (w * w * dt), lag = 2.0 * mode.zeta / (w * w * w * dt), rest = 1.0 / (w * w);
    // The line for a unit drive at the start (falling to 0), and at the end (rising from 0): its
    // states at both ends.
    const std::array<double, 2> start_0{rest + lag, -slope}, start_1{lag, -slope}, end_0{-lag, slope}, end_1{rest - lag, slope};
    for (std::size_t i = 0; i < 2; ++i) {
      mode.from_start[i] = start_1[i] - mode.from_q[i] * start_0[0] - mode.from_v[i] * start_0[1];
      mode.from_end[i] = end_1[i] - mode.from_q[i] * end_0[0] - mode.from_v[i] * end_0[1];
    }
  }
}

}  // namespace slipbench
