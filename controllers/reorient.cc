#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "controllers/controller_kinds.h"
#include "controllers/grip.h"
#include "sim/core/error.h"

namespace slipbench::controllers {
namespace {

enum Quantities : std::size_t { fl, fr, fr_fast, normal, moment, quantities };  // counts, counts, counts, N, N m

// The features of an estimate that the algorithms read.
class Features {
 public:
  explicit Features(const std::vector<Feature>& handed_on) {
    for (std::size_t k = 0; k < quantities; ++k) {
      const auto found = std::ranges::find(handed_on, names[k], &Feature::name);
      if (found == handed_on.end()) {
        throw SceneValueError("controller.type",
                              std::string("'reorient' needs the feature '") + names[k] +
                                  "', which the scene's detector does not provide; use a detector of the nib pad");
      }
      places_[k] = static_cast<std::size_t>(found - handed_on.begin());
    }
  }

  // NaN before the detector's first estimate; all comparisons with it are then false.
  [[nodiscard]] double in(const SlipEstimate& slip, Quantities quantity) const {
    return slip.features.empty() ? std::numeric_limits<double>::quiet_NaN() : slip.features[places_[quantity]];
  }

 private:
  static constexpr std::array<const char*, quantities> names{"fl_0_6", "fr_0_6", "fr_6_8", "normal", "moment"};
  std::array<std::size_t, quantities> places_{};
};

// Sum of the counts of FL's and FR's four clusters.
class Clusters {
 public:
  explicit Clusters(const std::vector<Channel>& channels) {
    for (const Channel& channel : channels) {
      for (std::size_t k = 0; k < names.size(); ++k) {
        if (channel.name == names[k] && channel.size() == 2) places_[k] = frame_size_, found_[k] = true;
      }
      frame_size_ += channel.size();
    }
    if (!found_[0] || !found_[1]) {
      throw SceneValueError("controller.type", "'reorient' needs the channels 'fl' [2] and 'fr' [2] of the sensor nib_pad");
    }
  }

  [[nodiscard]] double sum(const SensorFrame& frame) const {
    if (frame.values.size() != frame_size_) throw std::logic_error("a controller received a frame of another size");
    double sum = 0.0;
    for (const std::size_t place : places_) sum += double{frame.values[place]} + double{frame.values[place + 1]};
    return sum;
  }

 private:
  static constexpr std::array<const char*, 2> names{"fl", "fr"};
  std::array<std::size_t, names.size()> places_{};
  std::array<bool, names.size()> found_{};
  std::size_t frame_size_ = 0;  // values of a whole frame
};

class Reorient final : public Controller {
 public:
  Reorient(const Parameters& p, const GripSource& source)
      : clusters_(source.channels),
        features_(source.features),
        tare_time_(p.number("tare_time")),
        contact_(p.number("contact")),
        adjust_speed_(p.number("adjust_speed")),
        midpoint_(p.number("midpoint")),
        fl_slip_(p.number("fl_slip")),
        settle_(p.number("settle")),
        turn_speed_(p.number("turn_speed")),
        target_(p.number("target")),
        fr_slip_(p.number("fr_slip")),
        fr_upright_(p.number("fr_upright")),
        fr_quiet_(p.number("fr_quiet")),
        forward_(p.number("forward")),
        release_wait_(p.number("release_wait")),
        released_normal_(p.number("released_normal")),
        released_moment_(p.number("released_moment")),
        command_(registers_of(p)) {
    if (!source.guided)
      throw SceneValueError("controller.type", "'reorient' commands the arm, so the scene needs motion.kind: guided");
  }

  GripCommand update(const ControlInput& input) override {
    const double now = input.gripper.time;
    height_ += arm_.up * (now - time_);
    time_ = now;
    switch (phase_) {
      case Phase::start: start(input); break;
      case Phase::touch: touch(input); break;
      case Phase::adjust: adjust(input.slip); break;
      case Phase::turn: turn(input.slip); break;
      case Phase::release: release(input.slip); break;
      case Phase::done: break;
    }
    command_.position = position_;
    command_.arm = arm_;
    return command_;
  }

 private:
  enum class Phase { start, touch, adjust, turn, release, done };

  void enter(Phase phase, const ArmCommand& arm) {
    phase_ = phase;
    arm_ = arm;
    wait_until_ = time_ + settle_;
  }
  void change_grip(int counts, double wait) {
    position_ = moved(position_, counts);
    wait_until_ = time_ + wait;
  }

  // Averages the counts without contact.
  void start(const ControlInput& input) {
    position_ = input.gripper.position;
    if (input.frame.values.empty()) return;  // no values before the first whole sample
    rest_ += clusters_.sum(input.frame);
    ++rests_;
    if (time_ < tare_time_) return;
    rest_ /= rests_;
    enter(Phase::touch, {});
  }

  void touch(const ControlInput& input) {
    if (clusters_.sum(input.frame) - rest_ > contact_) {
      position_ = input.gripper.position;
      enter(Phase::adjust, {.sideways = 0.0, .up = adjust_speed_});
    } else {
      position_ = moved(input.gripper.position, 1);
    }
  }

  void adjust(const SlipEstimate& slip) {
    if (height_ >= midpoint_) return enter(Phase::turn, {.sideways = 0.0, .up = turn_speed_});
    if (time_ >= wait_until_ && features_.in(slip, fl) > fl_slip_) change_grip(1, settle_);
  }

  void turn(const SlipEstimate& slip) {
    if (height_ >= target_) return enter(Phase::release, {.sideways = forward_, .up = 0.0});
    const bool settled = time_ >= wait_until_;
    if (settled && features_.in(slip, fr_fast) > fr_upright_) return enter(Phase::release, {.sideways = forward_, .up = 0.0});
    if (!settled || !(features_.in(slip, fr) < fr_slip_)) {
      turned_ = time_;
    } else if (time_ >= turned_ + fr_quiet_) {
      change_grip(-1, settle_);
    }
  }

  void release(const SlipEstimate& slip) {
    if (features_.in(slip, normal) < released_normal_ && std::abs(features_.in(slip, moment)) < released_moment_) {
      position_ = 0;
      return enter(Phase::done, {});
    }
    if (time_ >= wait_until_) change_grip(-1, release_wait_);
  }

  Clusters clusters_;
  Features features_;
  double tare_time_, contact_;                         // s, counts
  double adjust_speed_, midpoint_, fl_slip_, settle_;  // m/s, m, counts, s
  double turn_speed_, target_, fr_slip_, fr_upright_;  // m/s, m, counts, counts
  double fr_quiet_;                                    // s
  double forward_, release_wait_;                      // m/s, s
  double released_normal_, released_moment_;           // N, N m
  GripCommand command_;

  Phase phase_ = Phase::start;
  ArmCommand arm_;                        // last command
  double time_ = 0.0, wait_until_ = 0.0;  // s
  double turned_ = 0.0;                   // s, when the box last may have turned
  double height_ = 0.0;                   // m, commanded rise of the arm
  double rest_ = 0.0;                     // counts; a sum until the tare is done
  int rests_ = 0;
  int position_ = 0;  // counts
};

}  // namespace

ControllerKind reorient() {
  constexpr const char* not_printed = "assumed: the paper prints no value";
  return {
      {"reorient",
       "Turns a box upright by rotational slip and puts it down: touch, adjust (Algorithm 2), turn (Algorithm 3), gentle release.",
       "start: for `tare_time` the controller averages the sum of FL's and FR's clusters at rest\n"
       "touch: one count tighter at a time, until the sum has grown by more than `contact`\n"
       "adjust: the arm rises at `adjust_speed` to `midpoint`. FL 0-6 Hz > fl_slip: one count tighter, then a wait of `settle`\n"
       "turn: the arm rises at `turn_speed` to `target`. FR 0-6 Hz < fr_slip for `fr_quiet` without a break: one count looser, then a wait of `settle`. FR 6-8 Hz > fr_upright: the box is upright, since theta' = v/(l cos theta) grows without bound, and the phase ends\n"
       "release: the arm moves sideways at `forward`, and the fingers open by one count every `release_wait`, until normal force and torsional moment are below released_normal and released_moment. Then the fingers open to their stop and the arm stops.\n"
       "Magnitudes, force and moment are the detector's features fl_0_6, fr_0_6, fr_6_8, normal, moment. Heights are the commanded ones. Each phase begins with a wait of `settle`, while the window of the spectra still holds the phase before.",
       "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, IEEE RA-L 2020, section VI, Algorithms 2 and 3. The paper reads the pads of both fingers; here one pad has a sensor",
       with_registers(
           {number_spec("tare_time", Quantity::time, "0.2 s", non_negative, "Time at the start in which the controller tares.",
                        "assumed"),
            number_spec("contact", Quantity::none, "30", non_negative,
                        "CONTACT_THRES, counts: increase of the sum above which the pad touches.",
                        "assumed: 42 electrodes of four nibs at 24 counts a newton, for 1.2 N; the paper gives no value"),
            number_spec(
                "adjust_speed", Quantity::speed, "5 mm/s", positive, "Speed of the arm in the phase adjust.",
                "published: 2 to 5 mm/s. The upper end, because at 3 mm/s the nibs creep at 0.2 mm/s and their signal is below the noise. Chosen on seed 1: 57 of 77 boxes stand (50 with 3 mm/s); on seed 2, 22 of 24 (21 with 3 mm/s)"),
            number_spec("midpoint", Quantity::length, "20 mm", positive,
                        "MidPoint: height to which the arm rises in the phase adjust.", not_printed),
            number_spec("fl_slip", Quantity::none, "25", non_negative,
                        "FL_SLIP_THRES, counts, in the scale of the detector's spectrum.",
                        "assumed: above every window of a pad at rest, 10 +- 4 and at most 21 counts; the paper gives no value"),
            number_spec(
                "settle", Quantity::time, "0.8 s", non_negative, "TIME_SETTLE.",
                "assumed: a window of the spectra, 0.5 s, a hop, 0.1 s, and the gripper's 60 ms; the controller's own count has then left the window. Algorithm 3 prints no wait"),
            number_spec("turn_speed", Quantity::speed, "10 mm/s", positive, "Speed of the arm while the box turns.", "published"),
            number_spec(
                "target", Quantity::length, "135 mm", positive, "TargetPoint: largest height to which the arm rises.",
                "assumed: the distance from the edge to the grip. At 113 mm the grip of a box that has not slid in the hand is highest, but the box slides by 5 to 15 mm"),
            number_spec("fr_slip", Quantity::none, "25", non_negative, "FR_SLIP_THRES, counts; below it the box does not turn.",
                        "assumed: the bound of the noise, as of fl_slip; the paper gives no value"),
            number_spec(
                "fr_quiet", Quantity::time, "1 s", non_negative,
                "Time for which FR 0-6 Hz must stay below fr_slip after the last count before the grip is loosened.",
                "assumed: two windows of the spectra, one after the other. The paper prints no such time; its section IV-B says that single spectra show slip poorly, since its vibration comes and goes. The spectra of a box that turns at 10 mm/s are below 25 counts for a quarter of the time, but seldom for 1 s without a break"),
            number_spec(
                "fr_upright", Quantity::none, "250", non_negative, "FR_UPRIGHT_THRES, counts; above it the box is upright.",
                "assumed: reached in the last 15 degrees of a turn at constant grip. Earlier in the turn the magnitude is 10 to 50 counts, in single rearrangements 100 to 150. The paper gives no value"),
            number_spec("forward", Quantity::speed, "10 mm/s", any_value, "Sideways speed of the arm in the release.",
                        "assumed: the paper says forward"),
            number_spec("release_wait", Quantity::time, "0.2 s", non_negative, "Time between two counts of the release.",
                        "assumed"),
            number_spec(
                "released_normal", Quantity::force, "0.56 N", positive,
                "Calibrated normal force below which the pad counts as free.",
                "published: the RMS error of the calibrated force, Table I, uniform loads; the pad cannot resolve less. A box of 318 g that leans on one finger presses with up to 0.37 N"),
            number_spec("released_moment", Quantity::none, "1.3e-3", positive,
                        "Torsional moment below which the pad counts as free, N m.",
                        "published: the RMS error of the calibrated moment, Table I, uniform loads")})},
      created<Reorient>};
}

}  // namespace slipbench::controllers
