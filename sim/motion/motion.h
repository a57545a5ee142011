// Prescribed motions of the bench and their catalogue.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/core/random.h"

namespace slipbench {

// What the motors of a bench let a sensor feel: they shake the bench, and with it whatever it carries.

// How strong the vibration is, and the drives it comes from.
struct MotorSettings {
  double level = 1.0;                      // 1: 1.6 mN rms before the resonances when an axis moves at 10 mm/s
  double sd = 0.1;                         // of the logarithm of the level, from one recording to the next
  double in_contact = 1.6;                 // factor while the pad touches something
  Eigen::Vector3d lead{8e-3, 8e-3, 4e-3};  // m, way of each axis, X, Y, Z, in a turn of its spindle
  double idle_speed = 0.0;                 // m/s, of a further axis, which does not carry the pad; its lead is that of X
  double idle_start = 0.0;                 // s, from when on that axis runs
  double rest_speed = 0.0;                 // m/s, of an axis whose noise is as strong as that of all motors at rest
};

// Each axis that moves at v drives, with a mean square in proportion to v, half by lines at orders 1, 2, 8, 24, 50, 100, 200 of its spindle's
// frequency v/lead, equally strong and of random phase, half by red noise that ends at the last order. The spindle's angle is
// 2 pi position/lead, so a line follows any change of speed without a jump. This goes through the sum of the frame's five modes r, which
// passes accelerations:
//   H(s) = sum_r s^2/(s^2 + 2 zeta_r w_r s + w_r^2),  w_r/2 pi = 75, 130, 215, 330, 520 Hz, zeta_r = 0.03 to 0.05,
// moved exactly between samples for a drive that is linear in between. An idle axis is a further one that moves at a constant speed. Motors that
// hold their position drive all the time with the noise of an axis at rest_speed, without lines, for nothing turns.
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
  void add_noise(Drive& drive, std::size_t axis, double speed) const;
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

// Where the pad is, or the arm of a grasp, at any time. A surface that a pad is pressed on stands still; its top is at z = 0.
class Motion {
 public:
  virtual ~Motion() = default;
  // State of the pad at time t [s], exact.
  [[nodiscard]] virtual BodyState pad_at(double t) const = 0;
  // Bound on the speed of any point of the pad within `reach` [m] of its origin [m/s].
  [[nodiscard]] virtual double top_speed(double reach) const = 0;
  // Whether the pad turns about its normal.
  [[nodiscard]] virtual bool turns() const = 0;
  // How its motors shake what it carries; empty: not at all.
  [[nodiscard]] virtual std::optional<MotorSettings> motors() const { return std::nullopt; }
};

// What keys the random numbers of a motion that has some.
struct MotionKey {
  std::uint64_t seed = 0;  // of the dataset
  std::uint64_t trial = 0;
};

// A kind of motion that a scene may name.
struct MotionKind {
  Entry about;
  // Throws SceneValueError when the parameters contradict each other.
  std::unique_ptr<Motion> (*create)(const Parameters& parameters, const MotionKey& key);
};

// What makes a motion out of its parameters, and out of the key where it draws.
template <class Made>
std::unique_ptr<Motion> created(const Parameters& parameters, const MotionKey& key) {
  if constexpr (std::is_constructible_v<Made, const Parameters&, const MotionKey&>) {
    return std::make_unique<Made>(parameters, key);
  } else {
    return std::make_unique<Made>(parameters);
  }
}

// A hexapod stage: the pad approaches, presses, dwells, slides and/or turns, may stop, reverse, and lift off.
MotionKind stage_motion();
// The pad approaches, presses, holds and slowly retreats, along the vertical alone, while something else moves what it touches.
MotionKind press_motion();
// A finger that is pressed on a spot of its round skin and rubs, slides or turns there by fits and starts. The pad's skin is taken as the lower
// half of an ellipsoid.
MotionKind rub_motion();
// A hand: the pad stands still over the surface, comes down and wanders at random in all six coordinates.
MotionKind wander_motion();

// All kinds, one line each.
const std::vector<MotionKind>& motion_catalogue();

// The arm begins at the origin, aligned with the world. See describe().
MotionKind lift_motion();

// When the arm begins to rise and when it has risen [s].
struct LiftTimes {
  double start, end;
};
// `parameters`: of the motion `lift`.
LiftTimes lift_times(const Parameters& parameters);

}  // namespace slipbench
