// One coordinate of a prescribed motion: pieces of constant acceleration, evaluated exactly.
#pragma once

#include <vector>

namespace slipbench {

// Position and velocity of one coordinate, in the caller's units (m and m/s, or rad and rad/s).
struct ProfilePoint {
  double position;
  double velocity;
};

// A trapezoidal profile under construction: starts at rest, and each call appends to it.
// Accelerations may be infinite: the velocity then jumps.
class Profile {
 public:
  explicit Profile(double position);

  // From time t on, changes the velocity to `velocity` with `acceleration` (> 0). Cuts short a
  // change under way at t.
  void change_velocity(double t, double velocity, double acceleration);

  // From time t on, moves from rest by `distance` and comes to rest, with at most `speed` (> 0) and
  // `acceleration` (> 0).
  void move(double t, double distance, double speed, double acceleration);

  // The same to the position `target`, also during a move: continues from the velocity at t, and
  // brakes first if that leads away from the target or past it.
  void move_to(double t, double target, double speed, double acceleration);

  // When the last change ends [s].
  [[nodiscard]] double end() const { return pieces_.back().start; }
  // Returns the largest speed ever reached.
  [[nodiscard]] double top_speed() const;
  // Returns the longest step [s] of which one that contains a reversal loses at most largest_loss
  // (straight_path.h) of the path since the reversal before; infinite without a reversal.
  [[nodiscard]] double step_per_reversal() const;
  // Returns the length of the path between two times [s], there and back counted both.
  [[nodiscard]] double path(double from, double to) const;
  // Returns the longest time [s] within which at most `length` of the path is covered, from any
  // instant on; with `from_rest`, from or to an instant of rest.
  [[nodiscard]] double time_of_path(double length, bool from_rest) const;
  [[nodiscard]] bool at_rest_always() const { return pieces_.size() == 1; }

  [[nodiscard]] ProfilePoint at(double t) const;

 private:
  struct Piece {
    double start, position, velocity, acceleration;
  };
  std::vector<Piece> pieces_;  // the last one has no acceleration and no end
};

// Progress of a descent that begins at `start` and takes `time` [s]: 3 s^2 - 2 s^3 with s the
// elapsed share of the time.
ProfilePoint descent(double t, double start, double time);

}  // namespace slipbench
