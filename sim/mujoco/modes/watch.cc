#include "sim/mujoco/modes/watch.h"

#include <fmt/format.h>

namespace slipbench {

std::optional<std::string> WeightRule::check(const WatchedBody& body, double dt) {
  // The change that leads to this tick belongs to the step before it or to the one after it: both
  // windows allow for it.
  const double change = (body.predicted - before_).norm();
  before_ = body.predicted;
  variation_ += change;
  std::optional<std::string> wrong;
  if (steps_ > 0 && time_ >= limits_.window) {
    const double missing = missing_.norm() / time_, share = limits_.weight_share * body.weight;
    if (missing > share + variation_ / static_cast<double>(steps_)) {
      wrong = fmt::format(
          "over {1:.3g} s the forces on it differ from its mass times its acceleration by {0:.3g} N; allowed: {2} of its weight of {3:.6g} N",
          missing, time_, limits_.weight_share, body.weight);
    }
    steps_ = 0;
  }
  if (steps_ == 0) {
    missing_.setZero();
    time_ = 0.0;
    variation_ = change;
  }
  missing_ += dt * (body.force - body.mass_times_acceleration);
  time_ += dt;
  ++steps_;
  return wrong;
}

std::optional<std::string> EnergyRule::check(const WatchedEnergy& tick, double dt) {
  if (!started_) {
    started_ = true;
    total_ = available_ = tick.kinetic + tick.elastic;
    elastic_ = tick.elastic;
    return std::nullopt;
  }
  total_ += tick.supply;
  available_ += tick.supply + tick.contact_supply;
  gain_ += tick.field_work + (tick.elastic - elastic_) + tick.slip_loss;
  elastic_ = tick.elastic;
  time_ += dt;
  if (judge_fields_ && gain_ > limits_.energy_share * available_ + limits_.energy_floor) {
    return fmt::format(
        "in the last {1:.3g} s the pads have delivered {0:.3g} J more than they took up; allowed: {3} of the {2:.3g} J that were available",
        gain_, time_, available_, limits_.energy_share);
  }
  if (time_ >= limits_.window) {
    available_ = tick.kinetic + tick.elastic;
    gain_ = time_ = 0.0;
  }
  return std::nullopt;
}

std::optional<std::string> EnergyRule::check_body(double kinetic) const {
  if (kinetic <= limits_.ejection_factor * total_ + limits_.energy_floor) return std::nullopt;
  return fmt::format(
      "has {:.3g} J of kinetic energy, more than the {:.3g} J from the start, weight, motors and stage together: the contact has thrown it out",
      kinetic, total_);
}

}  // namespace slipbench
