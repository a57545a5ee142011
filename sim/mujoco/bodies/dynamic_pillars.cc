// DynamicSimulation with articulated pads.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/mujoco/bodies/dynamic_state.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/mujoco_warnings.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/stage/stage_setup.h"

namespace slipbench {
namespace {

// Tolerance of the main solver while tips settle. With the recipe's tolerance the pressing forces
// wander by 0.08 mN at rest, with this one by 1e-8 N.
constexpr double rest_tolerance = 1e-14;

}  // namespace

void DynamicSimulation::State::find_pillars(const Scene& scene) {
  const PillarSettings settings = pillars_of_scene(scene, m()->opt.timestep);
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const int site = mj_name2id(m(), mjOBJ_SITE, site_of(scene.sensors[i]).c_str());
    auto pillars = std::make_unique<ArticulatedContact>(m(), pillars_of(scene.sensors[i]), *layouts[i], settings);
    pads.push_back({nullptr, std::move(pillars), site, m()->site_bodyid[site], 1, scene.sensors[i].name});
  }
}

// Indents the tips that are inside the touched surface at the start. Returns true if there are any.
bool DynamicSimulation::State::indent_tips(const mjModel* held, mjData* settled) const {
  bool any = false;
  call_mujoco([&] { mj_kinematics(held, settled); });
  for (const Pad& pad : pads) {
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
void DynamicSimulation::State::settle_tips() {
  const ModelPointer held(mj_copyModel(nullptr, m()));
  std::vector<bool> of_tip(static_cast<std::size_t>(m()->nv), false);
  for (const Pad& pad : pads) {
    for (const int body : pad.pillars->bodies()) std::fill_n(of_tip.begin() + m()->body_dofadr[body], 3, true);
  }
  for (int dof = 0; dof < m()->nv; ++dof) {
    if (!of_tip[static_cast<std::size_t>(dof)]) held->dof_armature[dof] += stage_mass;
  }
  mju_zero3(held->opt.gravity);
  held->opt.tolerance = rest_tolerance;
  DataPointer settled;
  call_mujoco([&] {
    settled.reset(mj_makeData(held.get()));
    mj_setConst(held.get(), settled.get());  // MuJoCo precomputes the inertia of some bodies
  });
  held->stat = m()->stat;  // see leave_out_of_scale()
  for (const Pad& pad : pads) pad.pillars->suit_to_held(held.get());

  std::copy_n(d()->qpos, m()->nq, settled->qpos);
  const int steps = pads.front().pillars->steps_to_settle(indent_tips(held.get(), settled.get()));
  std::vector<mjtNum> qpos(settled->qpos, settled->qpos + m()->nq), qvel(static_cast<std::size_t>(m()->nv), 0.0);
  for (int k = 0; k < steps; ++k) {
    end_if_interrupted();
    std::ranges::copy(qpos, settled->qpos);
    std::ranges::copy(qvel, settled->qvel);
    call_mujoco([&] { mj_step(held.get(), settled.get()); });
    try {
      refuse_warnings(held.get(), settled.get(), dt * k);
    } catch (const InputError& error) {
      throw FailedRun(std::string("the tips do not come to rest before the run: ") + error.what());
    }
    for (const Pad& pad : pads) {
      pad.pillars->read(held.get(), settled.get(), 0.0, dt);
      for (const int body : pad.pillars->bodies()) {
        const int position = m()->jnt_qposadr[m()->body_jntadr[body]], velocity = m()->body_dofadr[body];
        std::copy_n(settled->qpos + position, 3, qpos.begin() + position);
        std::copy_n(settled->qvel + velocity, 3, qvel.begin() + velocity);
      }
    }
  }
  for (const Pad& pad : pads) {
    pad.pillars->take_tip_loads(m(), d(), held.get(), settled.get());
    pad.pillars->begin_run(0.0);
  }
}

// The recipe's soft friction is accurate for tips only: a box dragged over a table under it rocks
// and slides at a fraction of mu f_n, and creeps before.
void DynamicSimulation::State::refuse_other_contacts(double time) const {
  for (int c = 0; c < d()->ncon; ++c) {
    const mjContact& contact = d()->contact[c];
    if (contact.efc_address < 0 || contact.dim == 1 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int one = m()->geom_bodyid[contact.geom[0]], two = m()->geom_bodyid[contact.geom[1]];
    if (is_tip(one) || is_tip(two)) continue;
    const auto name = [this](int body) {
      const char* text = mj_id2name(m(), mjOBJ_BODY, body);
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
void DynamicSimulation::State::refuse_overcompressed(double time) const {
  for (std::size_t i = 0; i < pads.size(); ++i) {
    const std::optional<std::size_t> element = pads[i].pillars->overcompressed(m(), d());
    if (!element) continue;
    throw SceneValueError(
        "sensors." + pads[i].sensor,
        fmt::format("at {:.6g} s element {} is compressed by more than the height of a unit of the pad, {:.3g} mm; press less",
                    time, *element, 1e3 * layouts[i]->unit_height));
  }
}

// The model with articulated pads. Their joints and contacts are implicit: only the recipe limits
// the step. With a contact set by the user, who chooses its step, only the springs of a hand limit
// it, since the scene does not set these.
StepPlan DynamicSimulation::State::plan_pillars(const Scene& scene, std::span<const double> rates,
                                                const DynamicSimulationOptions& options) {
  const Hand* const hand = options.hand;
  refuse_without_field(scene);
  judge_fields = false;
  StepPlan plan;
  const auto step_for = [&](double bearable) {
    std::string limited_by = "articulated pads on these bodies";
    if (hand != nullptr) {
      bearable = longest_explicit_step(finger_vibration(hand->grip));
      limited_by = "the springs of the fingers, which are explicit";
    }
    StepLimit by_motion = limit_of_motion(options);
    for (const PadLayout* pad : layouts) {
      if (!motion || scene.contact) break;
      const double speed = motion->top_speed(reach_of(*pad)), longest = ArticulatedSettings{}.longest_path / speed;
      if (speed > 0.0 && longest < by_motion.longest) {
        by_motion = {rounded_down(longest),
                     "articulated pads at the speed of the motion, at which a tip must move by at most 0.1 mm within a step"};
      }
    }
    plan = plan_steps(scene, rates, by_motion.longest < bearable ? by_motion : StepLimit{rounded_down(bearable), limited_by});
    return plan.dt;
  };
  model = build_articulated_model(scene, layouts, step_for, hand);
  begin(scene);
  return plan;
}

}  // namespace slipbench
