// A controller that changes the grip by the scene's timetable, independent of the sensor.
#include <algorithm>
#include <cmath>
#include <optional>

#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

class TimedGrip final : public GripController {
 public:
  TimedGrip(const Parameters& p, const GripSource& source)
      : GripController(p, source, "timed_grip"), changes_(p.table("changes").rows) {
    check_times(p.table("changes"), "controller.changes");
  }

  GripCommand update(const ControlInput& input) override {
    const double time = input.gripper.time;
    if (!taken_ && force_.total(input.frame) >= preset_) taken_ = position_.value_or(input.gripper.position);
    position_ = taken_ ? moved(*taken_, std::round(counts_at(time))) : moved(input.gripper.position, 1);
    command_.position = *position_;
    return command_;
  }

 private:
  // Linear between the rows: 0 before the first, the last row's value after it.
  [[nodiscard]] double counts_at(double time) const {
    const auto next = std::ranges::find_if(changes_, [time](const std::vector<double>& row) { return row[0] > time; });
    if (next == changes_.begin()) return 0.0;
    const std::vector<double>& before = *std::prev(next);
    if (next == changes_.end()) return before[1];
    return std::lerp(before[1], (*next)[1], (time - before[0]) / ((*next)[0] - before[0]));
  }

  std::vector<std::vector<double>> changes_;  // rows of time [s] and counts
  std::optional<int> position_;               // counts, last command
  std::optional<int> taken_;                  // counts, last command when the preset was reached
};

}  // namespace

ControllerKind timed_grip() {
  return {
      {"timed_grip", "Disturbance: grips the box with the preset force, then tightens and loosens by a timetable.",
       "until F >= preset for the first time: position = measured position + 1 count\n"
       "from then on: position = the last command until then + round(counts(t)), counts linear between the rows of `changes`; 0 before\n"
       "the first row, the last row's after it. Two rows at one time are a step. Positions are limited to 0 to 255.\n"
       "F: sum of the pillars' normal forces.",
       "a task that changes the grip without slip",
       with_registers(
           {table_spec(2, "changes", {{"t", Quantity::time}, {"counts"}},
                       "Times at which the grip changes, and counts added to those of the preset.", "set for each scene")})},
      created<TimedGrip>,
      Answers::nothing};
}

}  // namespace slipbench::controllers
