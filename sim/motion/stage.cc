#include "sim/motion/motion_catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/motion/hand_processes.h"
#include "sim/motion/profile.h"
#include "sim/motion/straight_path.h"

namespace slipbench {
namespace {

// The bench on which the published PapillArray sequences were recorded.
constexpr const char* protocol = "Wang et al., IEEE RA-L 9 (2024) 1827: hexapod protocol";

// The ranges exceed any real bench: a number outside is a typing error.
Entry stage_entry() {
  return {
      "stage",
      "A stage presses the pad onto the surface, waits, then slides and/or turns it; it may stop, reverse and lift off.",
      "height: trapezoid from +gap to -compression, measured at the tip of the tallest element; `clearance` raises both ends\n"
      "sideways: p(t) = pivot + s(t) [cos direction, sin direction] - R(theta(t)) pivot, s and theta trapezoids\n"
      "The pad moves along `direction`; the friction on the pad points the other way. The pivot moves along with the pad.\n"
      "`travel` and `stop` both end the sideways motion: `travel` by distance, `stop` by time.\n"
      "rocking: the pad tilts by rocking (p_1, p_2) about its X and Y axes through its origin, and rises by heave p_3.\n"
      "p: Gaussian processes of mean 0 and variance 1, white noise through two equal low-pass filters of rocking_corner.\n"
      "vibration: the motors shake the frame, which exerts a force on every unit of the pad, along the pad's normal.\n"
      "The motor of an axis that moves at v exerts a force with the mean square (1.6 mN level)^2 v/(10 mm/s) on the frame: half\n"
      "of it in lines at 1, 2, 8, 24, 50, 100, 200 times v/lead, half in noise with one pole at 200 v/lead.\n"
      "The frame multiplies this force by the sum of s^2/(s^2 + 2 zeta w s + w^2) over its modes, which are at 75, 130, 215, 330\n"
      "and 520 Hz with damping ratios of 0.03 to 0.05. ln(level) has the standard deviation vibration_sd between recordings.\n"
      "From idle_start on, an idle axis adds the force of an axis that moves at idle_speed. Motors that hold their position\n"
      "always add the noise, without the lines, of an axis that moves at rest_speed.",
      "Wang et al., IEEE RA-L 9 (2024) 1827 (protocol); constant accelerations, integrated exactly",
      {
          number_spec("compression", Quantity::length, "1 mm", positive_up_to(0.1), "How far the tallest element is pressed in.",
                      protocol),
          number_spec("speed", Quantity::speed, "4 mm/s", {0.0, 10.0}, "Sideways speed of the pivot.",
                      protocol + std::string(", 0.5 to 16 mm/s")),
          number_spec("direction", Quantity::angle, "0 deg", any_value,
                      "Direction in which the pad moves, from +X towards +Y of the pad.", protocol),
          number_spec("rotation", Quantity::angular_speed, "0 deg/s", {-100.0, 100.0},
                      "Turning speed about the vertical through the pivot.", protocol),
          vector_spec(2, "pivot", Quantity::length, "[0 mm, 0 mm]", {-1.0, 1.0}, "Point of the pad about which the pad turns.",
                      "assumed"),
          vector_spec(2, "tilt", Quantity::angle, "[0 deg, 0 deg]", {-0.5, 0.5},
                      "Tilt of the pad about its X and Y axes, constant throughout.",
                      "assumed; the memories learnt from the published sequences do not use the tilt (scenes/papillarray)"),
          number_spec("acceleration", Quantity::acceleration, "50 mm/s2", positive_or_infinite,
                      "Limit for all linear motions; inf: speeds change at once.",
                      "assumed; about 40 mm/s2 fits the published sequences"),
          number_spec("angular_acceleration", Quantity::angular_acceleration, "500 deg/s2", positive_or_infinite,
                      "Limit for rotation; inf: the angular speed changes at once.", "assumed"),
          number_spec("gap", Quantity::length, "0.5 mm", {0.0, 0.1},
                      "Height of the pad's origin, the tallest tip, above the surface at t = 0.", "assumed"),
          number_spec("approach_speed", Quantity::speed, "4 mm/s", positive_up_to(10.0), "Speed of pressing and of lifting off.",
                      "assumed"),
          number_spec("start", Quantity::time, "2 s", non_negative, "Time at which the pad begins to slide and to rotate.",
                      "published sequences: motion starts at about 2.0 s"),
          number_spec("stop", Quantity::time, "inf", positive_or_infinite,
                      "Time after the start at which the pad brakes; inf: never.",
                      "published stop trials halt 50 to 100 ms after the start"),
          number_spec("travel", Quantity::length, "inf", positive_or_infinite,
                      "Length of the sideways motion, after which the pad rests; inf: `stop` decides.", "set for each scene"),
          integer_spec("strokes", "1", {1.0, 100.0}, "Number of strokes of length `travel`, alternately there and back.",
                       "set for each scene"),
          number_spec("reverse", Quantity::time, "inf", positive_or_infinite,
                      "Time after the start at which the pad turns back; inf: never.", "assumed"),
          number_spec("retract", Quantity::time, "inf", positive_or_infinite,
                      "Time at which the pad lifts off by compression + gap; inf: never.", "assumed"),
          number_spec("clearance", Quantity::length, "0 mm", {0.0, 0.1},
                      "Height added to the whole motion; above `compression` the pad touches nothing.", "set for each scene"),
          vector_spec(2, "rocking", Quantity::angle, "[0 deg, 0 deg]", {0.0, 0.2},
                      "Standard deviation of a slow random tilt about the pad's X and Y axes, added to `tilt`.",
                      "0: a rigid stage; about 1 deg fits a BioTac SP that is held still (scenes/learn)"),
          number_spec("heave", Quantity::length, "0 mm", {0.0, 0.01}, "Standard deviation of a slow random change of the height.",
                      "0: a rigid stage"),
          number_spec("rocking_corner", Quantity::frequency, "0.12 Hz", {0.01, 20.0},
                      "Corner frequency of each low pass of `rocking` and `heave`.", "fitted: rest of `rub` in scenes/biotac_sp"),
          number_spec("vibration", Quantity::none, "0", non_negative, "Level of the motors' vibration; 0: none.",
                      "0: no vibration; levels of 1 to 4 resemble the published piezoelectric recordings, assumed"),
          number_spec("vibration_sd", Quantity::none, "0.1", fraction,
                      "Standard deviation of ln(level) from one recording to the next.",
                      "assumed: all recordings are of one machine and resemble each other"),
          number_spec("vibration_in_contact", Quantity::none, "1.6", non_negative,
                      "Factor on the vibration while the pad touches something.",
                      "assumed: in contact the bench also transmits the vibration through the object"),
          vector_spec(3, "lead", Quantity::length, "[8 mm, 8 mm, 4 mm]", {1e-4, 0.1},
                      "Distance that each axis X, Y, Z of the bench moves in one turn of its spindle.",
                      "assumed: usual leads of ball screws"),
          number_spec("idle_speed", Quantity::speed, "0 mm/s", {0.0, 10.0},
                      "Speed of another axis that does not carry the pad; only its motor's vibration reaches the pad.",
                      "set for each scene, for recordings of running motors without a slide"),
          number_spec("idle_start", Quantity::time, "0 s", non_negative,
                      "Time at which that axis starts; it then runs until the end.", "set for each scene"),
          number_spec(
              "rest_speed", Quantity::speed, "0 mm/s", {0.0, 10.0},
              "Noise of all motors that hold their position: speed of a moving axis with the same noise, scaled by `vibration`; 0: silent at rest.",
              "0: silent; 1 to 3 mm/s at level 2 fit the mean spectrum of a real piezoelectric skin"),
      }};
}

// Throws SceneValueError if settings of the sideways motion contradict each other.
void check_sideways(const Parameters& p) {
  const double stop = p.number("stop"), reverse = p.number("reverse"), travel = p.number("travel"), speed = p.number("speed");
  if (reverse >= stop && std::isfinite(reverse)) {
    throw SceneValueError("motion.reverse",
                          fmt::format("{} comes after motion.stop ({}); it must be earlier",
                                      format_quantity(reverse, Quantity::time), format_quantity(stop, Quantity::time)));
  }
  if (!std::isfinite(travel)) {
    if (p.integer("strokes") == 1) return;
    throw SceneValueError("motion.strokes",
                          fmt::format("{} strokes need a length: set motion.travel, or use 1 stroke", p.integer("strokes")));
  }
  if (p.number("rotation") != 0.0) {
    throw SceneValueError("motion.rotation",
                          "motion.travel ends the sideways motion but not the rotation; with motion.travel it must be 0 deg/s");
  }
  if (std::isfinite(stop) || std::isfinite(reverse) || speed == 0.0) {
    throw SceneValueError(
        "motion.travel",
        format_quantity(travel, Quantity::length) +
            (speed == 0.0 ? " is never reached at motion.speed 0; set a speed"
                          : " cannot be combined with motion.stop or motion.reverse, since both end the motion"));
  }
}

class Stage final : public Motion {
 public:
  Stage(const Parameters& p, const MotionKey& key)
      : height_(p.number("gap") + p.number("clearance")),
        way_(0.0),
        turn_(0.0),
        pivot_(p.vector("pivot")[0], p.vector("pivot")[1], 0.0),
        direction_(math::cos(p.number("direction")), math::sin(p.number("direction")), 0.0),
        tilt_(rotation_by_axes({p.vector("tilt")[0], p.vector("tilt")[1], 0.0})),
        rocking_{p.vector("rocking")[0], p.vector("rocking")[1]},
        heave_(p.number("heave")) {
    if (rocks(p)) {
      processes_.emplace(HandProcesses::Settings{.corner = p.number("rocking_corner"),
                                                 .warp_corner = p.number("rocking_corner"),
                                                 .warp = 0.0,
                                                 .drive = 0.0,
                                                 .begin = 0.0,
                                                 .rise = HandProcesses::knot,
                                                 .rest = 1.0},
                         key, "motion.stage");
    }
    const double acceleration = p.number("acceleration"), angular = p.number("angular_acceleration");
    const double speed = p.number("speed"), rate = p.number("rotation");
    const double start = p.number("start"), stop = p.number("stop"), reverse = p.number("reverse"), retract = p.number("retract");
    const double stroke = p.number("gap") + p.number("compression");

    height_.move(0.0, -stroke, p.number("approach_speed"), acceleration);
    pressed_ = height_.end();
    start_ = start;
    retract_ = retract;
    touches_ = p.number("clearance") < p.number("compression");
    refuse_early("motion.start", start, height_.end());
    check_sideways(p);
    const bool has_travel = std::isfinite(p.number("travel"));
    if (has_travel) {
      const double travel = p.number("travel");
      for (std::int64_t stroke = 0; stroke < p.integer("strokes"); ++stroke) {
        way_.move(stroke == 0 ? start : way_.end(), stroke % 2 == 0 ? travel : -travel, speed, acceleration);
      }
    }
    for (const auto& [profile, top, limit] : {std::tuple{&way_, speed, acceleration}, std::tuple{&turn_, rate, angular}}) {
      if (profile == &way_ && has_travel) continue;
      profile->change_velocity(start, top, limit);
      if (std::isfinite(reverse)) profile->change_velocity(start + reverse, -top, limit);
      if (std::isfinite(stop)) profile->change_velocity(start + stop, 0.0, limit);
    }
    if (std::isfinite(retract)) {
      if (retract < start) {
        throw SceneValueError("motion.retract",
                              fmt::format("{} comes before motion.start ({}); it must be later",
                                          format_quantity(retract, Quantity::time), format_quantity(start, Quantity::time)));
      }
      height_.move(retract, stroke, p.number("approach_speed"), acceleration);
    }
    if (const double level = p.number("vibration"); level > 0.0) {
      const std::vector<double>& lead = p.vector("lead");
      motors_ = {level,
                 p.number("vibration_sd"),
                 p.number("vibration_in_contact"),
                 {lead[0], lead[1], lead[2]},
                 p.number("idle_speed"),
                 p.number("idle_start"),
                 p.number("rest_speed")};
    }
  }

  // True if the motion draws random numbers.
  static bool rocks(const Parameters& p) {
    return p.vector("rocking")[0] > 0.0 || p.vector("rocking")[1] > 0.0 || p.number("heave") > 0.0;
  }

  [[nodiscard]] BodyState pad_at(double t) const override {
    const ProfilePoint height = height_.at(t);
    const ProfilePoint way = way_.at(t);
    BodyState pad;
    pad.pose.rotation = tilt_;
    ProcessPoint lift;
    if (processes_) {
      const ProcessPoint x = processes_->at(HandProcesses::along, t), y = processes_->at(HandProcesses::around, t),
                         z = processes_->at(HandProcesses::load, t);
      const Eigen::Matrix3d about_y = rotation_about(Eigen::Vector3d::UnitY(), rocking_[1] * y.value);
      pad.pose.rotation = about_y * rotation_about(Eigen::Vector3d::UnitX(), rocking_[0] * x.value) * tilt_;
      pad.angular_velocity = rocking_[1] * y.rate * Eigen::Vector3d::UnitY() + rocking_[0] * x.rate * about_y.col(0);
      lift = {heave_ * z.value, heave_ * z.rate};
    }
    pad.pose.position = way.position * direction_;
    pad.velocity = way.velocity * direction_;
    if (turns()) {
      const ProfilePoint turn = turn_.at(t);
      const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), turn.position);
      const Eigen::Vector3d arm = turned * -pivot_;
      const Eigen::Vector3d turning(0.0, 0.0, turn.velocity);
      pad.pose.rotation = turned * pad.pose.rotation;
      pad.pose.position += pivot_ + arm;
      pad.angular_velocity = turning + turned * pad.angular_velocity;
      pad.velocity += turning.cross(arm);
    }
    pad.pose.position.z() = height.position + lift.value;
    pad.velocity.z() = height.velocity + lift.rate;
    return pad;
  }

  [[nodiscard]] double top_speed(double reach) const override {
    const double rate = processes_ ? processes_->top_rate() : 0.0;
    return height_.top_speed() + way_.top_speed() + turn_.top_speed() * (reach + pivot_.norm()) +
           rate * (heave_ + (rocking_[0] + rocking_[1]) * reach);
  }

  [[nodiscard]] double longest_step() const override {
    return std::min({processes_ ? HandProcesses::knot : std::numeric_limits<double>::infinity(), step_per_turn(turn_.top_speed()),
                     way_.step_per_reversal(), turn_.step_per_reversal(), step_per_touch(), step_between_heights(way_),
                     step_between_heights(turn_)});
  }

  [[nodiscard]] bool turns() const override { return !turn_.at_rest_always(); }
  [[nodiscard]] std::optional<MotorSettings> motors() const override { return motors_; }

 private:
  // Returns the longest step that does not contain both the touch of the tallest element and its
  // lift-off.
  [[nodiscard]] double step_per_touch() const {
    if (!touches_ || !std::isfinite(retract_)) return std::numeric_limits<double>::infinity();
    // The way up mirrors the way down: the tip at z = 0 is as long before `pressed_` as after
    // `retract_`.
    double high = 0.0, low = pressed_;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (high + low);
      (height_.at(middle).position > 0.0 ? high : low) = middle;
    }
    return retract_ - pressed_ + 2.0 * (pressed_ - high);
  }

  // Returns the longest step that loses at most largest_loss of the path that the pad slides or
  // turns in contact. An element that touches within a step is anchored at the end of that step, and
  // one that lifts off within a step slips no more in it. A step that contains the end of the press
  // and the start of the slide loses the part of the slide that is within it, as does one that
  // contains the end of the slide and the lift.
  [[nodiscard]] double step_between_heights(const Profile& slide) const {
    // A motion without an end counts for this time: a motion does not know the scene's duration.
    constexpr double counted = 1.0;  // s
    if (!touches_ || slide.at_rest_always()) return std::numeric_limits<double>::infinity();
    const bool lifts = std::isfinite(retract_);
    const double lost = largest_loss * slide.path(start_, lifts ? height_.end() : std::max(slide.end(), start_ + counted));
    if (!(lost > 0.0)) return std::numeric_limits<double>::infinity();
    double longest = start_ - pressed_ + slide.time_of_path(lost, true);
    if (lifts) {
      const bool rests = slide.end() <= retract_ && slide.at(retract_).velocity == 0.0;
      longest = std::min(longest, (rests ? retract_ - slide.end() : 0.0) + slide.time_of_path(lost, rests));
    }
    return longest;
  }

  Profile height_, way_, turn_;
  double pressed_ = 0.0, start_ = 0.0, retract_ = 0.0;  // s: end of the press, start of slide and turn, start of the lift
  bool touches_ = true;
  Eigen::Vector3d pivot_, direction_;
  Eigen::Matrix3d tilt_;
  std::array<double, 2> rocking_;  // rad
  double heave_;                   // m
  std::optional<HandProcesses> processes_;
  std::optional<MotorSettings> motors_;
};

}  // namespace

MotionKind stage_motion() {
  MotionKind kind = motion_kind<Stage>(stage_entry());
  kind.is_random = Stage::rocks;
  return kind;
}

}  // namespace slipbench
