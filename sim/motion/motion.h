// Prescribed motions of the bench and their catalogue.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/motion/motor_vibration.h"

namespace slipbench {

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

}  // namespace slipbench
