#include <optional>

#include "controllers/controller_kinds.h"
#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

class ConstantForce final : public Controller {
 public:
  ConstantForce(const Parameters& p, const GripSource& source)
      : force_(source.channels, "constant_force"), preset_(source.preset), command_(registers_of(p)) {}

  GripCommand update(const ControlInput& input) override {
    reached_ = reached_ || force_.total(input.frame) >= preset_;
    if (!reached_) position_ = moved(input.gripper.position, 1);
    command_.position = position_.value_or(input.gripper.position);
    position_ = command_.position;
    return command_;
  }

 private:
  GripForce force_;
  double preset_;
  GripCommand command_;
  bool reached_ = false;         // the preset has been measured once
  std::optional<int> position_;  // last command
};

}  // namespace

ControllerKind constant_force() {
  return {
      {"constant_force", "Baseline: closes once to a grip force and then never moves, whatever the force or the slip.",
       "until F >= preset for the first time: position = measured position + 1 count; from then on: the last command\n"
       "F: sum of the pillars' normal forces. The position ends at 255 and stays there; fingers that met nothing are then closed.",
       "the baseline of a grip without feedback; closes as the published HDL does", with_registers({})},
      [](const Parameters& p, const GripSource& source) -> std::unique_ptr<Controller> {
        return std::make_unique<ConstantForce>(p, source);
      }};
}

}  // namespace slipbench::controllers
