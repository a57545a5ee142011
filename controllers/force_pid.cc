#include <algorithm>
#include <cmath>

#include "controllers/grip.h"

namespace slipbench::controllers {
namespace {

class ForcePid final : public GripController {
 public:
  ForcePid(const Parameters& p, const GripSource& source)
      : GripController(p, source, "force_pid"),
        proportional_(p.number("proportional")),
        integral_time_(p.number("integral_time")),
        derivative_time_(p.number("derivative_time")),
        dead_band_(p.number("dead_band")),
        lead_(static_cast<double>(p.integer("lead"))),
        force_per_count_(p.number("force_per_count")) {}

  GripCommand update(const ControlInput& input) override {
    const double grip = force_.total(input.frame);
    if (!started_) {
      position_ = input.gripper.position;
      last_ = before_last_ = grip;
      started_ = true;
    } else if (input.gripper.time > time_) {  // acts on a newer status only
      const double error = preset_ - grip;
      if (std::abs(error) > dead_band_) position_ += change(grip, error, input.gripper.time - time_) / force_per_count_;
      position_ = std::clamp(position_, input.gripper.position - lead_, input.gripper.position + lead_);
      before_last_ = last_;
      last_ = grip;
    }
    time_ = input.gripper.time;
    position_ = std::clamp(position_, 0.0, double{max_register});
    command_.position = static_cast<int>(std::lround(position_));
    return command_;
  }

 private:
  // Returns the change of force [N] for the last `period` [s].
  [[nodiscard]] double change(double grip, double error, double period) const {
    return proportional_ * (last_ - grip) + period / integral_time_ * error -
           derivative_time_ / period * (grip - 2.0 * last_ + before_last_);
  }

  double proportional_;                    // 1
  double integral_time_;                   // s
  double derivative_time_;                 // s
  double dead_band_;                       // N
  double lead_;                            // counts
  double force_per_count_;                 // N
  double position_ = 0.0;                  // counts, not rounded
  double last_ = 0.0, before_last_ = 0.0;  // N, grip force of the last two updates
  double time_ = 0.0;                      // s, of the last status
  bool started_ = false;
};

}  // namespace

ControllerKind force_pid() {
  return {
      {"force_pid", "PID on the measured grip force; slip is ignored.",
       "u_k = u_k-1 + (Kp (F_k-1 - F_k) + T/Ti (r - F_k) - Td/T (F_k - 2 F_k-1 + F_k-2)) / c while |r - F_k| > dead_band, otherwise u_k = u_k-1; u_0 = measured position\n"
       "position = round(u_k), u_k kept within measured position +- lead and within 0 to 255, against wind-up\n"
       "F: sum of the pillars' normal forces, r: preset, T: time between two reads of the status, c: force_per_count, Kp: proportional, Ti: integral_time, Td: derivative_time\n"
       "Let a count change the force by c', d periods after the read that caused it. With Kp = Td = 0 the loop is stable for T/Ti c'/c < 2 sin(pi/(4d - 2)) and without overshoot up to (d-1)^(d-1)/d^d; for 60 ms at periods of 20 ms these are 0.62 and 0.15.\n"
       "The loop comes to rest because a dead band of c/2 or more is at least as wide as one count.",
       "velocity form of PID with derivative and proportional action on the measured value: Astrom and Hagglund, PID Controllers (1995), chapter 3; bounds: roots of z^d - z^(d-1) + T/Ti c'/c",
       with_registers(
           {number_spec("proportional", Quantity::none, "0.1", non_negative,
                        "Kp: share of a change of the force that is compensated at once.", "assumed"),
            number_spec(
                "integral_time", Quantity::time, "0.15 s", positive_or_infinite,
                "Ti: time in which a constant error is compensated; inf: no integral action.",
                "assumed: T/Ti = 0.13, just below the limit of overshoot if a count changes the force by force_per_count"),
            number_spec("derivative_time", Quantity::time, "0 s", non_negative, "Td: time by which the force is extrapolated.",
                        "assumed: a derivative does not help with a force in steps of a count"),
            number_spec(
                "dead_band", Quantity::force, "0.8 N", non_negative,
                "Error that the controller ignores; if it is below half a real count, the fingers may never come to rest.",
                "assumed: half of force_per_count"),
            integer_spec(
                "lead", "2", {1.0, double{max_register}},
                "Largest difference in counts between the command and the measured position. It sets the speed in free air and limits the integral while the motor is stopped.",
                "assumed"),
            force_per_count_spec()})},
      created<ForcePid>,
      Answers::nothing};
}

}  // namespace slipbench::controllers
