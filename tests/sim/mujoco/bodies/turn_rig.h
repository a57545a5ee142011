// The box of the reorientation bench between two pads with a test's layout, on an arm that a test
// commands.
#pragma once

#include <array>

#include <fmt/format.h>

#include "sim/mujoco/bodies/grasp_simulation.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench {

// 155 x 33 x 54 mm, lying on 155 x 33, held `lever` from its middle at half its height; 118 g plus
// a weight of 200 g in its middle.
struct TurnBox {
  static constexpr double length = 0.155, height = 0.054, lever = 0.060;  // m
  static constexpr double mass = 0.118, weight = 0.2;                     // kg
  static constexpr double load = (mass + weight) * 9.81;                  // N
};

class TurnRig {
 public:
  // `pad`: of both fingers. `counts`: closing beyond the position at which both pads touch. `more`:
  // keys of the scene.
  TurnRig(PadLayout pad, double friction, int counts, const std::string& more = "", const DynamicSimulationOptions& options = {})
      : scene_(parsed(text(friction, more))), pad_(std::move(pad)), counts_(counts) {
    register_plugin_once();
    const std::array<const PadLayout*, 1> pads{&pad_};
    simulation_ = std::make_unique<GraspSimulation>(scene_, pads, std::array{1000.0}, 0, options);
  }

  GraspSimulation* operator->() { return simulation_.get(); }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] double time() const { return simulation_->truth().time; }

  // Closes by `counts`; from `lift_at` on the arm rises at `lift_speed`.
  void step() {
    simulation_->step();
    Gripper& gripper = simulation_->gripper();
    const double now = time();
    if (gripper.read_due(now)) {
      const int position = gripper.read().position;
      const GraspTruth& truth = simulation_->truth();
      if (touched_ < 0 && truth.pad_force[0] > 0.1 && truth.pad_force[1] > 0.1) touched_ = position;
      command_.position = touched_ < 0 ? position + 1 : touched_ + counts_;
    }
    if (gripper.write_due(now)) gripper.write(command_);
    if (!rising_ && now >= lift_at) {
      simulation_->arm()->write(lift_at, {.sideways = 0.0, .up = lift_speed});
      rising_ = true;
    }
    ++done_;
  }
  void run_to(double until) {
    while (static_cast<double>(done_) * simulation_->time_step(0) <= until + 1e-9) step();
  }

  [[nodiscard]] const BodyState& body(const std::string& name) const { return body_of(*simulation_, name); }
  // Edge about which the box turns [m], in the world: the lower edge of the far end.
  [[nodiscard]] Eigen::Vector3d edge() const {
    return body("box").pose * Eigen::Vector3d(0.0, -0.5 * TurnBox::length, -0.5 * TurnBox::height);
  }

  double lift_at = 1.0;      // s
  double lift_speed = 2e-3;  // m/s

 private:
  static std::string text(double friction, const std::string& more) {
    return fmt::format(
        "slipbench: 1\nsensors: {{pad: {{type: papillarray}}}}\nduration: 60 s\nfriction: {{static: {}, kinetic: {}}}\n"
        "motion: {{kind: guided, top_acceleration: 1 mm/s2, latency: 0 ms}}\ngrip: {{height: 27 mm, second_pad: same}}\n"
        "box: {{mass: 118 g, weight: 200 g, size: [33 mm, 155 mm, 54 mm], position: [0 mm, -60 mm]}}\n{}",
        friction, friction, more);
  }

  Scene scene_;
  PadLayout pad_;
  int counts_, touched_ = -1;
  std::unique_ptr<GraspSimulation> simulation_;
  GripCommand command_{};
  bool rising_ = false;
  std::size_t done_ = 0;
};

}  // namespace slipbench
