// What the motors of a bench let a sensor feel: they shake the bench, and with it whatever it carries.
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include <Eigen/Core>

#include "sim/core/pose.h"
#include "sim/core/random.h"

namespace slipbench {

// How strong the vibration is, and the drives it comes from.
struct MotorSettings {
  double level = 1.0;                      // 1: 1.6 mN rms before the resonances when an axis moves at 10 mm/s
  double sd = 0.1;                         // of the logarithm of the level, from one recording to the next
  double in_contact = 1.6;                 // factor while the pad touches something
  Eigen::Vector3d lead{8e-3, 8e-3, 4e-3};  // m, way of each axis, X, Y, Z, in a turn of its spindle
  double idle_speed = 0.0;                 // m/s, of a further axis, which does not carry the pad; its lead is that of X
  double idle_start = 0.0;                 // s, from when on that axis runs
};

// Each axis that moves at v drives, with a mean square in proportion to v, half by lines at orders 1, 2, 8, 24, 50, 100, 200 of its spindle's
// frequency v/lead, equally strong and of random phase, half by red noise that ends at the last order. The spindle's angle is
// 2 pi position/lead, so a line follows any change of speed without a jump. This goes through the sum of the frame's five modes r, which
// passes accelerations:
//   H(s) = sum_r s^2/(s^2 + 2 zeta_r w_r s + w_r^2),  w_r/2 pi = 75, 130, 215, 330, 520 Hz, zeta_r = 0.03 to 0.05,
// moved exactly between samples for a drive that is linear in between. An idle axis is a further one that moves at a constant speed.
// Source: the forms of NIB_PIEZO's dry run; all figures are assumed.
class MotorVibration {
 public:
  static constexpr std::array<int, 7> orders{1, 2, 8, 24, 50, 100, 200};
  static constexpr std::array<double, 5> mode_frequencies{75.0, 130.0, 215.0, 330.0, 520.0};  // Hz
  static constexpr std::array<double, 5> mode_damping{0.03, 0.035, 0.04, 0.045, 0.05};
  static constexpr double unit_rms = 1.6e-3;        // N
  static constexpr double reference_speed = 10e-3;  // m/s

  // `stream`: of the recording; it keys level, phases and noise.
  MotorVibration(const MotorSettings& settings, RandomStream stream);

  // The force [N] that the sensor feels beside that of its contact, along its normal. `stage`: where its pad is and how it moves. To be called
  // once a step of `dt` [s], in order of time.
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
    double corner = 0.0;              // Hz, of the noise: the last order's, weighted by what each axis adds
  };

  double drive(const BodyState& stage, double dt);
  void add_axis(Drive& drive, std::size_t axis, double speed, double turns) const;
  void set_step(double dt);

  MotorSettings settings_;
  RandomStream stream_;
  double amplitude_ = 0.0;                                           // N rms at the reference speed, of this recording
  std::array<std::array<std::complex<double>, 7>, 4> line_phase_{};  // of each axis, the idle one last, and order
  std::array<Mode, 5> modes_;
  double time_ = 0.0;                              // s, since the recording began; of an idle axis alone
  double step_ = 0.0;                              // s, for which the modes are set
  double noise_ = 0.0;                             // of variance 1
  double noise_corner_ = 0.0, noise_keeps_ = 1.0;  // turns of its pole's frequency in a step, and what a step leaves of the noise
  double last_drive_ = 0.0;                        // N
  bool rings_ = false;                             // whether a mode is still in motion
};

}  // namespace slipbench
