#include <cmath>

#include "controllers/controller_kinds.h"
#include "controllers/grip.h"
#include "sim/core/error.h"

namespace slipbench::controllers {
namespace {

class StuckFraction final : public Controller {
 public:
  StuckFraction(const Parameters& p, const GripSource& source)
      : force_(source.channels, "stuck_fraction"),
        preset_(source.preset),
        gain_(p.number("gain")),
        follower_(p),
        command_(registers_of(p)) {
    if (!source.detected) refuse_without_detector("stuck_fraction");
  }

  GripCommand update(const ControlInput& input) override {
    const double target = preset_ + gain_ * (1.0 - stuck(input.slip));
    command_.position = follower_.toward(force_.total(input.frame), target, input.gripper.position);
    return command_;
  }

 private:
  static double stuck(const SlipEstimate& slip) {
    if (slip.state == PadState::no_contact) return 1.0;
    if (std::isnan(slip.stuck_fraction)) {
      throw InputError("controller stuck_fraction: the detector tells no stuck fraction at t = " +
                       format_quantity(slip.time, Quantity::time) + "; allowed: a detector that does, such as stuck_fraction");
    }
    return slip.stuck_fraction;
  }

  GripForce force_;
  double preset_, gain_;
  ForceFollower follower_;
  GripCommand command_;
};

}  // namespace

ControllerKind stuck_fraction() {
  return {
      {"stuck_fraction", "Grip force in proportion to the share of the touching pillars that do not stick.",
       "target = preset + gain (1 - s), s: the detector's stuck fraction, 1 without contact\n"
       "position = measured position + ceil((target - F)/force_per_count) counts while F < target, otherwise the last command\n"
       "F: sum of the pillars' normal forces. The position ends at 255 and stays there. A detector without a stuck fraction is refused.",
       "stick ratio as feedback: Ikeda et al., IROS 2004, and arXiv:2402.11879",
       with_registers({
           number_spec("gain", Quantity::force, "12 N", non_negative, "Grip force added to the preset when no pillar sticks.",
                       "assumed"),
           force_per_count_spec(),
           ceiling_spec(),
           loosen_spec(),
       })},
      [](const Parameters& p, const GripSource& source) -> std::unique_ptr<Controller> {
        return std::make_unique<StuckFraction>(p, source);
      }};
}

}  // namespace slipbench::controllers
