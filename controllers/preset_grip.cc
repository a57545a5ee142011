// Controllers that close to the preset force without a detector: the baseline and the negative
// control.
#include <optional>

#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

// `Once`: a force that was reached once counts as reached from then on.
template <bool Once>
class PresetGrip final : public GripController {
 public:
  PresetGrip(const Parameters& p, const GripSource& source)
      : GripController(p, source, Once ? "constant_force" : "hold_preset") {}

  GripCommand update(const ControlInput& input) override {
    reached_ = (Once && reached_) || force_.total(input.frame) >= preset_;
    if (!reached_) position_ = moved(input.gripper.position, 1);
    command_.position = position_.value_or(input.gripper.position);
    position_ = command_.position;
    return command_;
  }

 private:
  bool reached_ = false;
  std::optional<int> position_;  // last command
};

}  // namespace

ControllerKind constant_force() {
  return {{"constant_force", "Baseline: closes once to a grip force and then never moves; force and slip are ignored.",
           "until F >= preset for the first time: position = measured position + 1 count; from then on: the last command\n"
           "F: sum of the pillars' normal forces. The position stops at 255; fingers that touched nothing are then closed.",
           "the baseline of a grip without feedback; closes as the published HDL does", with_registers({})},
          created<PresetGrip<true>>,
          Answers::nothing};
}

ControllerKind hold_preset() {
  return {
      {"hold_preset",
       "Negative control: tightens only below the preset force, never on slip. A trial that also passes with this controller does not test the detector.",
       "F < preset: position = measured position + 1 count; otherwise: the last command\n"
       "F: sum of the pillars' normal forces. The position stops at 255.",
       "step_on_slip without its reaction to slip", with_registers({})},
      created<PresetGrip<false>>,
      Answers::nothing};
}

}  // namespace slipbench::controllers
