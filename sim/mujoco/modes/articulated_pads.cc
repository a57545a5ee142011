#include "sim/mujoco/modes/articulated_pads.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/modes/run_watch.h"
#include "sim/mujoco/modes/spring_limit.h"
#include "sim/mujoco/mujoco_warnings.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/pad_kinematics.h"
#include "sim/stage/stage_setup.h"

namespace slipbench {
namespace {

// Tolerance of the main solver while tips settle. With the recipe's tolerance the pressing forces
// wander by 0.08 mN at rest, with this one by 1e-8 N.
constexpr double rest_tolerance = 1e-14;

}  // namespace

ArticulatedPlan plan_articulated(const DynamicSetup& setup) {
  const Scene& scene = setup.scene;
  const Hand* const hand = setup.options.hand;
  refuse_without_field(scene);
  ArticulatedPlan plan;
  const auto step_for = [&](double bearable) {
    std::string limited_by = "articulated pads on these bodies";
    if (hand != nullptr) {
      bearable = longest_explicit_step(finger_vibration(hand->grip));
      limited_by = "the springs of the fingers, which are explicit";
    }
    StepLimit by_motion = setup.limit_of_motion();
    for (const PadLayout* pad : setup.layouts) {
      if (setup.motion == nullptr || scene.contact) break;
      const double speed = setup.motion->top_speed(reach_of(*pad)), longest = ArticulatedSettings{}.longest_path / speed;
      if (speed > 0.0 && longest < by_motion.longest) {
        by_motion = {rounded_down(longest),
                     "articulated pads at the speed of the motion, at which a tip must move by at most 0.1 mm within a step"};
      }
    }
    plan.steps =
        plan_steps(scene, setup.rates, by_motion.longest < bearable ? by_motion : StepLimit{rounded_down(bearable), limited_by});
    return plan.steps.dt;
  };
  plan.model = build_articulated_model(scene, setup.layouts, step_for, hand);
  return plan;
}

ArticulatedPads::ArticulatedPads(DynamicWorld& world, const DynamicSetup& setup)
    : world_(world), own_contact_(setup.scene.contact.has_value()), runge_kutta_(world.m()->opt.integrator == mjINT_RK4) {
  const mjModel* m = world.m();
  const PillarSettings settings = pillars_of_scene(setup.scene, m->opt.timestep);
  for (std::size_t i = 0; i < setup.scene.sensors.size(); ++i) {
    const SensorScene& sensor = setup.scene.sensors[i];
    pads_.push_back({std::make_unique<ArticulatedContact>(m, pillars_of(sensor), *setup.layouts[i], settings),
                     mj_name2id(m, mjOBJ_SITE, site_of(sensor).c_str()), sensor.name, setup.layouts[i]});
  }
}

const ContactFrame& ArticulatedPads::truth(std::size_t pad, FramePart /*part*/) const { return pads_[pad].pillars->frame(); }

double ArticulatedPads::normal_force(std::size_t pad) const { return pads_[pad].pillars->normal_force(); }

std::vector<int> ArticulatedPads::sites() const {
  std::vector<int> result;
  for (const Pad& pad : pads_) result.push_back(pad.site);
  return result;
}

WatchSettings ArticulatedPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = limits, .judge_fields = false, .pads_predicted = runge_kutta_, .constraints_predicted = runge_kutta_};
}

bool ArticulatedPads::is_part(int body) const {
  return std::ranges::any_of(
      pads_, [body](const Pad& pad) { return std::ranges::find(pad.pillars->bodies(), body) != pad.pillars->bodies().end(); });
}

// Only that on the stage: all other forces of the pads are MuJoCo's springs and contacts.
void ArticulatedPads::find_force(Eigen::VectorXd& force) const {
  force.setZero();
  if (world_.motion() == nullptr) return;
  force.segment<6>(world_.stage_dof()) = Eigen::Map<const Vector6d>(world_.d()->qfrc_constraint + world_.stage_dof());
}

// Indents the tips that are inside the touched surface at the start. Returns true if there are any.
bool ArticulatedPads::indent_tips(const mjModel* held, mjData* settled) const {
  bool any = false;
  call_mujoco([&] { mj_kinematics(held, settled); });
  for (const Pad& pad : pads_) {
    const Pose pad_in_world = pose_at(settled->site_xpos + 3 * pad.site, settled->site_xmat + 9 * pad.site);
    const std::vector<int>& tips = pad.pillars->bodies();
    for (int pair = 0; pair < held->npair; ++pair) {
      // The first tip's pairs name all geoms that the pad touches. MuJoCo orders the geoms of a
      // pair by their types.
      const int one = held->pair_geom1[pair], two = held->pair_geom2[pair];
      const bool first = held->geom_bodyid[one] == tips.front();
      if (!first && held->geom_bodyid[two] != tips.front()) continue;
      const int geom = first ? two : one;
      const GeomSurface surface = surface_of_geom(held, geom);
      const Pose placed = pose_at(settled->geom_xpos + 3 * geom, settled->geom_xmat + 9 * geom) * surface.in_geom;
      any |= pad.pillars->begin_on(held, settled, surface.shape, placed.inverse() * pad_in_world);
    }
  }
  return any;
}

// Steps in which only the tips move, without weights, so that they take up their loads before the
// run begins. All other bodies are treated like the stage: heavy, so that contacts do not move
// them, and overwritten before every step. If they could yield within a step, the pads would push
// them to where the pads' forces balance.
void ArticulatedPads::begin() {
  const mjModel* m = world_.m();
  mjData* d = world_.d();
  const ModelPointer held(mj_copyModel(nullptr, m));
  std::vector<bool> of_tip(static_cast<std::size_t>(m->nv), false);
  for (const Pad& pad : pads_) {
    for (const int body : pad.pillars->bodies()) std::fill_n(of_tip.begin() + m->body_dofadr[body], 3, true);
  }
  for (int dof = 0; dof < m->nv; ++dof) {
    if (!of_tip[static_cast<std::size_t>(dof)]) held->dof_armature[dof] += stage_mass;
  }
  mju_zero3(held->opt.gravity);
  held->opt.tolerance = rest_tolerance;
  DataPointer settled;
  call_mujoco([&] {
    settled.reset(mj_makeData(held.get()));
    mj_setConst(held.get(), settled.get());  // MuJoCo precomputes the inertia of some bodies
  });
  held->stat = m->stat;  // see leave_out_of_scale()
  for (const Pad& pad : pads_) pad.pillars->suit_to_held(held.get());

  std::copy_n(d->qpos, m->nq, settled->qpos);
  const int steps = pads_.front().pillars->steps_to_settle(indent_tips(held.get(), settled.get()));
  std::vector<mjtNum> qpos(settled->qpos, settled->qpos + m->nq), qvel(static_cast<std::size_t>(m->nv), 0.0);
  for (int k = 0; k < steps; ++k) {
    end_if_interrupted();
    std::ranges::copy(qpos, settled->qpos);
    std::ranges::copy(qvel, settled->qvel);
    call_mujoco([&] { mj_step(held.get(), settled.get()); });
    try {
      refuse_warnings(held.get(), settled.get(), world_.dt() * k);
    } catch (const InputError& error) {
      throw FailedRun(std::string("the tips do not come to rest before the run: ") + error.what());
    }
    for (const Pad& pad : pads_) {
      pad.pillars->read(held.get(), settled.get(), 0.0, world_.dt());
      for (const int body : pad.pillars->bodies()) {
        const int position = m->jnt_qposadr[m->body_jntadr[body]], velocity = m->body_dofadr[body];
        std::copy_n(settled->qpos + position, 3, qpos.begin() + position);
        std::copy_n(settled->qvel + velocity, 3, qvel.begin() + velocity);
      }
    }
  }
  for (const Pad& pad : pads_) {
    pad.pillars->take_tip_loads(m, d, held.get(), settled.get());
    pad.pillars->begin_run(0.0);
  }
  call_mujoco([m, d] { mj_forward(m, d); });
}

void ArticulatedPads::take_tick(std::size_t tick, RunWatch& watch) {
  const double time = world_.time_of(tick);
  if (tick > 0) {
    step(tick - 1, watch);
    if (!runge_kutta_) watch.check_step_from(world_.time_of(tick - 1));
    // Updates poses and velocities from the step's start to its end. Forces and contacts stay those
    // of the step.
    call_mujoco([this] {
      mj_kinematics(world_.m(), world_.d());
      mj_comPos(world_.m(), world_.d());
      mj_comVel(world_.m(), world_.d());
    });
  }
  if (runge_kutta_) tick > 0 ? watch.check_step_to(time) : watch.check_start(time);
}

void ArticulatedPads::step(std::size_t from, RunWatch& watch) {
  const double start = world_.time_of(from), end = world_.time_of(from + 1);
  world_.apply_controls(start);
  world_.d()->time = start;
  // Tips stick through positions, which follow from velocities: they need the step's mean velocity.
  if (const Motion* const motion = world_.motion()) {
    drive_free_joint(world_.m(), world_.d(), world_.stage_joint(), motion->pad_at(start).pose, motion->pad_at(end).pose,
                     world_.dt());
  }
  watch.begin_step();
  world_.step(start);
  watch.end_step();
  if (!own_contact_) refuse_other_contacts(start);
  for (const Pad& pad : pads_) pad.pillars->read(world_.m(), world_.d(), end, world_.dt());
  if (!own_contact_) refuse_overcompressed(end);
  world_.prescribe(end);
}

// The recipe's soft friction is accurate for tips only: a box dragged over a table under it rocks
// and slides at a fraction of mu f_n, and creeps before.
void ArticulatedPads::refuse_other_contacts(double time) const {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.efc_address < 0 || contact.dim == 1 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int one = m->geom_bodyid[contact.geom[0]], two = m->geom_bodyid[contact.geom[1]];
    if (is_part(one) || is_part(two)) continue;
    const auto name = [m](int body) {
      const char* text = mj_id2name(m, mjOBJ_BODY, body);
      return quote(text == nullptr ? "" : text);
    };
    throw SceneValueError(
        "fidelity",
        fmt::format(
            "at {:.6g} s the bodies {} and {} touch by MuJoCo's own contact, whose friction is wrong with the settings of articulated pads; make that contact frictionless (condim 1), or use fidelity: field",
            time, name(one), name(two)));
  }
}

// As PadInstance::refuse_overcompressed().
void ArticulatedPads::refuse_overcompressed(double time) const {
  for (std::size_t i = 0; i < pads_.size(); ++i) {
    const std::optional<std::size_t> element = pads_[i].pillars->overcompressed(world_.m(), world_.d());
    if (!element) continue;
    throw SceneValueError(
        "sensors." + pads_[i].sensor,
        fmt::format("at {:.6g} s element {} is compressed by more than the height of a unit of the pad, {:.3g} mm; press less",
                    time, *element, 1e3 * pads_[i].layout->unit_height));
  }
}

}  // namespace slipbench
