// A grasp from text, with the simplest loop.
#pragma once

#include <array>

#include "sim/mujoco/bodies/grasp_simulation.h"
#include "sim/mujoco/pads/field_plugin.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench {

class GraspRig {
 public:
  // `text`: a scene without its first line and its sensor; `sensor`: the sensor's parameters in
  // addition to its type.
  explicit GraspRig(const std::string& text, std::uint64_t trial = 0, const DynamicSimulationOptions& options = {},
                    const std::string& sensor = "")
      : scene_(parsed("slipbench: 1\nsensors: {pad: {type: papillarray" + sensor + "}}\n" + text)) {
    register_plugin_once();
    sensor_ = make_sensor(scene_.sensors.front(), scene_.seed, trial);
    const std::array<const PadLayout*, 1> pads{&sensor_->layout()};
    simulation_ = std::make_unique<GraspSimulation>(scene_, pads, std::array{sensor_->rate()}, trial, options);
    preset_ = scene_.grasp->grip.number("preset");
  }

  GraspSimulation* operator->() { return simulation_.get(); }
  GraspSimulation& operator*() { return *simulation_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const PadLayout& pad() const { return sensor_->layout(); }

  // Commands the measured position + 1 while the true force on the sensor's pad is below the
  // preset, then stays.
  void step() {
    simulation_->step();
    Gripper& gripper = simulation_->gripper();
    const GraspTruth& truth = simulation_->truth();
    if (gripper.read_due(truth.time)) {
      const int position = gripper.read().position;
      if (held_ < 0 && truth.pad_force[0] >= preset_) held_ = position;
      command_.position = held_ < 0 ? position + 1 : held_ + more;
    }
    if (gripper.write_due(truth.time)) gripper.write(command_);
    ++done_;
  }
  // Runs until the tick at `time` [s] has been computed.
  void run_to(double time) {
    while (static_cast<double>(done_) * simulation_->time_step(0) <= time + 1e-9) step();
  }
  void run() {
    while (done_ < simulation_->ticks(0)) step();
  }

  // Force of the pads on the box [N], in the world.
  [[nodiscard]] Eigen::Vector3d pads_on_box() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const mjModel* m = simulation_->dynamics().model();
    for (const char* name : {"pad", "second_pad"}) {
      const PadInstance* pad = pad_of(m, simulation_->dynamics().data(), mj_name2id(m, mjOBJ_PLUGIN, name));
      sum -= body(name).pose.rotation * pad->fields().front().wrench_on_pad().force;
    }
    return sum;
  }
  [[nodiscard]] const BodyState& body(const std::string& name) const { return body_of(*simulation_, name); }
  // Middle of the box in the arm's frame [m].
  [[nodiscard]] Eigen::Vector3d box_in_arm() const { return (body("arm").pose.inverse() * body("box").pose).position; }

  int more = 0;  // counts beyond the stop

 private:
  Scene scene_;
  std::unique_ptr<Sensor> sensor_;
  std::unique_ptr<GraspSimulation> simulation_;
  GripCommand command_{};
  double preset_;
  int held_ = -1;
  std::size_t done_ = 0;
};

}  // namespace slipbench
