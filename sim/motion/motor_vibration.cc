#include "sim/motion/motor_vibration.h"

#include <cmath>
#include <numbers>

namespace slipbench {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

// The powers of e^(i angle) that are the spindle's orders, by repeated squaring: one sine and cosine for all of them.
std::array<std::complex<double>, 7> powers(double angle) {
  const std::complex<double> p1(std::cos(angle), std::sin(angle));
  const std::complex<double> p2 = p1 * p1, p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8, p24 = p16 * p8, p25 = p24 * p1,
                             p50 = p25 * p25, p100 = p50 * p50;
  return {p1, p2, p8, p24, p50, p100, p100 * p100};
}

// Below this share of the amplitude what is left of a ringing mode is nothing: far less than a float's rounding of any signal.
constexpr double silent = 1e-12;

}  // namespace

MotorVibration::MotorVibration(const MotorSettings& settings, RandomStream stream) : settings_(settings), stream_(stream) {
  amplitude_ = settings.level * unit_rms * std::exp(settings.sd * stream_.normal());
  for (auto& axis : line_phase_) {
    for (std::complex<double>& phase : axis) phase = std::polar(1.0, turn * stream_.uniform());
  }
  noise_ = stream_.normal();
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

// The force of the motors on the frame [N].
double MotorVibration::drive(const BodyState& stage, double dt) {
  // Of a line's amplitude a: mean square a^2/2, and together half of the whole.
  static const double line_share = 1.0 / std::sqrt(static_cast<double>(orders.size()));
  static const double noise_share = std::sqrt(0.5);
  double lines = 0.0, speed = 0.0, corner = 0.0;  // m/s; Hz, of the noise: the last order's, weighted by what each axis adds
  for (int k = 0; k < 3; ++k) {
    const double v = std::abs(stage.velocity[k]);
    if (v == 0.0) continue;
    const double turns = stage.pose.position[k] / settings_.lead[k];
    const auto orders_now = powers(turn * (turns - std::floor(turns)));
    double sum = 0.0;
    for (std::size_t o = 0; o < orders_now.size(); ++o) {
      const std::complex<double> phase = line_phase_[static_cast<std::size_t>(k)][o];
      sum += phase.real() * orders_now[o].real() - phase.imag() * orders_now[o].imag();
    }
    lines += std::sqrt(v / reference_speed) * sum;
    speed += v;
    corner += v * (orders.back() * v / settings_.lead[k]);
  }
  if (speed == 0.0) return 0.0;
  corner /= speed;
  if (corner * dt != noise_corner_) {
    noise_corner_ = corner * dt;
    noise_keeps_ = std::exp(-turn * noise_corner_);
  }
  noise_ = noise_keeps_ * noise_ + std::sqrt(1.0 - noise_keeps_ * noise_keeps_) * stream_.normal();
  return amplitude_ * (line_share * lines + noise_share * std::sqrt(speed / reference_speed) * noise_);
}

// q'' + 2 zeta w q' + w^2 q = u with u linear over the step: from one state to the next, the homogeneous solution and the straight line
// q = (u - 2 zeta u'/w)/w^2.
void MotorVibration::set_step(double dt) {
  step_ = dt;
  for (Mode& mode : modes_) {
    const double w = mode.omega, decay = mode.zeta * w, damped = std::sqrt(w * w - decay * decay);
    const double even = std::exp(-decay * dt) * std::cos(damped * dt),
                 odd = std::exp(-decay * dt) * std::sin(damped * dt) / damped;
    mode.from_q = {even + decay * odd, -w * w * odd};
    mode.from_v = {odd, even - decay * odd};
    const double slope = 1.0 / (w * w * dt), lag = 2.0 * mode.zeta / (w * w * w * dt), rest = 1.0 / (w * w);
    // The line for a unit drive at the start (falling to 0), and at the end (rising from 0): its states at both ends.
    const std::array<double, 2> start_0{rest + lag, -slope}, start_1{lag, -slope}, end_0{-lag, slope}, end_1{rest - lag, slope};
    for (std::size_t i = 0; i < 2; ++i) {
      mode.from_start[i] = start_1[i] - mode.from_q[i] * start_0[0] - mode.from_v[i] * start_0[1];
      mode.from_end[i] = end_1[i] - mode.from_q[i] * end_0[0] - mode.from_v[i] * end_0[1];
    }
  }
}

}  // namespace slipbench
