// Vibration of a bench's motors: it shakes the bench and all that the bench carries.
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include <Eigen/Core>

#include "sim/api/motion.h"
#include "sim/core/pose.h"
#include "sim/core/random.h"

namespace slipbench {

// The motor of an axis that moves at v exerts a force on the frame with a mean square proportional
// to v: half of it in lines at orders 1, 2, 8, 24, 50, 100, 200 of the spindle frequency v/lead,
// equally strong and of random phase, half in red noise with its corner at the last order. The
// angle of the spindle is 2 pi position/lead, so a line follows any change of speed without a jump.
// The force passes through the five modes r of the frame, which transmit accelerations:
//   H(s) = sum_r s^2/(s^2 + 2 zeta_r w_r s + w_r^2),
//   w_r/2 pi = 75, 130, 215, 330, 520 Hz, zeta_r = 0.03 to 0.05,
// integrated exactly between samples for a force that is linear in between. An idle axis is an
// additional axis that moves at a constant speed. Motors that hold their position always add the
// noise of an axis at rest_speed, without lines, because nothing turns. Source: the form follows
// NIB_PIEZO's dry run; all figures are assumed.
class MotorVibration {
 public:
  static constexpr std::array<int, 7> orders{1, 2, 8, 24, 50, 100, 200};
  static constexpr std::array<double, 5> mode_frequencies{75.0, 130.0, 215.0, 330.0, 520.0};  // Hz
  static constexpr std::array<double, 5> mode_damping{0.03, 0.035, 0.04, 0.045, 0.05};
  static constexpr double unit_rms = 1.6e-3;        // N
  static constexpr double reference_speed = 10e-3;  // m/s

  // `stream`: of the recording, for level, phases and noise.
  MotorVibration(const MotorSettings& settings, RandomStream stream);

  // Returns the force [N] that the sensor feels in addition to its contact force, along its normal.
  // `stage`: position and velocity of its pad. Must be called once per step of `dt` [s], in order
  // of time.
  double force(const BodyState& stage, bool touching, double dt);

 private:
  struct Mode {
    double omega = 0.0, zeta = 0.0;
    // Over a step: state <- propagator state + gain of the drive at its start and at its end.
    std::array<double, 2> from_q{}, from_v{}, from_start{}, from_end{};
    double q = 0.0, v = 0.0;
  };

  // Sums over axes that move.
  struct Drive {
    double lines = 0.0, speed = 0.0;  // m/s
    // Hz, corner of the noise: the last order's, weighted by the axes' contributions.
    double corner = 0.0;
  };

  double drive(const BodyState& stage, double dt);
  void add_axis(Drive& drive, std::size_t axis, double speed, double turns) const;
  void add_noise(Drive& drive, std::size_t axis, double speed) const;
  void set_step(double dt);

  MotorSettings settings_;
  RandomStream stream_;
  double amplitude_ = 0.0;  // N rms at the reference speed, of this recording
  // [axis, the idle one last][order]
  std::array<std::array<std::complex<double>, 7>, 4> line_phase_{};
  std::array<Mode, 5> modes_;
  double time_ = 0.0;   // s, since the recording began; used by the idle axis
  double step_ = 0.0;   // s, step for which the modes are set
  double noise_ = 0.0;  // of variance 1
  // Angle of the noise's pole per step [turns], and the share of the noise that remains after a
  // step.
  double noise_corner_ = 0.0, noise_keeps_ = 1.0;
  double last_drive_ = 0.0;  // N
  bool rings_ = false;       // true while a mode moves
};

}  // namespace slipbench
