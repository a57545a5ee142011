// DynamicBench with articulated pads.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/mujoco/dynamic_state.h"
#include "sim/mujoco/geom_surface.h"
#include "sim/mujoco/model_builder.h"
#include "sim/testbench/stage_setup.h"

namespace slipbench {

void DynamicBench::State::find_pillars(const Scene& scene) {
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const int site = mj_name2id(m(), mjOBJ_SITE, site_of(scene.sensors[i]).c_str());
    auto pillars = std::make_unique<ArticulatedContact>(m(), pillars_of(scene.sensors[i]), *layouts[i], ArticulatedSettings{});
    pads.push_back({nullptr, std::move(pillars), site, m()->site_bodyid[site], 0.0, reach_of(*layouts[i])});
  }
}

// Tips that stand inside what they touch at the start.
void DynamicBench::State::press_tips_in() {
  call_mujoco([this] { mj_kinematics(m(), d()); });
  for (const Pad& pad : pads) {
    const std::vector<int>& tips = pad.pillars->bodies();
    for (int pair = 0; pair < m()->npair; ++pair) {
      // The first tip's pairs name all that the pad touches. MuJoCo orders the geoms of a pair by their types.
      const int one = m()->pair_geom1[pair], two = m()->pair_geom2[pair];
      const bool first = m()->geom_bodyid[one] == tips.front();
      if (!first && m()->geom_bodyid[two] != tips.front()) continue;
      const int geom = first ? two : one;
      const GeomSurface surface = surface_of_geom(m(), geom);
      const Pose placed = pose_at(d()->geom_xpos + 3 * geom, d()->geom_xmat + 9 * geom) * surface.in_geom;
      pad.pillars->begin_on(d(), surface.shape, placed.inverse() * pad_pose(pad));
    }
  }
}

// Steps in which only the tips move, without weights, so that they take up their loads before the run begins.
void DynamicBench::State::settle_tips() {
  std::vector<bool> of_tip(static_cast<std::size_t>(m()->nv), false);
  for (const Pad& pad : pads) {
    for (const int body : pad.pillars->bodies()) std::fill_n(of_tip.begin() + m()->body_dofadr[body], 3, true);
  }
  std::vector<mjtNum> qpos(d()->qpos, d()->qpos + m()->nq), qvel(d()->qvel, d()->qvel + m()->nv);
  const std::vector<mjtNum> armature(m()->dof_armature, m()->dof_armature + m()->nv);
  mjtNum gravity[3];
  mju_copy3(gravity, m()->opt.gravity);
  mju_zero3(model->opt.gravity);
  std::fill_n(d()->qvel, m()->nv, 0.0);
  for (int dof = 0; dof < m()->nv; ++dof) {
    if (!of_tip[static_cast<std::size_t>(dof)]) m()->dof_armature[dof] += stage_mass;
  }
  for (int k = 0; k < ArticulatedSettings{}.settling_steps; ++k) {
    call_mujoco([this] { mj_step(m(), d()); });
    refuse_warnings(m(), d(), 0.0);
    read_pillars(0.0);
  }
  std::ranges::copy(armature, m()->dof_armature);
  mju_copy3(model->opt.gravity, gravity);
  for (const Pad& pad : pads) {
    for (const int body : pad.pillars->bodies()) {
      const int address = m()->jnt_qposadr[m()->body_jntadr[body]];
      std::copy_n(d()->qpos + address, 3, qpos.begin() + address);
    }
  }
  std::ranges::copy(qpos, d()->qpos);
  std::ranges::copy(qvel, d()->qvel);
  d()->time = 0.0;
}

// The recipe's soft friction is right for tips alone: a box that is dragged over a table under it rocks and slides at a fraction of
// mu f_n, and creeps before.
void DynamicBench::State::refuse_other_contacts(double time) const {
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
        fmt::format("at {:.6g} s the bodies {} and {} touch by MuJoCo's own contact, whose friction would be wrong beside "
                    "articulated pads; allowed: contacts of pads alone, or without friction (condim 1), or fidelity: field",
                    time, name(one), name(two)));
  }
}

// The model with articulated pads. Their joints and contacts are implicit: only the recipe limits the step.
StepPlan DynamicBench::State::plan_pillars(const Scene& scene, std::span<const double> rates) {
  refuse_without_field(scene);
  judge_fields = false;
  StepPlan plan;
  model = build_articulated_model(scene, layouts, [&](double bearable) {
    plan = plan_steps(scene, rates, rounded_down(bearable), "articulated pads on these bodies");
    return plan.dt;
  });
  begin(scene);
  return plan;
}

}  // namespace slipbench
