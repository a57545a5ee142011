#include "sim/mujoco/bodies/dynamic_simulation.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <mujoco/mujoco.h>

#include "sim/mujoco/bodies/pad_follower.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/modes/articulated_pads.h"
#include "sim/mujoco/modes/dynamic_setup.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/explicit_field_pads.h"
#include "sim/mujoco/modes/field_plan.h"
#include "sim/mujoco/modes/grasp_field_pads.h"
#include "sim/mujoco/modes/implicit_field_pads.h"
#include "sim/mujoco/modes/run_watch.h"
#include "sim/mujoco/modes/runge_kutta_field_pads.h"
#include "sim/mujoco/pads/field_plugin.h"
#include "sim/stage/stage_setup.h"

namespace slipbench {

struct DynamicSimulation::State {
  // A sensor of the scene that is read.
  struct Read {
    bool follows;
    std::size_t index;  // into followers, else into the pads that exert forces
  };

  LayoutsInMemory layouts_in_memory;  // of the model's fields
  std::unique_ptr<Motion> motion;     // of the stage; null without a stage
  std::vector<const PadLayout*> layouts;
  std::size_t read = 0;  // number of pads that are read
  // Accelerations of the carriages of the fingers' springs.
  std::array<Vector6d, 2> carriages{Vector6d::Zero(), Vector6d::Zero()};
  std::optional<DynamicWorld> world;
  std::unique_ptr<DynamicPads> pads;
  std::optional<RunWatch> watch;
  std::vector<Read> sensors;
  std::vector<std::unique_ptr<PadFollower>> followers;
  std::vector<std::size_t> stepped;
  StepPlan steps;
  std::size_t tick = 0;
  bool at_tick = true;  // the current instant is a tick of the simulation, not only of followers

  Scene carrying(const Scene& scene, std::span<const PadLayout* const> pad_layouts, std::size_t read_sensors);
  void make_articulated(const DynamicSetup& setup);
  void make_fields(const DynamicSetup& setup);
  void find_followers(const Scene& scene, std::span<const PadLayout* const> pad_layouts, std::span<const double> rates);
  void take_tick();
};

// Returns the scene of the pads that exert forces, without the sensors that only read.
// `read_sensors`: number of the scene's sensors that are read.
Scene DynamicSimulation::State::carrying(const Scene& scene, std::span<const PadLayout* const> pad_layouts,
                                         std::size_t read_sensors) {
  Scene result = scene;
  result.sensors.clear();
  std::size_t following = 0;
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const bool follows = !scene.sensors[i].follows.empty();
    if (i < read_sensors) sensors.push_back({follows, follows ? following++ : result.sensors.size()});
    if (follows) continue;
    if (i < read_sensors) ++read;
    result.sensors.push_back(scene.sensors[i]);
    layouts.push_back(pad_layouts[i]);
  }
  return result;
}

void DynamicSimulation::State::make_articulated(const DynamicSetup& setup) {
  ArticulatedPlan plan = plan_articulated(setup);
  steps = std::move(plan.steps);
  world.emplace(setup.scene, setup.motion, std::move(plan.model));
  world->measure_scale();
  world->restart(setup.scene, steps.dt);
  pads = std::make_unique<ArticulatedPads>(*world, setup);
}

void DynamicSimulation::State::make_fields(const DynamicSetup& setup) {
  world.emplace(setup.scene, setup.motion,
                build_model(setup.scene, setup.layouts, setup.trial, setup.options.hand, layouts_in_memory));
  const FieldContacts contacts(*world, setup);
  world->measure_scale();
  FieldPlan plan = plan_fields(*world, contacts, setup);
  steps = std::move(plan.steps);
  world->restart(setup.scene, steps.dt);
  const mjtIntegrator integrator = static_cast<mjtIntegrator>(world->m()->opt.integrator);
  const bool is_free = setup.options.hand != nullptr && integrator == mjINT_EULER;
  if (plan.averages && !is_free) throw std::logic_error("implicit springs of a grasp under another integrator than Euler");
  if (is_free) {
    pads = std::make_unique<GraspFieldPads>(*world, setup, plan, carriages);
  } else if (setup.scene.implicit_fields()) {
    pads = std::make_unique<ImplicitFieldPads>(*world, setup, plan.stored_energy_known);
  } else if (integrator == mjINT_RK4) {
    pads = std::make_unique<RungeKuttaFieldPads>(*world, setup, plan.stored_energy_known);
  } else {
    pads = std::make_unique<ExplicitFieldPads>(*world, setup, plan.stored_energy_known);
  }
}

void DynamicSimulation::State::find_followers(const Scene& scene, std::span<const PadLayout* const> pad_layouts,
                                              std::span<const double> rates) {
  const mjModel* m = world->m();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!sensors[i].follows) continue;
    const PadInstance* pad = pad_of(m, world->d(), mj_name2id(m, mjOBJ_PLUGIN, scene.sensors[i].follows.c_str()));
    const double speed = motion ? motion->top_speed(reach_of(*pad_layouts[i]) + scene.sensors[i].ahead) : 0.0;
    followers.push_back(
        std::make_unique<PadFollower>(m, *pad, *pad_layouts[i], scene.sensors[i].ahead, rates[i], speed, world->dt()));
  }
}

DynamicSimulation::DynamicSimulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                     std::span<const double> output_rates, std::uint64_t trial,
                                     const DynamicSimulationOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  const Scene carrying = s.carrying(scene, pads, output_rates.size());
  std::vector<double> rates;
  for (std::size_t i = 0; i < output_rates.size(); ++i) {
    if (!s.sensors[i].follows) rates.push_back(output_rates[i]);
  }
  const bool staged = std::ranges::any_of(carrying.sensors, [](const SensorScene& sensor) { return sensor.site.empty(); });
  if (staged) {
    s.motion = make_motion(scene, trial);
    refuse_motors(*s.motion);
  }
  const DynamicSetup setup{carrying, s.layouts, s.read, std::move(rates), trial, s.motion.get(), options};
  scene.fidelity == "field" ? s.make_fields(setup) : s.make_articulated(setup);
  s.find_followers(scene, pads, output_rates);
  s.world->record(carrying, s.pads->sites());
  s.pads->begin();
  s.watch.emplace(*s.world, *s.pads, options.limits);
}

DynamicSimulation::~DynamicSimulation() = default;

std::size_t DynamicSimulation::ticks(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->ticks(s.world->time_of(s.steps.ticks - 1)) : s.steps.ticks;
}
double DynamicSimulation::time_step(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->time_step() : s.world->dt();
}
std::size_t DynamicSimulation::stride(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->stride() : s.steps.strides[s.sensors[pad].index];
}
const ContactFrame& DynamicSimulation::contact_part(std::size_t pad, FramePart part) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->contact() : s.pads->truth(s.sensors[pad].index, part);
}
void DynamicSimulation::disable_slip_angle() { state_->pads->disable_slip_angle(); }
double DynamicSimulation::normal_force(std::size_t carrying) const { return state_->pads->normal_force(carrying); }
double DynamicSimulation::contact_normal_force(const std::string& body, const std::string& other) const {
  const mjModel* m = model();
  const mjData* d = data();
  const int one = mj_name2id(m, mjOBJ_BODY, body.c_str()), two = mj_name2id(m, mjOBJ_BODY, other.c_str());
  double force = 0.0;
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.efc_address < 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int first = m->geom_bodyid[contact.geom[0]], second = m->geom_bodyid[contact.geom[1]];
    if (!((first == one && second == two) || (first == two && second == one))) continue;
    mjtNum wrench[6];
    mj_contactForce(m, d, c, wrench);
    force += wrench[0];
  }
  return force;
}
std::span<const std::size_t> DynamicSimulation::stepped() const { return state_->stepped; }
bool DynamicSimulation::at_tick() const { return state_->at_tick; }
const std::vector<NamedBody>& DynamicSimulation::bodies() const { return state_->world->bodies(); }
bool DynamicSimulation::rotating() const { return state_->motion && state_->motion->turns(); }
const mjModel* DynamicSimulation::model() const { return state_->world->m(); }
mjData* DynamicSimulation::data() const { return state_->world->d(); }

void DynamicSimulation::set_carriage_acceleration(std::size_t finger, const Vector6d& acceleration) {
  state_->carriages[finger] = acceleration;
}

// Steps from one tick of the simulation to the next.
void DynamicSimulation::State::take_tick() {
  const double time = world->time_of(tick);
  world->outdate_bodies();
  pads->take_tick(tick, *watch);
  for (const auto& follower : followers) follower->look(time);
  ++tick;
}

// The simulation takes its tick first; then the followers take theirs up to it, in order of
// time; the simulation's own tick is reported last.
void DynamicSimulation::step() {
  State& s = *state_;
  if (s.at_tick) s.take_tick();
  double first = std::numeric_limits<double>::infinity();
  for (const auto& follower : s.followers) {
    if (follower->due_before()) first = std::min(first, follower->due());
  }
  s.at_tick = std::isinf(first);
  s.stepped.clear();
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    if (!s.sensors[i].follows) {
      if (s.at_tick) s.stepped.push_back(i);
      continue;
    }
    PadFollower& follower = *s.followers[s.sensors[i].index];
    if (s.at_tick ? follower.due_now() : follower.due() == first) {
      follower.step();
      s.stepped.push_back(i);
    } else if (s.at_tick) {
      follower.catch_up();
    }
  }
}

}  // namespace slipbench
