// The truth about one pad's contact at one instant. Sensors read it; labels are written from it; detectors never see it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pad_state.h"

namespace slipbench {

// State of a unit. Values are those of the dataset (unit_state).
enum class UnitState : std::uint8_t {
  detached = 0,
  stick = 1,
  slip = 2,     // all of its touching elements slip
  partial = 3,  // some of them slip
};

// Kind of an event of a unit. Values are those of the dataset (events/kind). Events tell every change of a unit's state: after touch and
// stick it sticks, after micro and part_sticks a part of it slips, after slip all of it, after detach it is detached. A unit that lets
// go as a whole reports micro and slip at the same time.
enum class EventKind : std::uint8_t {
  touch = 0,
  slip = 1,   // the unit begins to slip as a whole
  stick = 2,  // no part of it slips any more, still touching
  detach = 3,
  micro = 4,        // a first part of it begins to slip
  part_sticks = 5,  // it slipped as a whole, and a part of it sticks again
};

// Something that happened to a unit inside the last step.
struct ContactEvent {
  double time;  // s, resolved inside the step
  std::uint32_t unit;
  EventKind kind;
};

// Contact of one pad with N units. Columns are units. Vectors are in the pad frame P (pad_layout.h); +Z is compression. What lies in the
// contact plane is given in P turned the shortest way until its Z is the surface's normal, so that a tilted pad's friction obeys the cone.
struct ContactFrame {
  double time = 0.0;      // s
  Eigen::Array3Xd force;  // [3,N] N, what the object does to the unit, in P, as a sensor feels it: with what shakes the bench
  Eigen::Array3Xd contact_force;      // [3,N] N, the same in the contact plane: x, y tangential, z normal, compression positive
  Eigen::Array3Xd displacement;       // [3,N] m, deformed tip minus undeformed tip (mean of a unit's elements)
  Eigen::Array2Xd slip_velocity;      // [2,N] m/s, velocity of the slipping tip in the contact plane, mean over the last step
  Eigen::ArrayXd slip_distance;       // [N] m, path slipped, in mujoco_contact also crept, since the start: mean of its elements
  Eigen::ArrayXd margin;              // [N] 1 - f_t/(mu_s f_n), NaN while detached; below 0 where a rate law carries more
  std::vector<UnitState> unit_state;  // [N]
  PadState state = PadState::no_contact;        // rule strict: a unit slips when all of it slips
  PadState state_micro = PadState::no_contact;  // rule micro: a unit slips as soon as a part of it does
  double stuck_fraction = 0.0;                  // share of the touching elements that stick, NaN while nothing touches
  // rad, of the slip's translation in the pad plane. NaN while no unit slips or the mean velocity of
  // those that slip is below 1e-6 of the fastest.
  double slip_direction = 0.0;
  Eigen::Array2d slip_centre{0.0, 0.0};  // m, instantaneous centre of the slip, NaN where the slip has no rotation
  double slip_angle = 0.0;               // rad, rotation of the slip about the pad's normal, accumulated
  std::vector<ContactEvent> events;      // of the last step, in order of time
  // Of each of the E elements, summed over the surfaces, where the layout asks for it (PadLayout::element_truth); else empty.
  Eigen::ArrayXd element_depth;  // [E] m, of the undeformed tip in the surface, along the surface's normal
  Eigen::ArrayX3d
      element_shear;  // [E,3] m, deformed tip minus undeformed tip along the surface, in P: without what it is pressed in
  // m, in the world: where the stage that carries the pad stands, as the bench's own position sensor would say. NaN where bodies move by
  // forces, and on articulated pads: nothing is measured there.
  Eigen::Array3d stage_position = Eigen::Array3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

// How much of a frame is right when it is handed out: time, pad states, stuck fraction and events; with what sensors read, namely force, displacement and
// what each element does; or all.
enum class FramePart : std::uint8_t { states, felt, all };

}  // namespace slipbench
