#include "sim/mujoco/articulated/articulated_simulation.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/wrong_run.h"
#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/articulated/articulated_stage.h"
#include "sim/simulation/pad_clocks.h"
#include "sim/simulation/stage_setup.h"
#include "sim/simulation/step_plan.h"

namespace slipbench {

struct ArticulatedSimulation::State {
  std::unique_ptr<Motion> motion;
  Pose world_in_surface;
  std::vector<std::unique_ptr<ArticulatedStage>> pads;
  std::vector<NamedBody> bodies;
  PadClocks clocks;
};

ArticulatedSimulation::ArticulatedSimulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                             std::span<const double> output_rates, std::uint64_t trial)
    : state_(std::make_unique<State>()) {
  refuse_without_field(scene);
  State& s = *state_;
  StageSetup stage = set_up_stage(scene, trial);
  s.motion = std::move(stage.motion);
  refuse_motors(*s.motion);
  s.world_in_surface = stage.surface.pose.inverse();
  for (std::size_t i = 0; i < pads.size(); ++i) {
    s.clocks.add(plan_steps(scene, output_rates.subspan(i, 1), std::numeric_limits<double>::infinity(), "the pads", i));
    refuse_inside(*pads[i], stage.surface, {}, s.motion->pad_at(0.0).pose);
    const Friction friction{scene.friction.static_coefficient, scene.friction.kinetic_coefficient};
    const double dt = s.clocks.time_step(i);
    s.pads.push_back(scene.contact ? std::make_unique<ArticulatedStage>(*pads[i], stage.surface.shape, friction,
                                                                        user_pillars(*scene.contact, dt))
                                   : std::make_unique<ArticulatedStage>(*pads[i], stage.surface.shape, friction, dt));
  }
  s.bodies = {{"pad", s.motion->pad_at(0.0)},
              {"surface", {stage.surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
}

ArticulatedSimulation::~ArticulatedSimulation() = default;

std::size_t ArticulatedSimulation::ticks(std::size_t pad) const { return state_->clocks.ticks(pad); }
double ArticulatedSimulation::time_step(std::size_t pad) const { return state_->clocks.time_step(pad); }
std::size_t ArticulatedSimulation::stride(std::size_t pad) const { return state_->clocks.stride(pad); }
std::span<const std::size_t> ArticulatedSimulation::stepped() const { return state_->clocks.stepped(); }
const ContactFrame& ArticulatedSimulation::contact(std::size_t pad) const { return state_->pads[pad]->frame(); }
const std::vector<NamedBody>& ArticulatedSimulation::bodies() const { return state_->bodies; }
bool ArticulatedSimulation::rotating() const { return state_->motion->turns(); }

void ArticulatedSimulation::step() {
  State& s = *state_;
  const double time = s.clocks.advance();
  s.bodies.front().state = s.motion->pad_at(time);
  const Pose pad_in_surface = s.world_in_surface * s.bodies.front().state.pose;
  try {
    for (const std::size_t pad : s.clocks.stepped()) s.pads[pad]->step(pad_in_surface, time);
  } catch (const std::runtime_error& error) {
    throw WrongRun(std::string("the run has gone wrong: ") + error.what());
  }
}

}  // namespace slipbench
