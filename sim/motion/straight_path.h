// Steps within which the path of a pad may count as straight, as sim/contact assumes. README.md
// states the accuracy that these limits give.
#pragma once

#include <limits>
#include <numbers>

namespace slipbench {

// Largest rotation about the surface's normal within a step [rad].
inline constexpr double largest_turn = 3.0 * std::numbers::pi / 180.0;
// Least number of steps in a period of an oscillation.
inline constexpr double steps_in_period = 32.0;
// Largest share of the path between two reversals that a step with a reversal may lose.
inline constexpr double largest_loss = 0.01;

// Returns the longest step [s] for a rotation at up to `rate` [rad/s].
inline double step_per_turn(double rate) { return rate > 0.0 ? largest_turn / rate : std::numeric_limits<double>::infinity(); }

// Returns the longest step [s] for an oscillation at up to `frequency` [Hz].
inline double step_per_period(double frequency) {
  return frequency > 0.0 ? 1.0 / (steps_in_period * frequency) : std::numeric_limits<double>::infinity();
}

}  // namespace slipbench
