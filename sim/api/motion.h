// The interface of prescribed motions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"

namespace slipbench {

// Strength of the vibration of a bench's motors, and the motions that cause it.
struct MotorSettings {
  double level = 1.0;       // 1: 1.6 mN rms before the resonances when an axis moves at 10 mm/s
  double sd = 0.1;          // of the logarithm of the level, between recordings
  double in_contact = 1.6;  // factor applied while the pad touches something
  // m, travel of each axis, X, Y, Z, per turn of its spindle
  Eigen::Vector3d lead{8e-3, 8e-3, 4e-3};
  // m/s, of a further axis, which does not carry the pad; its lead is that of X.
  double idle_speed = 0.0;
  double idle_start = 0.0;  // s, start of that axis
  double rest_speed = 0.0;  // m/s, speed of an axis that is as noisy as all motors at rest
};

// Motion of the pad, or of a grasp's arm, over time. A surface that a pad presses on is at rest,
// with its top at z = 0.
class Motion {
 public:
  virtual ~Motion() = default;
  // State of the pad at time t [s], exact.
  [[nodiscard]] virtual BodyState pad_at(double t) const = 0;
  // Returns an upper bound of the speed of any point of the pad within `reach` [m] of its origin
  // [m/s].
  [[nodiscard]] virtual double top_speed(double reach) const = 0;
  // Returns the longest step [s] within which the path of every point of the pad may count as
  // straight (sim/motion/straight_path.h).
  [[nodiscard]] virtual double longest_step() const = 0;
  // True if the pad rotates about its normal.
  [[nodiscard]] virtual bool turns() const = 0;
  // Vibration of its motors; empty: none.
  [[nodiscard]] virtual std::optional<MotorSettings> motors() const { return std::nullopt; }
};

// Key of the random numbers of a motion.
struct MotionKey {
  std::uint64_t seed = 0;  // of the dataset
  std::uint64_t trial = 0;
};

// A kind of motion that a scene may name.
struct MotionKind {
  Entry about;
  // Throws SceneValueError if the parameters contradict each other.
  std::unique_ptr<Motion> (*create)(const Parameters& parameters, const MotionKey& key);
  bool (*is_random)(const Parameters& parameters) = nullptr;  // true if each trial draws its own path
  bool of_arm = false;                                        // moves the arm of a grasp; false: the pad of a stage
};

// The kind of motion that the class `Made` is. `Made` takes the key if it draws random numbers.
template <class Made>
MotionKind motion_kind(Entry about, bool of_arm = false) {
  constexpr bool is_random = std::is_constructible_v<Made, const Parameters&, const MotionKey&>;
  const auto create = [](const Parameters& parameters, const MotionKey& key) -> std::unique_ptr<Motion> {
    if constexpr (is_random) {
      return std::make_unique<Made>(parameters, key);
    } else {
      return std::make_unique<Made>(parameters);
    }
  };
  return {std::move(about), create, [](const Parameters&) { return is_random; }, of_arm};
}

}  // namespace slipbench
