#include "sim/mujoco/bodies/watch.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace slipbench {

std::optional<std::string> WeightRule::judge(const WatchedBody& last) const {
  const double weight = last.weight.norm();
  if (weight == 0.0) return std::nullopt;
  const double duration = time_;
  double left_out = (variation_ + (last.force - before_).norm()) / static_cast<double>(steps_);
  for (std::size_t i = 0; i < last.dashpots.size(); ++i) {
    const WatchedDashpot &before = first_.dashpots[i], &after = last.dashpots[i];
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(before.pad.rotation.transpose() * after.pad.rotation));
    const double way = (after.pad.position - before.pad.position).norm() + after.reach * turn.angle();
    left_out += after.damping * way / duration;
  }
  if (left_out > 0.5 * limits_.weight_share * weight) return std::nullopt;  // not at rest
  const Eigen::Vector3d missing = (impulse_ - (last.momentum - first_.momentum)) / duration;
  if (missing.norm() <= limits_.weight_share * weight) return std::nullopt;
  return fmt::format("was at rest for {:.3g} s, and the forces on it miss its weight of {:.6g} N by {:.3g} N; allowed: {} of it",
                     duration, weight, missing.norm(), limits_.weight_share);
}

std::optional<std::string> WeightRule::check(const WatchedBody& body, double dt) {
  std::optional<std::string> wrong;
  if (steps_ > 0 && time_ >= limits_.window) {
    wrong = judge(body);
    steps_ = 0;
  }
  if (steps_ == 0) {
    first_ = body;
    impulse_.setZero();
    time_ = variation_ = 0.0;
    before_ = body.force;
  }
  variation_ += (body.force - before_).norm();
  before_ = body.force;
  impulse_ += dt * (body.force + body.weight);
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
        "the pads have given {:.3g} J more than they took in the last {:.3g} s, with {:.3g} J at hand; allowed: {} of that",
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
      "has {:.3g} J of kinetic energy, and all that there was and that weight, motors and the stage have given is {:.3g} J; it was thrown out",
      kinetic, total_);
}

}  // namespace slipbench
