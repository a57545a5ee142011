// The two fingers of a grasp as MuJoCo bodies.
#pragma once

#include <array>
#include <cstddef>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"

struct mjsBody_;

namespace slipbench {

// Each is a free body on the springs of finger_spring.h. Neither arm nor drive yields, so neither
// needs a body, and the model has no heavy body. The simulation sets the applied forces to
// FingerSpring::wrench() plus the force that carries the finger's weight: its springs are measured
// from its position under its weight. A finger's frame and its mass are at its pivot, so that
// accelerating it causes no pitch.
struct Hand {
  const Parameters& grip;  // of the entry `grip`
  double yaw, pitch;       // rad, about the arm's Z and then the hand's Y
  double opening;          // m, between the pads' origins at the start
  const char* box;         // name of the body to be grasped
};

// The sensor's finger first: it is on the -X side and closes towards +X.
struct FingerNames {
  const char *body, *site;  // `site`: the pad frame, Z opposite to the closing direction, Y up
};
inline constexpr std::array<FingerNames, 2> finger_names{{
    {"slipbench/finger", "slipbench/finger pad"},
    {"slipbench/second finger", "slipbench/second finger pad"},
}};

// Returns the pose of the carriage of finger 0 or 1 in the arm's frame, at its pivot: x is its
// closing direction. `opening` as in Hand.
Pose carriage_in_arm(const Hand& hand, std::size_t finger, double opening);

// Adds both fingers to `world`, at their carriages' positions with the arm at the origin.
void add_fingers(mjsBody_* world, const Hand& hand);

}  // namespace slipbench
