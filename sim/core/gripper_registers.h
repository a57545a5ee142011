// What a controller reads from a gripper and writes to it and to the arm that carries it: the registers of a Robotiq 2F-85 (shared SENSORS.md, section 5).
#pragma once

#include <optional>

namespace slipbench {

// Registers hold one byte.
inline constexpr int max_register = 255;

// How fast the arm that carries the gripper is to move on: horizontally, square to the fingers' closing direction, and up.
struct ArmCommand {
  double sideways = 0.0;  // m/s
  double up = 0.0;        // m/s
};

// What a read of the status returns.
struct GripperStatus {
  double time = 0.0;     // s, instant of the read
  int position = 0;      // gPO, counts: 0 open, growing as the fingers close
  bool moving = false;   // gOBJ = 0
  bool stopped = false;  // gOBJ = 1 or 2: stopped at the force limit before it was where it was told to be
};

// What a write sends. A value that is no byte is a fault of the controller: the gripper refuses it.
struct GripCommand {
  int position = 0;  // rPR, counts
  int speed = 0;     // rSP, 0 slowest
  int force = 0;     // rFR, 0 weakest
  // What goes to the arm with it, where the scene's motion is guided; empty: nothing is said to the arm, which goes on as told before.
  std::optional<ArmCommand> arm{};
};

}  // namespace slipbench
