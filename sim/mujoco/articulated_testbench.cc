#include "sim/mujoco/articulated_testbench.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/core/error.h"
#include "sim/mujoco/articulated.h"
#include "sim/mujoco/articulated_bench.h"
#include "sim/testbench/stage_setup.h"
#include "sim/testbench/step_plan.h"

namespace slipbench {

struct ArticulatedTestbench::State {
  std::unique_ptr<Motion> motion;
  Pose world_in_surface;
  std::vector<std::unique_ptr<ArticulatedBench>> pads;
  std::vector<NamedBody> bodies;
  StepPlan plan;
  std::size_t tick = 0;
};

ArticulatedTestbench::ArticulatedTestbench(const Scene& scene, std::span<const PadLayout* const> pads,
                                           std::span<const double> output_rates, std::uint64_t trial)
    : state_(std::make_unique<State>()) {
  refuse_without_field(scene);
  State& s = *state_;
  StageSetup stage = set_up_stage(scene, trial);
  s.motion = std::move(stage.motion);
  refuse_motors(*s.motion);
  s.world_in_surface = stage.surface.pose.inverse();
  s.plan = plan_steps(scene, output_rates, std::numeric_limits<double>::infinity(), "the pads");
  for (const PadLayout* pad : pads) {
    refuse_inside(*pad, stage.surface, {}, s.motion->pad_at(0.0).pose);
    s.pads.push_back(std::make_unique<ArticulatedBench>(
        *pad, stage.surface.shape, Friction{scene.friction.static_coefficient, scene.friction.kinetic_coefficient}, s.plan.dt));
  }
  s.bodies = {{"pad", s.motion->pad_at(0.0)},
              {"surface", {stage.surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
}

ArticulatedTestbench::~ArticulatedTestbench() = default;

std::size_t ArticulatedTestbench::ticks() const { return state_->plan.ticks; }
double ArticulatedTestbench::time_step() const { return state_->plan.dt; }
std::size_t ArticulatedTestbench::stride(std::size_t pad) const { return state_->plan.strides[pad]; }
const ContactFrame& ArticulatedTestbench::contact(std::size_t pad) const { return state_->pads[pad]->frame(); }
const std::vector<NamedBody>& ArticulatedTestbench::bodies() const { return state_->bodies; }
bool ArticulatedTestbench::rotating() const { return state_->motion->turns(); }

void ArticulatedTestbench::step() {
  State& s = *state_;
  const double time = static_cast<double>(s.tick) * s.plan.dt;
  s.bodies.front().state = s.motion->pad_at(time);
  const Pose pad_in_surface = s.world_in_surface * s.bodies.front().state.pose;
  try {
    for (const auto& pad : s.pads) pad->step(pad_in_surface, time);
  } catch (const std::runtime_error& error) {
    throw InputError(std::string("the run has gone wrong: ") + error.what());
  }
  ++s.tick;
}

}  // namespace slipbench
