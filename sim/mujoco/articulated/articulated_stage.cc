#include "sim/mujoco/articulated/articulated_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/math/rotation.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/mujoco_warnings.h"
#include "sim/stage/stage_setup.h"
#include "sim/stage/step_plan.h"

namespace slipbench {
namespace {

// kg and kg m^2. A pad's forces (tens of N) change the prescribed velocity by 1e-8 m/s in a step of
// 1 ms.
constexpr double carrier_mass = 1e6;

struct GeomShape {
  mjtGeom type;
  std::array<double, 3> size;
};

GeomShape geom_shape(const Plane&) { return {mjGEOM_PLANE, {0.0, 0.0, 1.0}}; }
GeomShape geom_shape(const Box& box) { return {mjGEOM_BOX, {box.half.x(), box.half.y(), box.half.z()}}; }
GeomShape geom_shape(const Cylinder& cylinder) { return {mjGEOM_CYLINDER, {cylinder.radius, cylinder.half_length, 0.0}}; }
GeomShape geom_shape(const Sphere& sphere) { return {mjGEOM_SPHERE, {sphere.radius, 0.0, 0.0}}; }
GeomShape geom_shape(const Capsule& capsule) { return {mjGEOM_CAPSULE, {capsule.radius, capsule.half_length, 0.0}}; }
GeomShape geom_shape(const Ellipsoid& e) { return {mjGEOM_ELLIPSOID, {e.half.x(), e.half.y(), e.half.z()}}; }
GeomShape geom_shape(const DistanceGrid&) {
  throw std::invalid_argument("the articulated stage has no geom for a distance grid");
}

// Returns the number of MuJoCo's steps into which one of `dt` [s] at `speed` [m/s] is divided.
int parts_of(double dt, double speed, const ArticulatedSettings& recipe) {
  if (!(dt > 0.0)) throw std::invalid_argument("the articulated stage needs a step longer than 0 s");
  const double parts = std::max(dt / recipe.longest_step, dt * speed / recipe.longest_path);
  return static_cast<int>(std::ceil(parts * (1.0 - 1e-9)));
}

}  // namespace

struct ArticulatedStage::World {
  PadLayout layout;
  Surface surface;
  double dt;
  int parts;  // MuJoCo's steps per step of the simulation
  ModelPointer model;
  DataPointer data;
  std::unique_ptr<ArticulatedContact> contact;
  int carrier = -1;  // its free joint
  bool placed = false;
  Pose pose;
  ContactFrame frame;

  void place(const Pose& pad, double time);
  void step_part(const Pose& from, const Pose& to, double time);
};

ArticulatedStage::ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt, double speed)
    : ArticulatedStage(layout, surface, friction, dt, speed, ArticulatedSettings{}) {}

ArticulatedStage::ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt, double speed,
                                   const ArticulatedSettings& recipe)
    : ArticulatedStage(layout, surface, friction, articulated_pillars(recipe, dt / parts_of(dt, speed, recipe)),
                       parts_of(dt, speed, recipe)) {}

ArticulatedStage::ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction,
                                   const PillarSettings& pillars)
    : ArticulatedStage(layout, surface, friction, pillars, 1) {}

ArticulatedStage::ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction,
                                   const PillarSettings& pillars, int parts)
    : world_(std::make_unique<World>()) {
  World& w = *world_;
  w.layout = layout;
  w.surface = surface;
  w.parts = parts;
  w.dt = pillars.dt;

  const SpecPointer spec(mj_makeSpec());
  set_pillar_options(spec.get(), pillars);
  mju_zero3(spec->option.gravity);
  mjsBody* base = mjs_findBody(spec.get(), "world");
  mjsGeom* touched = mjs_addGeom(base, nullptr);
  mjs_setName(touched->element, "surface");
  const GeomShape shape = std::visit([](const auto& s) { return geom_shape(s); }, surface);
  touched->type = shape.type;
  mju_copy3(touched->size, shape.size.data());
  touched->contype = 0;
  touched->conaffinity = 0;

  mjsBody* carrier = mjs_addBody(base, nullptr);
  mjs_setName(carrier->element, "carrier");
  mjs_addFreeJoint(carrier);
  carrier->mass = carrier_mass;
  carrier->explicitinertial = 1;
  carrier->inertia[0] = carrier->inertia[1] = carrier->inertia[2] = carrier_mass;
  const std::string name = "surface";
  add_articulated_pad(spec.get(), carrier, Pose{}, layout, {&name, 1}, friction, pillars, "pad");

  call_mujoco([&] { w.model.reset(mj_compile(spec.get(), nullptr)); });
  if (!w.model)
    throw SceneValueError("fidelity", std::string("MuJoCo cannot compile the articulated pad: ") + mjs_getError(spec.get()));
  call_mujoco([&w] { w.data.reset(mj_makeData(w.model.get())); });
  w.contact = std::make_unique<ArticulatedContact>(w.model.get(), "pad", layout, pillars);
  w.carrier = w.model->body_jntadr[mj_name2id(w.model.get(), mjOBJ_BODY, "carrier")];
  if (pillars.carrier_in_scale) return;
  call_mujoco([&w] { mj_forward(w.model.get(), w.data.get()); });
  leave_out_of_scale(w.model.get(), w.data.get(), w.model->jnt_dofadr[w.carrier]);
}

ArticulatedStage::~ArticulatedStage() = default;

const ContactFrame& ArticulatedStage::frame() const { return world_->frame; }

// Presses in the tips inside the surface; then the contacts take up the rest of their load while
// the pad is at rest.
void ArticulatedStage::World::place(const Pose& pad, double time) {
  const int steps = contact->steps_to_settle(contact->begin_on(model.get(), data.get(), surface, pad));
  for (int k = 0; k < steps; ++k) {
    end_if_interrupted();
    step_part(pad, pad, time);
    contact->read(model.get(), data.get(), time, dt);
  }
  contact->begin_run(time);
}

void ArticulatedStage::World::step_part(const Pose& from, const Pose& to, double time) {
  drive_free_joint(model.get(), data.get(), carrier, from, to, dt);
  data->time = time - dt;
  call_mujoco([this] { mj_step(model.get(), data.get()); });
  refuse_warnings(model.get(), data.get(), time);
}

const ContactFrame& ArticulatedStage::step(const Pose& pad_in_surface, double time) {
  World& w = *world_;
  if (!w.placed) {
    w.place(pad_in_surface, time);
    w.placed = true;
    w.pose = pad_in_surface;
    return w.frame = w.contact->frame();
  }
  const Pose from = std::exchange(w.pose, pad_in_surface);

  std::vector<ContactEvent> events;
  Eigen::Array2Xd slip = Eigen::Array2Xd::Zero(2, static_cast<Eigen::Index>(w.layout.units.size()));
  Pose here = from;
  for (int k = 1; k <= w.parts; ++k) {
    const double share = static_cast<double>(k) / w.parts;
    const double now = time - (w.parts - k) * w.dt;
    Pose there = pad_in_surface;
    if (k < w.parts) {
      there.position = from.position + share * (pad_in_surface.position - from.position);
      there.rotation = interpolated_rotation(from.rotation, pad_in_surface.rotation, share);
    }
    w.step_part(here, there, now);
    const ContactFrame& part = w.contact->read(w.model.get(), w.data.get(), now, w.dt);
    slip += part.slip_velocity / w.parts;
    events.insert(events.end(), part.events.begin(), part.events.end());
    here = there;
  }
  w.frame = w.contact->frame();
  w.frame.slip_velocity = slip;
  for (std::size_t u = 0; u < w.frame.unit_state.size(); ++u) {
    const UnitState state = w.frame.unit_state[u];
    // slip that has ended within the step
    if (state == UnitState::detached || state == UnitState::stick) w.frame.slip_velocity.col(static_cast<Eigen::Index>(u)) = 0.0;
  }
  w.frame.events = std::move(events);
  return w.frame;
}

namespace {

// Returns what to do if a run with contact settings of the user diverges. Except with the integrator
// `discrete`, springs [N/m] on the tips are explicit, so stable up to 2 sqrt(m/k).
std::string remedy_for(const Parameters& contact, double stiffest, double dt) {
  const double stable = 2.0 * std::sqrt(contact.number("tip_mass") / stiffest);
  if (contact.choice("integrator") == "discrete" || dt <= stable)
    return "; use a shorter time_step, or the settings of sim/mujoco/articulated/mujoco_contact.md";
  return fmt::format(
      "; with contact.integrator: {} and contact.tip_mass: {} the step must be at most {} (2 sqrt(m/k)); use a shorter time_step, integrator: discrete, or the settings of sim/mujoco/articulated/mujoco_contact.md",
      contact.choice("integrator"), format_quantity(contact.number("tip_mass"), Quantity::mass),
      bound_in_unit_of("1 ms", stable, Quantity::time, Bound::upper));
}

// MuJoCo's steps are at most 2 ms and 0.1 mm long, however long those of the sensors are.
void refuse_too_many_parts(const Scene& scene, double speed) {
  const ArticulatedSettings recipe;
  const double per_second = std::max(1.0 / recipe.longest_step, speed / recipe.longest_path);
  if (scene.contact || scene.duration * per_second <= max_steps) return;
  throw SceneValueError(
      "duration",
      fmt::format("{} needs more than 100,000,000 of MuJoCo's steps, in which a tip moves by at most {}; allowed: up to {}",
                  readable_quantity(scene.duration, Quantity::time), readable_quantity(recipe.longest_path, Quantity::length),
                  bound_in_unit_of("1 s", max_steps / per_second, Quantity::time, Bound::upper)));
}

class ArticulatedSimulation final : public Simulation {
 public:
  ArticulatedSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                        std::uint64_t trial) {
    refuse_without_field(scene);
    StageSetup stage = set_up_stage(scene, trial);
    motion_ = std::move(stage.motion);
    refuse_motors(*motion_);
    world_in_surface_ = stage.surface.pose.inverse();
    for (std::size_t i = 0; i < pads.size(); ++i) {
      const double speed = motion_->top_speed(reach_of(*pads[i]));
      clocks_.add(plan_steps(scene, output_rates.subspan(i, 1), step_limit(*motion_, {}, reach_of(*pads[i])), i));
      refuse_too_many_parts(scene, speed);
      refuse_inside(*pads[i], stage.surface, {}, motion_->pad_at(0.0).pose);
      const Friction friction{scene.friction.static_coefficient, scene.friction.kinetic_coefficient};
      const double dt = clocks_.time_step(i);
      pads_.push_back(scene.contact ? std::make_unique<ArticulatedStage>(*pads[i], stage.surface.shape, friction,
                                                                         user_pillars(*scene.contact, dt))
                                    : std::make_unique<ArticulatedStage>(*pads[i], stage.surface.shape, friction, dt, speed));
    }
    if (scene.contact) {
      double stiffest = 0.0, longest = 0.0;
      for (std::size_t i = 0; i < pads.size(); ++i) {
        longest = std::max(longest, clocks_.time_step(i));
        for (const Element& element : pads[i]->elements) {
          stiffest = std::max({stiffest, element.k_normal, element.k_tangential});
        }
      }
      remedy_ = remedy_for(*scene.contact, stiffest, longest);
    }
    bodies_ = {{"pad", motion_->pad_at(0.0)},
               {"surface", {stage.surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
  }

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override { return clocks_.ticks(pad); }
  [[nodiscard]] double time_step(std::size_t pad) const override { return clocks_.time_step(pad); }
  [[nodiscard]] std::size_t stride(std::size_t pad) const override { return clocks_.stride(pad); }
  [[nodiscard]] std::span<const std::size_t> stepped() const override { return clocks_.stepped(); }
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override { return pads_[pad]->frame(); }
  // "pad" and "surface".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override { return bodies_; }
  [[nodiscard]] bool rotating() const override { return motion_->turns(); }

  void step() override {
    const double time = clocks_.advance();
    bodies_.front().state = motion_->pad_at(time);
    const Pose pad_in_surface = world_in_surface_ * bodies_.front().state.pose;
    try {
      for (const std::size_t pad : clocks_.stepped()) pads_[pad]->step(pad_in_surface, time);
    } catch (const std::runtime_error& error) {
      throw FailedRun(std::string("the simulation has diverged: ") + error.what() + remedy_);
    }
  }

 private:
  std::unique_ptr<Motion> motion_;
  Pose world_in_surface_;
  std::vector<std::unique_ptr<ArticulatedStage>> pads_;
  std::vector<NamedBody> bodies_;
  PadClocks clocks_;
  std::string remedy_;  // against divergence
};

}  // namespace

std::unique_ptr<Simulation> articulated_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> output_rates, std::uint64_t trial) {
  return std::make_unique<ArticulatedSimulation>(scene, pads, output_rates, trial);
}

}  // namespace slipbench
