// One trial of a grasp: what its scene says, and what is drawn for it.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "sim/core/controller.h"
#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/motion/guided.h"
#include "sim/motion/profile.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The drive of a gripper after the Robotiq 2F-85: byte registers over Modbus, and a self-locking motor that moves both fingers alike.
//
// Position. The register counts from open to closed: opening = (closed_at - position) count, between the stops open_at and closed_at.
// A read rounds to the nearest count. (Robotiq's own profile: 0.374 mm a count, settling at 3 open and 230 closed.)
// Loop. Reads fall on phase + n period, writes `write_after` later; what a write says begins to act `latency` after it.
// Motion. From then on a trapezoid in closed form, from where and how fast the fingers are: speed linear in its register from `slowest` to
// `fastest`, `acceleration` a constant. So the motion does not depend on the step of who asks for it.
// Drift. The fingers wander beside what the drive holds them at: opening = (closed_at - position) count + drift g(t), with
// g(t) = 1/2 sum of 8 sin(2 pi f t + p), of variance 1. It is play and creep of the fingers, behind the encoder: no count shows it.
// Force. While they close, the fingers stop where the force on them reaches that of the force register, linear from `weakest` to
// `strongest`: at the first update() that finds it so. Between commands the position is held whatever the force: screw and nut lock
// themselves.
// Sources: shared SENSORS.md section 5 and GRASP.md; describe says of every parameter whether it is assumed.

// A sine of the drift of a grip.
struct DriftTone {
  double omega, phase;  // rad/s, rad
};

class Gripper {
 public:
  // `grip`: parameters of the entry `grip` (grip_entry). It begins at rest, open by `opening` [m] or the next whole count more, as far
  // as its stops allow. `phase` [s]: the first read. `drift`: of the trial (Grasp); empty: none. Throws SceneValueError where a write would come
  // no earlier than the next read, and where the drift would begin beyond the open stop.
  Gripper(const Parameters& grip, double opening, double phase, std::vector<DriftTone> drift = {});

  // ---- The loop. Every read and write is to be done once, in order of time; a tick after the instant is soon enough, since the instants
  // themselves, not those of the calls, are what counts.
  [[nodiscard]] bool read_due(double time) const { return next_read() <= time + rounding; }
  [[nodiscard]] double next_read() const { return instant(reads_); }  // s
  // The status at the read that is due. All update() up to its instant must have been made.
  GripperStatus read();
  [[nodiscard]] bool write_due(double time) const { return next_write() <= time + rounding; }
  [[nodiscard]] double next_write() const { return instant(writes_) + write_after_; }  // s
  // Sends a command with the write that is due, and returns it as it was sent. Throws InputError when a value is no byte, unless the
  // parameter `wrap` asks for the low byte to be taken, as a driver that does not look would.
  GripCommand write(const GripCommand& command);
  [[nodiscard]] double latency() const { return latency_; }  // s, from a write to when it begins to act

  // ---- The drive.
  // To be called at every tick, in order of time, before anything below is asked for that time: commands begin to act, and the motor stops
  // where `force` [N], with which a finger presses, has reached the limit.
  void update(double time, double force);
  [[nodiscard]] int position(double time) const;          // counts, what a read at that time says
  [[nodiscard]] double opening(double time) const;        // m, between the two pads' origins as they would be without load
  [[nodiscard]] double opening_speed(double time) const;  // m/s, negative while they close; with the drift's

 private:
  static constexpr double rounding = 1e-9;  // s, of times that are sums of steps

  struct Pending {
    double time;  // s, when it begins to act
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

// The world's origin is the point between the pads at the start; X is the closing direction, Z up. The sensor's pad is on the finger at
// -X.
struct Grasp {
  Eigen::Vector3d box_size, box_position, centre_of_mass;  // m: extent; its middle in the world; from its middle
  double yaw = 0.0, pitch = 0.0;                           // rad, of the hand about Z and then about its own Y
  double friction_scale = 1.0;                             // of the pads
  double opening = 0.0;                                    // m, at least so much at the start
  double phase = 0.0;                                      // s, of the gripper's loop
  std::vector<DriftTone> drift = {};                       // of the fingers; empty: none
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

// A simulation with a gripper and a box, as whoever plays the loop and whoever records it sees them.

// The truth about a grasp at one tick, which no detector and no controller sees.
struct GraspTruth {
  double time = 0.0;                 // s
  double grip_force = 0.0;           // N, mean of both pads' normal forces
  double pad_force[2] = {0.0, 0.0};  // N, of the sensor's pad and of the second one
  double box_height = 0.0;           // m, of the box's middle over where it stood
  double lift_height = 0.0;          // m, the greatest of the box's lowest corner over the table since the lift began
  double table_force = 0.0;          // N, with which the table carries the box
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();  // m, of the box's middle in the arm's frame since the lift began; 0 before
  double rotation = 0.0;                           // rad, of the box in the arm's frame since then
  double tilt = 0.0;  // rad, between the box's own axis Y and the vertical: 0 upright, pi/2 where Y is level
  bool lifted =
      false;  // the box has left the table since the lift began; never with a guided arm, which may turn it where it stands
  bool dropped = false;      // from the tick on at which it was lost after it had been lifted
  bool left_behind = false;  // the arm has risen, and the box has not been lifted
};

class HeldBox {
 public:
  virtual ~HeldBox() = default;

  [[nodiscard]] virtual Gripper& gripper() = 0;
  // At the tick last stepped to.
  [[nodiscard]] virtual const GraspTruth& truth() const = 0;
  // The least force of either pad that could hold the trial's box [N]: m g/(2 mu_s), mu_s the trial's, upwards, without what effects add to
  // it in time and place; infinite without friction.
  [[nodiscard]] virtual double ideal_force() const = 0;
  // The arm that a controller commands; null where it moves as the scene prescribes.
  [[nodiscard]] virtual Guided* arm() { return nullptr; }
  // When the lift begins [s]; infinite as long as a guided arm has not been told to rise.
  [[nodiscard]] virtual double lift_start() const = 0;

 protected:
  HeldBox() = default;
  HeldBox(const HeldBox&) = default;
  HeldBox& operator=(const HeldBox&) = default;
};

}  // namespace slipbench
