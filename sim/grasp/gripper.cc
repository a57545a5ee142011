#include "sim/grasp/gripper.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// Counts closer than this are the same: positions are sums of doubles.
constexpr double same_count = 1e-6;

double linear(int value, double least, double most) {
  return least + (most - least) * static_cast<double>(value) / static_cast<double>(max_register);
}

int byte_of(int value, const char* name, bool wrap, double time) {
  if (value >= 0 && value <= max_register) return value;
  if (wrap) return static_cast<int>(static_cast<unsigned char>(value));
  throw InputError(
      fmt::format("the gripper was told the {} {} at {:.6g} s; allowed: 0 to {} (grip.wrap: true takes the low byte)", name,
                  value, time, max_register));
}

}  // namespace

Gripper::Gripper(const Parameters& grip, double opening, double phase)
    : count_(grip.number("count")),
      closed_at_(static_cast<double>(grip.integer("closed_at"))),
      open_at_(static_cast<double>(grip.integer("open_at"))),
      slowest_(grip.number("slowest") / count_),
      fastest_(grip.number("fastest") / count_),
      acceleration_(grip.number("acceleration") / count_),
      weakest_(grip.number("weakest")),
      strongest_(grip.number("strongest")),
      period_(grip.number("period")),
      write_after_(grip.number("write_after")),
      latency_(grip.number("latency")),
      phase_(phase),
      dead_band_(static_cast<double>(grip.integer("dead_band"))),
      wrap_(grip.flag("wrap")),
      position_(std::clamp(std::floor(closed_at_ - opening / count_ + same_count), open_at_, closed_at_)),
      target_(position_.at(0.0).position),
      force_limit_(weakest_) {
  if (write_after_ >= period_) {
    throw SceneValueError("grip.write_after", format_quantity(write_after_, Quantity::time) +
                                                  " after its read comes the next read; allowed: less than the period of " +
                                                  format_quantity(period_, Quantity::time));
  }
}

GripperStatus Gripper::read() {
  const double time = next_read();
  ++reads_;
  return {time, position(time), position_.at(time).velocity != 0.0, stopped_};
}

GripCommand Gripper::write(const GripCommand& command) {
  const double time = next_write();
  ++writes_;
  const GripCommand sent{byte_of(command.position, "position", wrap_, time), byte_of(command.speed, "speed", wrap_, time),
                         byte_of(command.force, "force", wrap_, time)};
  pending_.push_back({time + latency_, sent});
  return sent;
}

void Gripper::obey(const Pending& pending) {
  const double speed = linear(pending.command.speed, slowest_, fastest_);
  const double target = std::clamp(static_cast<double>(pending.command.position), open_at_, closed_at_);
  const double force_limit = linear(pending.command.force, weakest_, strongest_);
  const bool stronger = force_limit > force_limit_;
  force_limit_ = force_limit;
  // Told the same again it goes on as it was: under way, there, or stopped unless it may now press harder.
  if (target == target_ && speed == speed_ && !(stopped_ && stronger)) return;
  if (dead_band_ > 0.0 && std::abs(target - position_.at(pending.time).position) <= dead_band_ + same_count) return;
  target_ = target;
  speed_ = speed;
  stopped_ = false;
  position_.move_to(pending.time, target, speed, acceleration_);
}

void Gripper::update(double time, double force) {
  for (; !pending_.empty() && pending_.front().time <= time + rounding; pending_.pop_front()) obey(pending_.front());
  if (force < force_limit_ || !(position_.at(time).velocity > 0.0)) return;
  position_.change_velocity(time, 0.0, std::numeric_limits<double>::infinity());
  stopped_ = true;
}

int Gripper::position(double time) const { return static_cast<int>(std::lround(position_.at(time).position)); }

double Gripper::opening(double time) const { return (closed_at_ - position_.at(time).position) * count_; }

double Gripper::opening_speed(double time) const { return -position_.at(time).velocity * count_; }

}  // namespace slipbench
