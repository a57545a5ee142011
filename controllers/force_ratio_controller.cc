#include <algorithm>

#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

class ForceRatio final : public GripController {
 public:
  ForceRatio(const Parameters& p, const GripSource& source)
      : GripController(p, source, "force_ratio"),
        allowed_(p.number("mu") * p.number("margin")),
        touch_(p.number("touch")),
        largest_(p.choice("ratio") == "largest"),
        follower_(p) {}

  GripCommand update(const ControlInput& input) override {
    const double grip = force_.total(input.frame);
    const double target = std::max(preset_, (largest_ ? grip * largest_ratio(input.frame) : shear(input.frame)) / allowed_);
    command_.position = follower_.toward(grip, target, input.gripper.position);
    return command_;
  }

 private:
  [[nodiscard]] double shear(const SensorFrame& frame) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < force_.units(); ++i) sum += force_.tangential(frame, i);
    return sum;
  }

  [[nodiscard]] double largest_ratio(const SensorFrame& frame) const {
    double ratio = 0.0;
    for (std::size_t i = 0; i < force_.units(); ++i) {
      const double normal = force_.normal(frame, i);
      if (normal >= touch_) ratio = std::max(ratio, force_.tangential(frame, i) / normal);
    }
    return ratio;
  }

  double allowed_;  // largest ratio of tangential to normal force
  double touch_;
  bool largest_;
  ForceFollower follower_;
};

}  // namespace

ControllerKind force_ratio() {
  return {
      {"force_ratio", "Keeps the ratio of tangential to normal force below an assumed friction coefficient with a margin.",
       "target = max(preset, sum |f_t| / (mu margin)), or max(preset, F max(|f_t|/f_n) / (mu margin))\n"
       "position = measured position + ceil((target - F)/force_per_count) counts while F < target, otherwise the last command\n"
       "f_t, f_n: tangential and normal force of a pillar; F: sum of f_n. The position stops at 255.",
       "Coulomb's law; grip force kept in proportion to the load: Westling and Johansson, Exp. Brain Res. 53 (1984) 277",
       with_registers(
           {number_spec("mu", Quantity::none, "0.35", positive,
                        "Friction coefficient that the controller assumes; a value that is too high drops the box.",
                        "assumed: PTFE on silicone"),
            number_spec("margin", Quantity::none, "0.8", positive_up_to(1.0), "Share of mu that the ratio may reach.", "assumed"),
            choice_spec("ratio", "sum", {"sum", "largest"},
                        "sum: ratio of the whole pad; largest: ratio of the pillar nearest to slipping.", "assumed"),
            touch_spec(), force_per_count_spec(), ceiling_spec(), loosen_spec()})},
      created<ForceRatio>};
}

}  // namespace slipbench::controllers
