#include "sim/motion/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipbench {

Profile::Profile(double position) : pieces_{{-std::numeric_limits<double>::infinity(), position, 0.0, 0.0}} {}

void Profile::change_velocity(double t, double velocity, double acceleration) {
  const ProfilePoint from = at(t);
  while (pieces_.back().start > t) pieces_.pop_back();  // cut short a change under way at t
  const double change = velocity - from.velocity;
  if (change == 0.0) {
    if (pieces_.back().acceleration != 0.0) pieces_.push_back({t, from.position, velocity, 0.0});
    return;
  }
  if (std::isinf(acceleration)) {
    pieces_.push_back({t, from.position, velocity, 0.0});
    return;
  }
  const double a = std::copysign(acceleration, change);
  const double duration = change / a;
  pieces_.push_back({t, from.position, from.velocity, a});
  pieces_.push_back({t + duration, from.position + duration * 0.5 * (from.velocity + velocity), velocity, 0.0});
}

void Profile::move(double t, double distance, double speed, double acceleration) {
  if (distance == 0.0) return;
  const double length = std::abs(distance);
  // a short move never reaches full speed
  const double top = std::min(speed, std::sqrt(acceleration * length));
  const double ramp = std::isinf(acceleration) ? 0.0 : top / acceleration;
  const double way_at_top = length - top * ramp;
  change_velocity(t, std::copysign(top, distance), acceleration);
  change_velocity(t + ramp + std::max(0.0, way_at_top) / top, 0.0, acceleration);
  // Rounding in the times must not leave a residual speed or an offset.
  pieces_.back().velocity = 0.0;
}

void Profile::move_to(double t, double target, double speed, double acceleration) {
  const ProfilePoint from = at(t);
  // signed braking distance
  const double braking = 0.5 * from.velocity * std::abs(from.velocity) / acceleration;
  const double left = target - from.position;
  if (from.velocity == 0.0 || (left - braking) * from.velocity < 0.0) {
    change_velocity(t, 0.0, acceleration);
    const double rest = std::max(t, end());
    move(rest, target - at(rest).position, speed, acceleration);
    return;
  }
  const double now = std::abs(from.velocity), length = std::abs(left);
  // Accelerating to `top` and braking to rest takes the distance (top^2 - now^2/2)/acceleration.
  const double top = std::min(speed, std::sqrt(acceleration * length + 0.5 * now * now));
  const double ramp = std::isinf(acceleration) ? 0.0 : std::abs(top - now) / acceleration;
  const double way_at_top = length - 0.5 * (now + top) * ramp - 0.5 * top * top / acceleration;
  change_velocity(t, std::copysign(top, left), acceleration);
  change_velocity(t + ramp + std::max(0.0, way_at_top) / top, 0.0, acceleration);
  pieces_.back().velocity = 0.0;
}

double Profile::top_speed() const {
  double top = 0.0;
  for (const Piece& piece : pieces_) top = std::max(top, std::abs(piece.velocity));
  return top;
}

ProfilePoint Profile::at(double t) const {
  auto piece = pieces_.end() - 1;
  while (t < piece->start) --piece;
  const double since = piece->velocity == 0.0 && piece->acceleration == 0.0 ? 0.0 : t - piece->start;
  return {piece->position + since * (piece->velocity + 0.5 * piece->acceleration * since),
          piece->velocity + piece->acceleration * since};
}

ProfilePoint come_down(double t, double start, double time) {
  if (t <= start) return {0.0, 0.0};
  if (t >= start + time) return {1.0, 0.0};
  const double s = (t - start) / time;
  return {s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / time};
}

}  // namespace slipbench
