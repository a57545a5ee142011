#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "controllers/controllers.h"
#include "controllers/grip.h"
#include "sim/core/error.h"

namespace slipbench::controllers {
namespace {

// How many of the touching pillars stick, from two frames. A tip that sticks goes with the surface, so its displacement changes at the
// speed of the surface over the pad; one that slides keeps the displacement at which friction gave way.
class StuckPillars {
 public:
  StuckPillars(const Parameters& p, const std::vector<Channel>& channels)
      : force_(channels, "stuck_fraction"),
        displacement_(channels, "displacement", "stuck_fraction"),
        touch_(p.number("touch")),
        moving_(p.number("moving_speed")),
        share_(p.number("stuck_share")),
        last_(2 * displacement_.units()),
        speed_(displacement_.units()) {}

  // The estimate after `frame`. Frames of one and the same time are one frame.
  double update(const SensorFrame& frame) {
    if (frame.time > last_time_) {
      measure(frame);
      last_time_ = frame.time;
    }
    return stuck_;
  }

 private:
  void measure(const SensorFrame& frame) {
    double touching = 0.0, sticking = 0.0, fastest = 0.0;
    for (std::size_t i = 0; i < speed_.size(); ++i) {
      const UnitVector d = displacement_.unit(frame, i);
      speed_[i] = std::hypot(double{d[0]} - last_[2 * i], double{d[1]} - last_[2 * i + 1]) / (frame.time - last_time_);
      last_[2 * i] = d[0];
      last_[2 * i + 1] = d[1];
      if (touches(frame, i)) fastest = std::max(fastest, speed_[i]);
    }
    if (fastest < moving_) return;  // nothing moves, or everything slides: the tips alone do not say which
    for (std::size_t i = 0; i < speed_.size(); ++i) {
      if (!touches(frame, i)) continue;
      touching += 1.0;
      if (speed_[i] >= share_ * fastest) sticking += 1.0;
    }
    stuck_ = sticking / touching;
  }

  [[nodiscard]] bool touches(const SensorFrame& frame, std::size_t i) const { return force_.normal(frame, i) >= touch_; }

  GripForce force_;
  VectorChannel displacement_;
  double touch_, moving_, share_;
  std::vector<double> last_;                                     // [pillars][x, y] m
  std::vector<double> speed_;                                    // [pillars] m/s
  double last_time_ = -std::numeric_limits<double>::infinity();  // s; a first frame makes speeds of 0
  double stuck_ = 1.0;
};

class StuckFraction final : public Controller {
 public:
  StuckFraction(const Parameters& p, const GripSource& source)
      : force_(source.channels, "stuck_fraction"),
        preset_(source.preset),
        gain_(p.number("gain")),
        follower_(p),
        command_(registers_of(p)) {
    if (p.choice("estimate") == "frames") {
      pillars_.emplace(p, source.channels);
    } else if (!source.detected) {
      refuse_without_detector("stuck_fraction with estimate: detector");
    }
  }

  GripCommand update(const ControlInput& input) override {
    const double stuck = pillars_ ? pillars_->update(input.frame) : detected(input.slip);
    const double target = preset_ + gain_ * (1.0 - stuck);
    command_.position = follower_.toward(force_.total(input.frame), target, input.gripper.position);
    return command_;
  }

 private:
  static double detected(const SlipEstimate& slip) {
    if (slip.state == PadState::no_contact) return 1.0;
    if (std::isnan(slip.stuck_fraction)) {
      throw InputError("controller stuck_fraction: the detector tells no stuck fraction at t = " +
                       format_quantity(slip.time, Quantity::time) + "; allowed: a detector that does, or estimate: frames");
    }
    return slip.stuck_fraction;
  }

  GripForce force_;
  std::optional<StuckPillars> pillars_;  // empty: the detector tells
  double preset_, gain_;
  ForceFollower follower_;
  GripCommand command_;
};

}  // namespace

ControllerKind stuck_fraction() {
  return {
      {"stuck_fraction", "Grip force in proportion to the share of the touching pillars that do not stick.",
       "target = preset + gain (1 - s), s: stuck fraction, 1 until something moves\n"
       "estimate frames: v_i = |change of tangential displacement| / time between frames, of the pillars that touch; a pillar "
       "sticks "
       "when v_i >= stuck_share max v; while max v < moving_speed s keeps its value, so that a pad that lies still and one that "
       "slides as a whole are not told apart\n"
       "position = measured position + ceil((target - F)/force_per_count) counts while F < target, otherwise the last command\n"
       "F: sum of the pillars' normal forces. The position ends at 255 and stays there",
       "stick ratio as feedback: Ikeda et al., IROS 2004, and arXiv:2402.11879; estimate from tip speeds: assumed",
       with_registers({
           declared_choice("estimate", "frames", {"frames", "detector"},
                           "Where the stuck fraction comes from: the pillars' tips, or a detector that tells one.", "assumed"),
           declared("gain", ParameterType::number, Quantity::force, "12 N", non_negative,
                    "Grip force added to the preset when no pillar sticks.", "assumed"),
           declared("moving_speed", ParameterType::number, Quantity::speed, "0.5 mm/s", positive,
                    "Fastest tip below which the frames say nothing: several times the noise of 1 um over 20 ms.", "assumed"),
           declared("stuck_share", ParameterType::number, Quantity::none, "0.5", {.min = 0.0, .max = 1.0, .open_min = true},
                    "Share of the fastest tip's speed from which a pillar sticks.", "assumed"),
           touch_spec(),
           force_per_count_spec(),
           ceiling_spec(),
           loosen_spec(),
       })},
      [](const Parameters& p, const GripSource& source) -> std::unique_ptr<Controller> {
        return std::make_unique<StuckFraction>(p, source);
      }};
}

}  // namespace slipbench::controllers
