#include "sim/testbench/testbench.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/effects/catalogue.h"
#include "sim/effects/install.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/grasp/grasp_catalogue.h"
#include "sim/motion/motion.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/materials.h"
#include "sim/testbench/bodies.h"
#include "sim/testbench/stage_setup.h"
#include "sim/testbench/step_plan.h"
#include "sim/testbench/surfaces.h"

namespace slipbench {
namespace {

// How deep a tip may be in a shape until the far side is nearer than the one by which it came in [m].
struct HalfThickness {
  double operator()(const Plane&) const { return std::numeric_limits<double>::infinity(); }
  double operator()(const Box& box) const { return box.half.minCoeff(); }
  double operator()(const Cylinder& cylinder) const { return std::min(cylinder.radius, cylinder.half_length); }
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Capsule& capsule) const { return capsule.radius; }
  double operator()(const Ellipsoid& ellipsoid) const { return ellipsoid.half.minCoeff(); }
  double operator()(const DistanceGrid&) const { return std::numeric_limits<double>::infinity(); }  // it knows of no thickness
};

// An element of a pad deeper than that would come out on the far side without having let go.
void refuse_too_deep(const Field& field, double half_thickness, double time) {
  constexpr double margin = 0.9;  // of the half thickness: a step must not lead over the rest of it
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.penetration(i) > margin * half_thickness) {
      throw InputError(
          fmt::format("surface: at {} the pad is {} deep in a shape whose half thickness is {}; allowed: up to {} % of that, "
                      "by a larger shape or less motion.compression",
                      format_quantity(time, Quantity::time), format_quantity(field.penetration(i), Quantity::length),
                      format_quantity(half_thickness, Quantity::length), 100.0 * margin));
    }
  }
}

}  // namespace

struct Testbench::State {
  struct Pad {
    Field field;
    ContactLabels labels;
    std::size_t stride;
  };

  std::unique_ptr<Motion> motion;
  std::optional<MotorVibration> motors;
  Pose world_in_surface;
  double half_thickness = 0.0;  // m, of the surface's shape
  std::vector<Pad> pads;
  std::vector<NamedBody> bodies;
  double dt = 0.0;
  std::size_t ticks = 0;
  std::size_t tick = 0;
};

Testbench::Testbench(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                     std::uint64_t trial)
    : state_(std::make_unique<State>()) {
  if (scene.fidelity != "field" || scene.dynamic()) throw std::logic_error("Testbench: a scene of another bench");
  State& s = *state_;
  StageSetup stage = set_up_stage(scene, trial);
  s.motion = std::move(stage.motion);
  if (const auto motors = s.motion->motors()) s.motors.emplace(*motors, RandomStream(scene.seed, trial, "motors"));
  const PlacedSurface& surface = stage.surface;
  s.world_in_surface = surface.pose.inverse();
  s.half_thickness = std::visit(HalfThickness{}, surface.shape);

  double longest = std::numeric_limits<double>::infinity();
  std::vector<FieldEffects> effects(pads.size());
  for (std::size_t i = 0; i < pads.size(); ++i) {
    effects[i] = install_effects(scene.effects, *pads[i], surface.shape, scene.seed, trial);
    refuse_inside(*pads[i], surface, effects[i], s.motion->pad_at(0.0).pose);
    longest = std::min(longest, longest_step(effects[i], s.motion->top_speed(reach_of(*pads[i]))));
  }

  const StepPlan plan = plan_steps(scene, output_rates, longest, "the scene's effects");
  s.dt = plan.dt;
  s.ticks = plan.ticks;
  for (std::size_t i = 0; i < pads.size(); ++i) {
    Field field(*pads[i], surface.shape, {scene.friction.static_coefficient, scene.friction.kinetic_coefficient},
                std::move(effects[i]));
    ContactLabels labels(field.layout());
    s.pads.push_back({std::move(field), std::move(labels), plan.strides[i]});
  }
  s.bodies = {{"pad", s.motion->pad_at(0.0)}, {"surface", {surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
}

Testbench::~Testbench() = default;
Testbench::Testbench(Testbench&&) noexcept = default;
Testbench& Testbench::operator=(Testbench&&) noexcept = default;

std::size_t Testbench::ticks() const { return state_->ticks; }
double Testbench::time_step() const { return state_->dt; }
std::size_t Testbench::stride(std::size_t pad) const { return state_->pads[pad].stride; }
const ContactFrame& Testbench::contact(std::size_t pad) const { return state_->pads[pad].labels.frame(); }
const std::vector<NamedBody>& Testbench::bodies() const { return state_->bodies; }
bool Testbench::rotating() const { return state_->motion->turns(); }

void Testbench::step() {
  State& s = *state_;
  const double time = static_cast<double>(s.tick) * s.dt;
  s.bodies.front().state = s.motion->pad_at(time);
  const Pose pad_in_surface = s.world_in_surface * s.bodies.front().state.pose;
  bool touching = false;
  for (State::Pad& pad : s.pads) {
    pad.field.step(pad_in_surface, s.dt);
    if (!pad.field.on_plane()) refuse_too_deep(pad.field, s.half_thickness, time);
    pad.labels.update({&pad.field, 1}, time, s.dt);
    touching = touching || pad.field.touching() > 0;
  }
  const BodyState& stage = s.bodies.front().state;
  const double shaking = s.motors ? s.motors->force(stage, touching, s.dt) : 0.0;
  for (State::Pad& pad : s.pads) pad.labels.ride(stage.pose.position.array(), shaking);
  ++s.tick;
}

void add_sim_catalogues(Catalogues& catalogues) {
  catalogues.materials = material_table();
  for (const SurfaceKind& kind : surface_catalogue()) catalogues.surfaces.push_back(kind.about);
  for (const MotionKind& kind : motion_catalogue()) catalogues.motions.push_back(kind.about);
  catalogues.bodies = body_catalogue();
  catalogues.grasp = grasp_catalogue();
  catalogues.protocols = protocol_catalogue();
  for (const EffectKind& kind : effect_catalogue()) catalogues.effects.push_back(kind.about);
}

}  // namespace slipbench
