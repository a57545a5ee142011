#include "sim/motion/profile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include "sim/motion/straight_path.h"

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

// Within a step of h that contains a reversal, the coordinate moves there and back. At an
// acceleration a the lost path is at most a h^2/4, and at any acceleration at most h times the
// speed.
double Profile::step_per_reversal() const {
  double longest = std::numeric_limits<double>::infinity(), direction = 0.0, begun = pieces_.front().position;
  double acceleration = 0.0, speed = 0.0;
  const auto move = [&](double velocity, double position) {
    speed = std::max(speed, std::abs(velocity));
    if (velocity == 0.0 || velocity * direction > 0.0) return;
    if (direction != 0.0) {
      const double lost = largest_loss * std::abs(position - begun);
      if (lost > 0.0) longest = std::min(longest, std::max(lost / speed, std::sqrt(4.0 * lost / acceleration)));
      begun = position;
    }
    direction = std::copysign(1.0, velocity);
  };
  for (auto piece = pieces_.begin() + 1; piece != pieces_.end(); ++piece) {
    const bool jumps = std::prev(piece)->acceleration == 0.0 && piece->acceleration == 0.0;
    acceleration = jumps ? std::numeric_limits<double>::infinity() : std::max(acceleration, std::abs(piece->acceleration));
    move(piece->velocity, piece->position);
    if (piece->acceleration == 0.0) continue;
    // where the velocity is zero, if it passes zero within the piece
    move(std::next(piece)->velocity, piece->position - 0.5 * piece->velocity * piece->velocity / piece->acceleration);
  }
  return longest;
}

double Profile::path(double from, double to) const {
  double length = 0.0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const double begin = std::max(from, piece.start), end = i + 1 < pieces_.size() ? std::min(to, pieces_[i + 1].start) : to;
    if (!(begin < end)) continue;
    const double turn =
        piece.acceleration == 0.0 ? end : std::clamp(piece.start - piece.velocity / piece.acceleration, begin, end);
    length += std::abs(at(turn).position - at(begin).position) + std::abs(at(end).position - at(turn).position);
  }
  return length;
}

// A time of t covers at most v t, and from or to rest at most a t^2/2 at the acceleration a.
double Profile::time_of_path(double length, bool from_rest) const {
  const double at_speed = length / top_speed();
  double acceleration = 0.0;
  for (auto piece = pieces_.begin() + 1; piece != pieces_.end(); ++piece) {
    const bool jumps = std::prev(piece)->acceleration == 0.0 && piece->acceleration == 0.0;
    acceleration = jumps ? std::numeric_limits<double>::infinity() : std::max(acceleration, std::abs(piece->acceleration));
  }
  return from_rest ? std::max(at_speed, std::sqrt(2.0 * length / acceleration)) : at_speed;
}

ProfilePoint Profile::at(double t) const {
  auto piece = pieces_.end() - 1;
  while (t < piece->start) --piece;
  const double since = piece->velocity == 0.0 && piece->acceleration == 0.0 ? 0.0 : t - piece->start;
  return {piece->position + since * (piece->velocity + 0.5 * piece->acceleration * since),
          piece->velocity + piece->acceleration * since};
}

ProfilePoint descent(double t, double start, double time) {
  if (t <= start) return {0.0, 0.0};
  if (t >= start + time) return {1.0, 0.0};
  const double s = (t - start) / time;
  return {s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / time};
}

}  // namespace slipbench
