// One trial of a grasp: what its scene says, and what is drawn for it.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The world's origin is the point between the pads at the start; X is the closing direction, Z up. The sensor's pad is on the finger at
// -X.
struct Grasp {
  Eigen::Vector3d box_size, box_position, centre_of_mass;  // m: extent; its middle in the world; from its middle
  double yaw = 0.0, pitch = 0.0;                           // rad, of the hand about Z and then about its own Y
  double friction_scale = 1.0;                             // of the pads
  double opening = 0.0;                                    // m, at least so much at the start
  double phase = 0.0;                                      // s, of the gripper's loop
};

// Every drawn quantity has a random stream of its own, keyed by (seed, trial): one more or less scatter shifts no other. Throws
// SceneValueError when a pad would miss the box, or the box does not fit the gripper.
Grasp draw_grasp(const GraspScene& scene, std::uint64_t seed, std::uint64_t trial);

// The second pad: a flat grid of 4 x 6 equal elements over the pad's size, one unit each, or a copy of the sensor's elements.
PadLayout second_pad(const Parameters& grip, const PadLayout& sensor);

// The box's eight corners, in its middle's frame: each looks outwards along its diagonal, so that the four of any face that comes down on the
// table carry the box, with the entry `box`'s stiffness together.
PadLayout box_corners(const Parameters& box, const Eigen::Vector3d& box_size);

// The least force of either pad that can hold the box with its weight, m g/(2 mu_s) [N]: both pads carry mu_s times their force. `friction_scale`: of the
// trial (Grasp). Infinite without friction.
double ideal_grip_force(const Scene& scene, double friction_scale, double gravity);

// What a scene may say of a grasp: the keys `grip`, `box` and `scatter`, and the named protocols.

// The three entries, by the name of their key.
const std::vector<Entry>& grasp_catalogue();

// The protocols that grip.protocol may name. What a protocol gives are defaults: a scene's own values replace them.
const std::vector<Protocol>& protocol_catalogue();

}  // namespace slipbench
