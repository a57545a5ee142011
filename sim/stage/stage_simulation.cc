#include "sim/stage/stage_simulation.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/thickness.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/random.h"
#include "sim/core/readable_quantity.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/motion/motor_vibration.h"
#include "sim/stage/stage_setup.h"
#include "sim/stage/step_plan.h"

namespace slipbench {
namespace {

bool same_bits(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  std::uint64_t differ = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    differ |= std::bit_cast<std::uint64_t>(a.data()[i]) ^ std::bit_cast<std::uint64_t>(b.data()[i]);
  }
  return differ == 0;
}

// The force of an element that has passed through a round shape would vanish without a message.
void refuse_lost(const Field& field, double thickness, double time) {
  const std::optional<Field::Lost>& lost = field.lost();
  if (!lost) return;
  throw SceneValueError(
      "surface",
      fmt::format(
          "at {} element {} of the pad, which was {:.3g} mm deep, passed through the shape, which is {:.3g} mm thick; choose a larger shape or less motion.compression",
          readable_quantity(time, Quantity::time), lost->element, 1e3 * lost->depth, 1e3 * thickness));
}

}  // namespace

struct StageSimulation::State {
  struct Pad {
    Field field;
    ContactLabels labels;
    std::optional<MotorVibration> motors;
  };

  std::unique_ptr<Motion> motion;
  Pose world_in_surface;
  double thickness = 0.0;  // m, of the surface's shape
  std::vector<Pad> pads;
  PadClocks clocks;
  std::vector<NamedBody> bodies;
  Pose pad_in_surface;  // of the last step
};

StageSimulation::StageSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                                 std::uint64_t trial)
    : state_(std::make_unique<State>()) {
  if (scene.fidelity != "field" || scene.dynamic()) throw std::logic_error("StageSimulation: a scene of another simulation");
  State& s = *state_;
  StageSetup stage = set_up_stage(scene, trial);
  s.motion = std::move(stage.motion);
  const std::optional<MotorSettings> motors = s.motion->motors();
  const PlacedSurface& surface = stage.surface;
  s.world_in_surface = surface.pose.inverse();
  s.thickness = thickness_of(surface.shape);

  for (std::size_t i = 0; i < pads.size(); ++i) {
    FieldEffects effects = install_effects(scene.effects, *pads[i], surface.shape, scene.seed, trial);
    refuse_inside(*pads[i], surface, effects, s.motion->pad_at(0.0).pose);
    s.clocks.add(plan_steps(scene, output_rates.subspan(i, 1), step_limit(*s.motion, effects, reach_of(*pads[i])), i));
    Field field(*pads[i], surface.shape, {scene.friction.static_coefficient, scene.friction.kinetic_coefficient},
                std::move(effects));
    ContactLabels labels(field.layout());
    s.pads.push_back({std::move(field), std::move(labels), {}});
    if (motors) s.pads.back().motors.emplace(*motors, RandomStream(scene.seed, trial, "motors"));
  }
  s.pad_in_surface = s.world_in_surface * s.motion->pad_at(0.0).pose;
  s.bodies = {{"pad", s.motion->pad_at(0.0)}, {"surface", {surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
}

StageSimulation::~StageSimulation() = default;
StageSimulation::StageSimulation(StageSimulation&&) noexcept = default;
StageSimulation& StageSimulation::operator=(StageSimulation&&) noexcept = default;

std::size_t StageSimulation::ticks(std::size_t pad) const { return state_->clocks.ticks(pad); }
double StageSimulation::time_step(std::size_t pad) const { return state_->clocks.time_step(pad); }
std::size_t StageSimulation::stride(std::size_t pad) const { return state_->clocks.stride(pad); }
std::span<const std::size_t> StageSimulation::stepped() const { return state_->clocks.stepped(); }
const ContactFrame& StageSimulation::contact_part(std::size_t pad, FramePart part) const {
  State::Pad& read = state_->pads[pad];
  return read.labels.fill({&read.field, 1}, part);
}
void StageSimulation::disable_slip_angle() {
  for (State::Pad& pad : state_->pads) pad.labels.disable_slip_angle();
}
const std::vector<NamedBody>& StageSimulation::bodies() const { return state_->bodies; }
bool StageSimulation::rotating() const { return state_->motion->turns(); }

void StageSimulation::step() {
  State& s = *state_;
  const double time = s.clocks.advance();
  const BodyState stage = s.motion->pad_at(time);
  BodyState& last = s.bodies.front().state;
  if (!same_bits(stage.pose.rotation, last.pose.rotation)) {
    s.pad_in_surface.rotation = s.world_in_surface.rotation * stage.pose.rotation;
  }
  s.pad_in_surface.position = s.world_in_surface * stage.pose.position;
  last = stage;
  for (const std::size_t i : s.clocks.stepped()) {
    State::Pad& pad = s.pads[i];
    const double dt = s.clocks.time_step(i);
    pad.field.step(s.pad_in_surface, dt);
    refuse_lost(pad.field, s.thickness, time);
    pad.labels.ride(stage.pose.position.array(), pad.motors ? pad.motors->force(stage, pad.field.touching() > 0, dt) : 0.0);
    pad.labels.judge({&pad.field, 1}, time, dt);
    pad.labels.settle({&pad.field, 1}, dt);
  }
}

}  // namespace slipbench
