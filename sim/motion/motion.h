// Prescribed motions of the bench and their catalogue.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
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

// All kinds, one line each.
const std::vector<MotionKind>& motion_catalogue();

}  // namespace slipbench
