// The two fingers of a grasp as MuJoCo bodies.
//
// Each is a free body on the springs of finger_spring.h. Neither arm nor drive yields, so neither needs a body, and there is no heavy one
// in the model. Whoever steps it sets the applied forces to FingerSpring::wrench() and what carries the finger's weight: its springs are
// counted from where it hangs. A finger's frame and its mass are at its pivot, so that it does not pitch when it is sped up.
#pragma once

#include <array>
#include <cstddef>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"

struct mjsBody_;

namespace slipbench {

struct Hand {
  const Parameters& grip;  // of the entry `grip`
  double yaw, pitch;       // rad, about the arm's Z and then the hand's Y
  double opening;          // m, between the pads' origins at the start
  const char* box;         // name of the body that it takes
};

// The sensor's finger first: it is on the -X side and closes towards +X.
struct FingerNames {
  const char *body, *site;  // `site`: the pad frame, Z against the closing direction, Y up
};
inline constexpr std::array<FingerNames, 2> finger_names{{
    {"slipbench/finger", "slipbench/finger pad"},
    {"slipbench/second finger", "slipbench/second finger pad"},
}};

// In the middle of the box, axes alike: the pad frame of its corners, which stand on the table as elements of a field do. So the table's
// friction is Coulomb's, and no solver is needed for it.
inline constexpr const char* corner_site = "slipbench/box corners";

// Where the carriage of finger 0 or 1 is in the arm's frame, at its pivot: x is its closing direction. `opening` as in Hand.
Pose carriage_in_arm(const Hand& hand, std::size_t finger, double opening);

// Adds both fingers to `world`, where their carriages are when the arm is at the origin.
void add_fingers(mjsBody_* world, const Hand& hand);

}  // namespace slipbench
