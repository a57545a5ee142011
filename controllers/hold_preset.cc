#include <optional>

#include "controllers/controller_kinds.h"
#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

class HoldPreset final : public Controller {
 public:
  HoldPreset(const Parameters& p, const GripSource& source)
      : force_(source.channels, "hold_preset"), preset_(source.preset), command_(registers_of(p)) {}

  GripCommand update(const ControlInput& input) override {
    if (force_.total(input.frame) < preset_) position_ = moved(input.gripper.position, 1);
    command_.position = position_.value_or(input.gripper.position);
    position_ = command_.position;
    return command_;
  }

 private:
  GripForce force_;
  double preset_;
  GripCommand command_;
  std::optional<int> position_;  // last command
};

}  // namespace

ControllerKind hold_preset() {
  return {
      {"hold_preset",
       "Negative control: tightens only below the preset force, never on slip. A trial that passes with this controller tests no detector.",
       "F < preset: position = measured position + 1 count; otherwise: the last command\n"
       "F: sum of the pillars' normal forces. The position ends at 255 and stays there.",
       "step_on_slip without its slip", with_registers({})},
      [](const Parameters& p, const GripSource& source) -> std::unique_ptr<Controller> {
        return std::make_unique<HoldPreset>(p, source);
      }};
}

}  // namespace slipbench::controllers
