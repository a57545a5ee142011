// One trial of a grasp: the scene's settings and the trial's random draws.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "sim/api/controller.h"
#include "sim/api/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/motion/guided.h"
#include "sim/motion/profile.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The drive of a gripper after the Robotiq 2F-85: byte registers over Modbus, and a self-locking
// motor that moves both fingers alike.
//
// Position. The register counts from open to closed: opening = (closed_at - position) count,
// between the stops open_at and closed_at. A read rounds to the nearest count. (Robotiq's own
// profile: 0.374 mm per count, settling at 3 open and 230 closed.)
//
// Loop. Reads occur at phase + n period, writes `write_after` later; a write takes effect `latency`
// after it.
//
// Motion. From then on a trapezoid in closed form, from the fingers' current position and speed:
// speed linear in its register from `slowest` to `fastest`, constant `acceleration`. So the motion
// does not depend on the caller's step.
//
// Drift. The fingers wander around the position that the drive holds: opening =
// (closed_at - position) count + drift g(t), with g(t) = 1/2 sum of 8 sin(2 pi f t + p), of
// variance 1. It is play and creep of the fingers, behind the encoder, so no count shows it.
//
// Force. While they close, the fingers stop where the force on them reaches that of the force
// register, linear from `weakest` to `strongest`, at the first update() that finds it so. Between
// commands the position is held at any force: screw and nut are self-locking.
//
// Sources: the manual of the 2F-85 and the profile k2F85 of Robotiq's repository `grippers`;
// `describe` gives the source of each parameter and marks those that are assumed.

// A sine of a grip's drift.
struct DriftTone {
  double omega, phase;  // rad/s, rad
};

class Gripper {
 public:
  // `grip`: parameters of the entry `grip` (grip_entry). The gripper starts at rest, open by
  // `opening` [m] rounded up to the next whole count, as far as its stops allow. `phase` [s]: the
  // first read. `drift`: of the trial (Grasp); empty: none. Throws SceneValueError if a write would
  // not come before the next read, and if the drift would start beyond the open stop.
  Gripper(const Parameters& grip, double opening, double phase, std::vector<DriftTone> drift = {});

  // ---- The loop. Every read and write must be called once, in order of time. They may be called
  // at a tick after their instant, because the instants count, not the times of the calls.
  [[nodiscard]] bool read_due(double time) const { return next_read() <= time + rounding; }
  [[nodiscard]] double next_read() const { return instant(reads_); }  // s
  // Returns the status at the read that is due. All update() calls up to its instant must have been
  // made.
  GripperStatus read();
  [[nodiscard]] bool write_due(double time) const { return next_write() <= time + rounding; }
  [[nodiscard]] double next_write() const { return instant(writes_) + write_after_; }  // s
  // Sends a command with the write that is due, and returns it as sent. Throws InputError if a
  // value is not a byte, unless the parameter `wrap` asks for its low byte, as a driver without
  // checks would send it.
  GripCommand write(const GripCommand& command);
  [[nodiscard]] double latency() const { return latency_; }  // s, from a write to its effect

  // ---- The drive.
  // Must be called at every tick, in order of time, before any of the functions below for that
  // time. Applies commands, and stops the motor if `force` [N], with which a finger presses, has
  // reached the limit.
  void update(double time, double force);
  [[nodiscard]] int position(double time) const;    // counts, as read at that time
  [[nodiscard]] double opening(double time) const;  // m, between the two pads' origins without load
  // m/s, negative while closing; drift included
  [[nodiscard]] double opening_speed(double time) const;

 private:
  static constexpr double rounding = 1e-9;  // s, tolerance of times that are sums of steps

  struct Pending {
    double time;  // s, when it takes effect
    GripCommand command;
  };

  [[nodiscard]] double wander(double time) const;  // m, the drift's share of the opening
  [[nodiscard]] double instant(std::uint64_t count) const { return phase_ + static_cast<double>(count) * period_; }
  void obey(const Pending& pending);

  double count_, closed_at_, open_at_;  // m; counts
  double slowest_, fastest_, acceleration_, weakest_, strongest_;
  double period_, write_after_, latency_, phase_;  // s
  double dead_band_;                               // counts
  bool wrap_;
  double drift_amplitude_;  // m, of each tone
  std::vector<DriftTone> drift_;

  std::uint64_t reads_ = 0, writes_ = 0;
  std::deque<Pending> pending_;
  Profile position_;                           // counts
  double target_, speed_ = 0.0, force_limit_;  // counts, counts/s, N
  bool stopped_ = false;
};

// The draws of one grasp. The world's origin is the point between the pads at the start; X is the
// closing direction, Z up. The sensor's pad is on the finger at -X.
struct Grasp {
  // m: extent; its middle in the world; relative to its middle
  Eigen::Vector3d box_size, box_position, centre_of_mass;
  double yaw = 0.0, pitch = 0.0;      // rad, of the hand about Z, then about its own Y
  double friction_scale = 1.0;        // of the pads
  double opening = 0.0;               // m, minimum at the start
  double phase = 0.0;                 // s, of the gripper's loop
  std::vector<DriftTone> drift = {};  // of the fingers; empty: none
};

// Draws one grasp. Every drawn quantity has its own random stream, keyed by (seed, trial), so that
// changing one scatter shifts no other. Throws SceneValueError if a pad would miss the box, or the
// box does not fit the gripper.
Grasp draw_grasp(const GraspScene& scene, std::uint64_t seed, std::uint64_t trial);

// Returns the second pad: a flat grid of 4 x 6 equal elements over the pad's size, one unit each,
// or a copy of the sensor's elements.
PadLayout second_pad(const Parameters& grip, const PadLayout& sensor);

// Returns contact elements at the box's eight corners, in its middle's frame, each pointing
// outwards along its diagonal. The four of any face on the table carry the box together with the
// stiffness of the entry `box`.
PadLayout box_corners(const Parameters& box, const Eigen::Vector3d& box_size);

// Returns the least force of either pad that can hold the box's weight, m g/(2 mu_s) [N]: each pad
// carries mu_s times its force. `friction_scale`: of the trial (Grasp). Infinite without friction.
double ideal_grip_force(const Scene& scene, double friction_scale, double gravity);

// Catalogue of a grasp: the keys `grip`, `box` and `scatter`, and the named protocols.

// The three entries, by the name of their key.
const std::vector<Entry>& grasp_catalogue();

// The protocols for grip.protocol. A protocol sets defaults: a scene's own values replace them.
const std::vector<Protocol>& protocol_catalogue();

// Interface of a simulation with a gripper and a box, for the control loop and for recording.

// The truth about a grasp at one tick, hidden from detectors and controllers.
struct GraspTruth {
  double time = 0.0;                 // s
  double grip_force = 0.0;           // N, mean of both pads' normal forces
  double pad_force[2] = {0.0, 0.0};  // N, of the sensor's pad and of the second pad
  double box_height = 0.0;           // m, of the box's middle, relative to the start
  // m, maximum since the lift began of the height of the box's lowest corner over the table
  double lift_height = 0.0;
  double table_force = 0.0;  // N, of the table on the box
  // m, displacement of the box's middle in the arm's frame since the lift began; 0 before
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();
  double rotation = 0.0;  // rad, of the box in the arm's frame since then
  // rad, between the box's own axis Y and the vertical: 0 upright, pi/2 where Y is level
  double tilt = 0.0;
  // The box has left the table since the lift began. Never true with a guided arm, which may turn
  // the box on the table.
  bool lifted = false;
  bool dropped = false;      // from the tick on at which it was lost after being lifted
  bool left_behind = false;  // the arm has risen without lifting the box
};

class HeldBox {
 public:
  virtual ~HeldBox() = default;

  [[nodiscard]] virtual Gripper& gripper() = 0;
  // The truth at the last tick.
  [[nodiscard]] virtual const GraspTruth& truth() const = 0;
  // Returns the least force of either pad that can hold the trial's box upwards [N]: m g/(2 mu_s)
  // with the trial's mu_s, without effects that change it in time and space. Infinite without
  // friction.
  [[nodiscard]] virtual double ideal_force() const = 0;
  // Returns the arm that a controller commands; null if it moves as the scene prescribes.
  [[nodiscard]] virtual Guided* arm() { return nullptr; }
  // Returns when the lift begins [s]; infinite until a guided arm is commanded to rise.
  [[nodiscard]] virtual double lift_start() const = 0;

 protected:
  HeldBox() = default;
  HeldBox(const HeldBox&) = default;
  HeldBox& operator=(const HeldBox&) = default;
};

}  // namespace slipbench
