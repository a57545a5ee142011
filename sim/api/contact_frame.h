// The truth about one pad's contact at one instant. Sensors read it, labels are written from it,
// and detectors never see it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_state.h"

namespace slipbench {

// State of a unit. Values are those of the dataset (unit_state).
enum class UnitState : std::uint8_t {
  detached = 0,
  stick = 1,
  slip = 2,     // all of its touching elements slip
  partial = 3,  // some of them slip
};

// Kind of a unit's event. Values are those of the dataset (events/kind). Every change of a unit's
// state has an event: after touch and stick the unit sticks, after micro and part_sticks a part of
// it slips, after slip all of it slips, after detach it is detached. A unit that starts to slip as
// a whole reports micro and slip at the same time.
enum class EventKind : std::uint8_t {
  touch = 0,
  slip = 1,   // it slips as a whole
  stick = 2,  // no part of it slips any more, and it still touches
  detach = 3,
  micro = 4,        // a first part of it begins to slip
  part_sticks = 5,  // it slipped as a whole, and a part of it sticks again
};

// A change of a unit's state inside the last step.
struct ContactEvent {
  double time;  // s, resolved inside the step
  std::uint32_t unit;
  EventKind kind;
};

// Contact of one pad with N units. Columns are units. Vectors are in the pad frame P
// (pad_layout.h); +Z is compression. Vectors in the contact plane are given in P rotated by the
// shortest rotation that makes its Z the surface normal, so that a tilted pad's friction obeys the
// cone.
struct ContactFrame {
  double time = 0.0;  // s
  // [3,N] N, force of the object on the unit, in P, as a sensor feels it: vibration of the bench
  // included
  Eigen::Array3Xd force;
  // [3,N] N, the same in the contact plane: x, y tangential, z normal, compression positive
  Eigen::Array3Xd contact_force;
  // [3,N] m, deformed minus undeformed tip (mean of a unit's elements)
  Eigen::Array3Xd displacement;
  // [2,N] m/s, velocity of the slipping tip in the contact plane, mean over the last step
  Eigen::Array2Xd slip_velocity;
  // [N] m, path slipped since the start (in mujoco_contact creep included), mean of a unit's
  // elements
  Eigen::ArrayXd slip_distance;
  // [N] 1 - f_t/(mu_s f_n), NaN while detached; negative where a rate law carries more
  Eigen::ArrayXd margin;
  std::vector<UnitState> unit_state;      // [N]
  PadState state = PadState::no_contact;  // rule strict: a unit slips when all of it slips
  // rule micro: a unit slips as soon as a part of it slips
  PadState state_micro = PadState::no_contact;
  double stuck_fraction = 0.0;  // share of the touching elements that stick, NaN without touch
  // rad, direction of the slip's translation in the pad plane. NaN while no unit slips or the mean
  // velocity of the slipping units is below 1e-6 of the fastest one.
  double slip_direction = 0.0;
  // m, instantaneous centre of the slip, NaN without rotation
  Eigen::Array2d slip_centre{0.0, 0.0};
  double slip_angle = 0.0;  // rad, rotation of the slip about the pad's normal, accumulated
  // of the last step, in order of time
  std::vector<ContactEvent> events;
  // Values of the E elements, summed over the surfaces, if the layout asks for them
  // (PadLayout::element_truth); else empty.
  Eigen::ArrayXd element_depth;   // [E] m, depth of the undeformed tip along the surface normal
  Eigen::ArrayX3d element_shear;  // [E,3] m, deformed minus undeformed tip, tangential part, in P
  // m, in the world: position of the stage that carries the pad, as the position sensor of the
  // bench would report it. NaN if bodies move by forces, and for articulated pads: these benches
  // have no position sensor.
  Eigen::Array3d stage_position = Eigen::Array3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

// The parts of a frame that are valid when it is returned. states: time, pad states, stuck fraction
// and events. felt: also the values that sensors read, namely force, displacement and the elements'
// values. all: everything.
enum class FramePart : std::uint8_t { states, felt, all };

}  // namespace slipbench
