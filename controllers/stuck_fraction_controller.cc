#include <cmath>

#include "controllers/grip.h"
#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::controllers {
namespace {

class StuckFraction final : public GripController {
 public:
  StuckFraction(const Parameters& p, const GripSource& source)
      : GripController(p, source, "stuck_fraction", true), gain_(p.number("gain")), follower_(p) {}

  GripCommand update(const ControlInput& input) override {
    const double target = preset_ + gain_ * (1.0 - stuck(input.slip));
    command_.position = follower_.toward(force_.total(input.frame), target, input.gripper.position);
    return command_;
  }

 private:
  static double stuck(const SlipEstimate& slip) {
    if (slip.state == PadState::no_contact) return 1.0;
    if (std::isnan(slip.stuck_fraction)) {
      throw InputError("controller stuck_fraction: the detector reports no stuck fraction at t = " +
                       readable_quantity(slip.time, Quantity::time) + "; use a detector that reports it, such as stuck_fraction");
    }
    return slip.stuck_fraction;
  }

  double gain_;
  ForceFollower follower_;
};

}  // namespace

ControllerKind stuck_fraction() {
  return {
      {"stuck_fraction", "Grip force in proportion to the share of the touching pillars that do not stick.",
       "target = preset + gain (1 - s), s: the detector's stuck fraction, 1 without contact\n"
       "position = measured position + ceil((target - F)/force_per_count) counts while F < target, otherwise the last command\n"
       "F: sum of the pillars' normal forces. The position stops at 255. A detector without a stuck fraction is an error.",
       "stick ratio as feedback: Ikeda et al., IROS 2004, and arXiv:2402.11879",
       with_registers({number_spec("gain", Quantity::force, "12 N", non_negative,
                                   "Grip force added to the preset when no pillar sticks.", "assumed"),
                       force_per_count_spec(), ceiling_spec(), loosen_spec()})},
      created<StuckFraction>};
}

}  // namespace slipbench::controllers
