// MuJoCo's model and data of a scene, and all in it that does not depend on how its pads are
// modelled.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/api/motion.h"
#include "sim/api/simulation.h"
#include "sim/core/error.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/mujoco_warnings.h"
#include "sim/scene/scene.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

class DynamicWorld {
 public:
  // Takes the model and makes data at the scene's start: the stage, which follows `motion` if that
  // is not null, and the velocities of the scene's bodies. Throws SceneValueError if the scene's
  // controls do not fit the model.
  DynamicWorld(const Scene& scene, const Motion* motion, ModelPointer model);
  DynamicWorld(const DynamicWorld&) = delete;
  DynamicWorld& operator=(const DynamicWorld&) = delete;

  [[nodiscard]] const mjModel* m() const { return model_.get(); }
  [[nodiscard]] mjData* d() const { return data_.get(); }
  [[nodiscard]] double dt() const { return dt_; }  // s, after restart()
  [[nodiscard]] double time_of(std::size_t tick) const { return TickTimes(dt_).at(tick); }
  [[nodiscard]] Eigen::Vector3d gravity() const {  // m/s2
    if ((m()->opt.disableflags & mjDSBL_GRAVITY) != 0) return Eigen::Vector3d::Zero();
    return Eigen::Map<const Eigen::Vector3d>(m()->opt.gravity);
  }
  // The motion of the stage; null without a stage.
  [[nodiscard]] const Motion* motion() const { return motion_; }
  [[nodiscard]] int stage_joint() const { return stage_joint_; }
  [[nodiscard]] int stage_dof() const { return stage_dof_; }  // first of its six

  // Computes everything at the present state; the stage does not count in MuJoCo's tolerances from
  // then on.
  void measure_scale();
  // Makes the data anew at the scene's start, for steps of `dt` [s].
  void restart(const Scene& scene, double dt);

  // Selects the recorded bodies, the pads at `sites` among them. Throws SceneValueError if two have
  // the same name or if the model names an unknown one.
  void record(const Scene& scene, std::span<const int> sites);
  // The recorded bodies at the current tick.
  [[nodiscard]] const std::vector<NamedBody>& bodies();
  void outdate_bodies() { outdated_ = true; }

  void apply_controls(double time);
  // Runs `step_bodies`, the step that begins at `time` [s]. Throws SceneValueError for an error of a
  // pad, which knows no scene, and InputError for a warning of MuJoCo.
  template <class Step>
  void step(double time, Step&& step_bodies) {
    try {
      step_bodies();
    } catch (const SceneValueError&) {
      throw;
    } catch (const FailedRun&) {
      throw;
    } catch (const InputError& error) {
      throw SceneValueError("sensors", error.what());
    }
    refuse_warnings(m(), d(), time);
  }
  // The same by MuJoCo's own step.
  void step(double time) {
    step(time, [this] { call_mujoco([this] { mj_step(m(), d()); }); });
  }
  // Puts the stage where its motion is at `time` [s].
  void prescribe(double time);

 private:
  struct Control {
    int actuator;
    std::vector<ControlScene::Point> points;
  };
  // A recorded body: its frame, or a site.
  struct Recorded {
    mjtObj type;
    int id;
  };

  void start(const Scene& scene);
  void find_controls(const Scene& scene);

  const Motion* motion_;
  ModelPointer model_;
  DataPointer data_;
  double dt_ = 0.0;
  int stage_joint_ = -1, stage_qpos_ = -1, stage_dof_ = -1;
  std::vector<Control> controls_;
  std::vector<Recorded> recorded_;
  std::vector<NamedBody> bodies_;
  bool outdated_ = false;  // bodies_ are those of an earlier tick
};

}  // namespace slipbench
