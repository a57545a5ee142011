#include "sim/effects/stick_slip.h"

#include <algorithm>
#include <limits>

namespace slipbench {
namespace {

using Vector = Eigen::Vector2d;

// Speeds below this share of the speeds that occur are rounding errors.
constexpr double negligible = 1e-9;

// A stretch beyond the cone by less than this [m] is rounding of coordinates
// (kernel::shortest_slip).
constexpr double shortest_slip = 1e-13;

// After this many stops inside one piece the tip stands for the rest of it. No known motion reaches
// this limit.
constexpr int most_stops = 32;

double between(const double (&ends)[2], double fraction) { return ends[0] + fraction * (ends[1] - ends[0]); }

// One coordinate of a free oscillator whose root moves: the speed of the tip is root - x'.
struct Line {
  Oscillator oscillator;
  double x, rate, root;  // m, m/s, m/s

  struct At {
    double speed, slope, bend;  // of the tip: m/s, m/s2, m/s3
  };
  [[nodiscard]] At now() const {
    const double pull = oscillator.acceleration(x, rate);
    return {root - rate, -pull, -oscillator.acceleration(rate, pull)};
  }
  [[nodiscard]] At at(double time) const {
    const Propagator moved = propagator(oscillator, time);
    return Line{oscillator, moved.position(x, rate), moved.speed(x, rate), root}.now();
  }
};

// Returns the time at which the tip's speed falls through zero, between `from`, where it is
// positive, and `to`, where it is not. Halley's steps from `guess`, bracketed by bisection.
double falls_to_zero(const Line& line, double from, double to, double guess) {
  double time = guess > from && guess < to ? guess : 0.5 * (from + to);
  for (int step = 0; step < 100; ++step) {
    const Line::At now = line.at(time);
    (now.speed > 0.0 ? from : to) = time;
    double next = time - 2.0 * now.speed * now.slope / (2.0 * now.slope * now.slope - now.speed * now.bend);
    if (!(next >= from && next <= to)) next = 0.5 * (from + to);
    if (std::abs(next - time) <= 1e-15 * to) return next;
    time = next;
  }
  return time;
}

// Returns the time between 0 and `to` at which the slope changes its sign.
double turn_time(const Line& line, double to) {
  const bool rises = line.now().slope > 0.0;
  double low = 0.0, high = to;
  for (int bit = 0; bit < 52; ++bit) {
    const double middle = 0.5 * (low + high);
    ((line.at(middle).slope > 0.0) == rises ? low : high) = middle;
  }
  return high;
}

// Returns the time within `time` at which the tip's speed along the line falls below zero by more
// than `floor`; infinity if it never does. The speed starts positive, or at zero and rising, and
// has at most one extremum within `time`.
double stop_time(const Line& line, double time, double floor) {
  const Line::At start = line.now(), end = line.at(time);
  if (end.speed < -floor) {
    const double from = start.speed > floor ? 0.0 : turn_time(line, time);
    return falls_to_zero(line, from, time, time * start.speed / (start.speed - end.speed));
  }
  if (start.slope < 0.0 && end.slope > 0.0) {  // it dips
    const double low = turn_time(line, time);
    if (line.at(low).speed < -floor) return falls_to_zero(line, 0.0, low, 0.5 * low);
  }
  return std::numeric_limits<double>::infinity();
}

class Step {
 public:
  Step(const TipLaw& law, const TipDrive& drive, std::uint32_t element, Tip& tip, TipTrace& trace,
       std::vector<ElementEvent>& events)
      : law_(law), drive_(drive), element_(element), tip_(tip), trace_(trace), events_(events) {}

  void run() {
    const bool touched = tip_.state != ElementState::detached, touches = drive_.f_normal[1] > 0.0;
    double change = 1.0;
    if (touched != touches) {
      change = std::clamp(drive_.f_normal[0] / (drive_.f_normal[0] - drive_.f_normal[1]), 0.0, 1.0);
    }
    touched ? rub(change) : fly(change);
    if (touched == touches) return;
    become(touched ? ElementState::detached : standing() && holds() ? ElementState::stick : ElementState::slip);
    touches ? rub(1.0) : fly(1.0);
  }

 private:
  [[nodiscard]] Vector stretch() const { return drive_.root_at(now_) - tip_.place; }
  [[nodiscard]] Vector force_of_stick() const { return law_.k * stretch() + law_.dashpot() * drive_.speed; }
  [[nodiscard]] double load(double fraction) const { return std::max(0.0, between(drive_.f_normal, fraction)); }
  [[nodiscard]] double limit(double fraction) const { return std::max(0.0, between(drive_.limit, fraction)); }
  [[nodiscard]] bool holds() const { return force_of_stick().norm() <= limit(now_) + law_.k * shortest_slip; }
  [[nodiscard]] double floor() const {
    return negligible * (drive_.speed.norm() + tip_.speed.norm() + law_.oscillator.omega * stretch().norm());
  }
  [[nodiscard]] bool standing() const { return tip_.speed.norm() <= floor(); }

  void become(ElementState state) {
    events_.push_back({now_, element_, tip_.state, state});
    tip_.state = state;
  }

  // Moves freely under constant friction up to `until`.
  void swing(const Vector& friction, double until) {
    const Propagator moved = propagator(law_.oscillator, (until - now_) * drive_.dt);
    const Vector rest = friction / law_.k, x = stretch() - rest, rate = drive_.speed - tip_.speed;
    const Vector x_then = moved.xx * x + moved.xv * rate, rate_then = moved.vx * x + moved.vv * rate;
    now_ = until;
    tip_.place = drive_.root_at(now_) - (x_then + rest);
    tip_.speed = drive_.speed - rate_then;
  }

  void fly(double until) {
    swing({0.0, 0.0}, until);
    trace_.friction.setZero();
  }

  void rub(double until) {
    while (now_ < until) {
      const double end = std::min(until, now_ + drive_.longest);
      for (int stops = 0; now_ < end;) {
        if (tip_.state == ElementState::stick) {
          stand(end);
        } else if (stops == most_stops) {
          tip_.speed.setZero();
          now_ = end;
        } else {
          slide(end);
          ++stops;
        }
      }
    }
  }

  // Sticks until the force leaves the cone.
  void stand(double end) {
    const double start = now_, reach = limit(start), growth = limit(end) - reach;
    const Vector force = force_of_stick(), rise = law_.k * (end - start) * drive_.dt * drive_.speed;
    const double beyond = law_.k * shortest_slip;
    now_ = end;
    if (force.norm() <= reach + beyond && holds()) {
      tip_.speed.setZero();
      trace_.friction = force_of_stick();
      return;
    }
    // |force + t rise|^2 = (reach + t growth)^2: negative at t = 0, positive at 1.
    const double a = rise.squaredNorm() - growth * growth, b = force.dot(rise) - reach * growth,
                 c = force.squaredNorm() - reach * reach;
    const double root = std::sqrt(std::max(0.0, b * b - a * c));
    const double share = c >= 0.0 ? 0.0 : b > 0.0 ? -c / (b + root) : (root - b) / a;
    now_ = start + std::clamp(share, 0.0, 1.0) * (end - start);
    tip_.speed.setZero();
    breaks_away_ = true;
    become(ElementState::slip);
  }

  // Slips until `end`, or until it has no speed along the direction of slip.
  void slide(double end) {
    const double slow = floor();
    const bool begins = tip_.speed.norm() <= slow;
    if (begins) {
      tip_.speed.setZero();
      if (!breaks_away_ && holds()) return stick();
    }
    breaks_away_ = false;
    const Vector drags = begins ? force_of_stick() : tip_.speed;
    const Vector along = drags.normalized();
    const double time = (end - now_) * drive_.dt;
    double friction = drive_.mu_kinetic * 0.5 * (load(now_) + load(end));
    // at rest, friction is at most the driving force
    if (begins) friction = std::min(friction, drags.norm());
    const Vector start = tip_.place;
    const Line line{law_.oscillator, along.dot(stretch()) - friction / law_.k, along.dot(drive_.speed - tip_.speed),
                    along.dot(drive_.speed)};
    const double stop = stop_time(line, time, slow);
    const bool stops = stop < time;
    swing(friction * along, stops ? now_ + stop / drive_.dt : end);
    const Vector way = tip_.place - start;
    trace_.slip += way;
    trace_.path += way.norm();
    trace_.friction = drive_.mu_kinetic * load(now_) * along;
    if (!stops) return;
    tip_.speed -= along.dot(tip_.speed) * along;
    if (tip_.speed.norm() > std::max(slow, friction * time * law_.oscillator.omega * law_.oscillator.omega / law_.k)) return;
    tip_.speed.setZero();
    if (holds()) return stick();
    breaks_away_ = true;
  }

  void stick() {
    become(ElementState::stick);
    trace_.friction = force_of_stick();
  }

  const TipLaw& law_;
  const TipDrive& drive_;
  std::uint32_t element_;
  Tip& tip_;
  TipTrace& trace_;
  std::vector<ElementEvent>& events_;
  double now_ = 0.0;          // share of the step
  bool breaks_away_ = false;  // stands, but friction cannot hold it
};

}  // namespace

void move_tip(const TipLaw& law, const TipDrive& drive, std::uint32_t element, Tip& tip, TipTrace& trace,
              std::vector<ElementEvent>& events) {
  Step(law, drive, element, tip, trace, events).run();
}

}  // namespace slipbench
