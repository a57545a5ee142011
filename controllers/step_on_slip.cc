#include <algorithm>
#include <optional>

#include "controllers/grip.h"
#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::controllers {
namespace {

class StepOnSlip final : public GripController {
 public:
  StepOnSlip(const Parameters& p, const GripSource& source)
      : GripController(p, source, "step_on_slip", true),
        ceiling_(p.number("ceiling")),
        force_per_count_(p.number("force_per_count")),
        debounce_(p.integer("debounce")),
        overflow_(p.choice("overflow")),
        idle_at_measured_(p.choice("idle") == "measured_position") {}

  GripCommand update(const ControlInput& input) override {
    const double grip = force_.total(input.frame);
    const bool slips = input.slip.state == PadState::incipient || input.slip.state == PadState::gross;
    slips_ = slips ? std::min(slips_ + 1, debounce_) : 0;
    const bool wanted = slips_ == debounce_ || grip < preset_;
    if (wanted && grip + force_per_count_ <= ceiling_) {
      position_ = one_further(input.gripper);
    } else if (idle_at_measured_ || !position_) {
      position_ = input.gripper.position;
    }
    command_.position = *position_;
    return command_;
  }

 private:
  // Returns the next position inwards; beyond the last one `overflow` decides.
  [[nodiscard]] int one_further(const GripperStatus& gripper) const {
    if (gripper.position < max_register) return gripper.position + 1;
    if (overflow_ == "wrap") return 0;
    if (overflow_ == "hold") return max_register;
    throw InputError("controller step_on_slip: position " + std::to_string(max_register) +
                     " reached at t = " + readable_quantity(gripper.time, Quantity::time) +
                     ", and one more count would wrap to 0 and open the fingers; set overflow: hold, or wrap as published");
  }

  double ceiling_, force_per_count_;
  std::int64_t debounce_;
  std::string overflow_;
  bool idle_at_measured_;
  std::int64_t slips_ = 0;       // consecutive updates with slip, at most debounce_
  std::optional<int> position_;  // last command
};

}  // namespace

ControllerKind step_on_slip() {
  return {
      {"step_on_slip",
       "The published loop: one count tighter while the detector reports slip or the grip is below the preset force.",
       "(class incipient or gross for `debounce` updates in a row, or F < preset) and F + force_per_count <= ceiling:\n"
       "position = measured position + 1 count; otherwise as `idle` specifies\n"
       "F: sum of the pillars' normal forces. The force stays below the ceiling if a count changes the force by at most force_per_count and the force is not older than the position.",
       "HD-computing slip paper, section IV-D and its published HDL (control_gripper.sv); debounce, ceiling and the other values of overflow are additions",
       with_registers(
           {integer_spec("debounce", "1", {1.0, 1e6}, "Consecutive updates with slip before the grip is tightened; 1: at once.",
                         "the published controller has none"),
            ceiling_spec(), force_per_count_spec(),
            choice_spec(
                "overflow", "refuse", {"refuse", "hold", "wrap"},
                "At one count beyond 255 - refuse: the run ends with an error; hold: the position stays; wrap: the byte wraps to 0 and the fingers open.",
                "published: wrap; refused here, because it opens the fingers unexpectedly"),
            choice_spec(
                "idle", "measured_position", {"measured_position", "last_command"},
                "Command while the grip is not tightened. measured_position: the position read last, which cancels a count that has not arrived yet; last_command: keeps such a count.",
                "published HDL (control_gripper.sv): the measured position")})},
      created<StepOnSlip>,
      Answers::seen_slip};
}

}  // namespace slipbench::controllers
