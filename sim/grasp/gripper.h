// The drive of a gripper after the Robotiq 2F-85: byte registers over Modbus, and a self-locking motor that moves both fingers alike.
//
// Position. The register counts from open to closed: opening = (closed_at - position) count, between the stops open_at and closed_at.
// A read rounds to the nearest count. (Robotiq's own profile: 0.374 mm a count, settling at 3 open and 230 closed.)
// Loop. Reads fall on phase + n period, writes `write_after` later; what a write says begins to act `latency` after it.
// Motion. From then on a trapezoid in closed form, from where and how fast the fingers are: speed linear in its register from `slowest` to
// `fastest`, `acceleration` a constant. So the motion does not depend on the step of who asks for it.
// Force. While they close, the fingers stop where the force on them reaches that of the force register, linear from `weakest` to
// `strongest`: at the first update() that finds it so. Between commands the position is held whatever the force: screw and nut lock
// themselves.
// Sources: shared SENSORS.md section 5 and GRASP.md; describe says of every parameter whether it is assumed.
#pragma once

#include <cstdint>
#include <deque>

#include "sim/core/gripper_registers.h"
#include "sim/core/parameters.h"
#include "sim/motion/profile.h"

namespace slipbench {

class Gripper {
 public:
  // `grip`: parameters of the entry `grip` (grasp_catalogue.h). It begins at rest, open by `opening` [m] or the next whole count more, as far
  // as its stops allow. `phase` [s]: the first read. Throws SceneValueError where a write would come no earlier than the next read.
  Gripper(const Parameters& grip, double opening, double phase);

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
  [[nodiscard]] double opening_speed(double time) const;  // m/s, negative while they close

 private:
  static constexpr double rounding = 1e-9;  // s, of times that are sums of steps

  struct Pending {
    double time;  // s, when it begins to act
    GripCommand command;
  };

  [[nodiscard]] double instant(std::uint64_t count) const { return phase_ + static_cast<double>(count) * period_; }
  void obey(const Pending& pending);

  double count_, closed_at_, open_at_;  // m; counts
  double slowest_, fastest_, acceleration_, weakest_, strongest_;
  double period_, write_after_, latency_, phase_;  // s
  double dead_band_;                               // counts
  bool wrap_;

  std::uint64_t reads_ = 0, writes_ = 0;
  std::deque<Pending> pending_;
  Profile position_;                           // counts
  double target_, speed_ = 0.0, force_limit_;  // counts, counts/s, N
  bool stopped_ = false;
};

}  // namespace slipbench
