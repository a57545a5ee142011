// The implementation of DynamicSimulation, shared by dynamic_simulation.cc (the run, and pads as
// fields), dynamic_pillars.cc (articulated pads) and watch.cc.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/motion.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "sim/mujoco/bodies/pad_follower.h"
#include "sim/mujoco/bodies/watch.h"
#include "sim/mujoco/linear/average_acceleration.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/modes/free_bodies.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/pad_instance.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

struct DynamicSimulation::State {  // all members are public, for the sources that implement the class
  using MjMatrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  using MjVector = Eigen::Map<const Eigen::Vector3d>;
  static Pose pose_at(const mjtNum* position, const mjtNum* rotation) { return {MjMatrix(rotation), MjVector(position)}; }
  // Rounds down to three digits: a value that a message allows must be valid when it is typed in.
  static double rounded_down(double value);

  // A field and one of the geoms that it touches.
  struct Contact {
    std::size_t pad;
    std::size_t field;  // of the pad
    int object_body;
    // N, of the elements' springs and dashpots, in the world, at the last checked tick
    Eigen::Vector3d on_pad = Eigen::Vector3d::Zero();
  };

  struct Pad {
    PadInstance* instance;                        // null: articulated
    std::unique_ptr<ArticulatedContact> pillars;  // null: a field
    int site;
    int body;
    std::size_t stride = 1;
    std::string sensor = {};  // its name, of articulated pads
  };

  struct Control {
    int actuator;
    std::vector<ControlScene::Point> points;
  };

  // A recorded body: its frame, or a site.
  struct Recorded {
    mjtObj type;
    int id;
  };

  struct WeighedBody {
    int body;
    int dof;  // first of its six
    WeightRule rule;
  };

  std::unique_ptr<Motion> motion;  // of the stage; null without a stage
  HandedLayouts handed;
  ModelPointer model;
  DataPointer data;
  std::vector<const PadLayout*> layouts;
  std::size_t read = 0;                // number of pads that are read
  std::optional<FingerSpring> spring;  // of every finger, if there is a hand
  std::vector<Pad> pads;

  // A sensor of the scene that is read.
  struct Read {
    bool follows;
    std::size_t index;  // into followers, else into pads
  };
  std::vector<Read> sensors;
  std::vector<std::unique_ptr<PadFollower>> followers;
  std::vector<std::size_t> stepped;
  bool at_tick = true;  // the current instant is a tick of the simulation, not only of followers
  std::vector<Contact> contacts;
  std::vector<Control> controls;
  std::vector<Recorded> recorded;
  std::vector<NamedBody> bodies;
  bool to_read = false;  // bodies are those of an earlier tick
  int stage_joint = -1, stage_qpos = -1, stage_dof = -1;
  double dt = 0.0;
  std::size_t ticks = 0, tick = 0;
  // RK4: a step gives the truth at its end, and leaves the data there.
  bool leads = false;
  // Pads keep their state from the first step on: before it, the owner of the data may still move
  // bodies.
  bool to_keep = false;
  bool articulated = false;
  bool own_contact = false;  // articulated, with the contact set by the scene
  bool implicit = false;
  bool averages = false;                  // implicit springs of a grasp
  std::vector<int> fingers;               // bodies
  std::optional<FreeBodies> free_bodies;  // of a grasp without MuJoCo's contacts
  std::optional<HeldBodies> held_bodies;  // with implicit springs
  // Accelerations of the carriages of the fingers' springs.
  std::array<Vector6d, 2> carriages{Vector6d::Zero(), Vector6d::Zero()};
  // Inertia added by the springs of each contact, about the held body, or the body on which that
  // stands.
  std::vector<Matrix6d> added{};
  bool limited = false;             // the fields' springs limit the step, and the limit is obeyed
  std::size_t touching_before = 0;  // elements, at the last tick

  std::vector<WeighedBody> weighed;
  std::vector<int> moving;  // bodies that the ejection rule watches
  std::optional<EnergyRule> energy;
  WatchedEnergy pending;  // works of the step that began at the last checked tick
  // Velocities of the last step, `after` with the stage as MuJoCo left it.
  Eigen::VectorXd before, after;
  Eigen::VectorXd field_force;  // generalized, of that step
  // of the last step
  Vector6d stage_force = Vector6d::Zero(), stage_way = Vector6d::Zero();
  Eigen::VectorXd mean, work_space;
  double last_slip_loss = 0.0;  // J, of the last step
  std::vector<double> centres;  // [3 nbody] m, at the last tick

  [[nodiscard]] const mjModel* m() const { return model.get(); }
  [[nodiscard]] mjData* d() const { return data.get(); }
  [[nodiscard]] Eigen::Vector3d gravity() const {
    if ((m()->opt.disableflags & mjDSBL_GRAVITY) != 0) return Eigen::Vector3d::Zero();
    return MjVector(m()->opt.gravity);
  }
  [[nodiscard]] Pose pad_pose(const Pad& pad) const {
    return pose_at(d()->site_xpos + 3 * pad.site, d()->site_xmat + 9 * pad.site);
  }

  void make_data();
  void begin(const Scene& scene);
  StepPlan plan_fields(const Scene& scene, std::span<const double> rates, std::uint64_t trial,
                       const DynamicSimulationOptions& options);
  StepPlan plan_pillars(const Scene& scene, std::span<const double> rates, const DynamicSimulationOptions& options);
  [[nodiscard]] StepLimit limit_of_motion(const DynamicSimulationOptions& options) const;
  void find_pads(const Scene& scene);
  void find_fields(const Scene& scene);
  void find_pillars(const Scene& scene);
  bool indent_tips(const mjModel* held, mjData* settled) const;
  void settle_tips();
  void refuse_other_contacts(double time) const;
  void refuse_overcompressed(double time) const;
  [[nodiscard]] bool is_tip(int body) const {
    return articulated && std::ranges::any_of(pads, [body](const Pad& pad) {
             return std::ranges::find(pad.pillars->bodies(), body) != pad.pillars->bodies().end();
           });
  }
  [[nodiscard]] Scene carrying(const Scene& scene, std::span<const PadLayout* const> pad_layouts, std::size_t read_sensors);
  void find_followers(const Scene& scene, std::span<const PadLayout* const> pad_layouts, std::span<const double> rates);
  void take_tick();
  void find_controls(const Scene& scene);
  void find_bodies(const Scene& scene);
  void refuse_implicit() const;
  void start(const Scene& scene);
  void read_pillars(double time) {
    for (const Pad& pad : pads) pad.pillars->read(m(), d(), time, dt);
  }
  void prescribe(double time);
  [[nodiscard]] double time_of(std::size_t at) const { return TickTimes(dt).at(at); }
  void advance(std::size_t from);
  void step_free();
  void average();
  [[nodiscard]] bool choose_implicit(const Scene& scene, FieldSolver wished, std::span<const double> rates, double longest,
                                     const Vibration& fastest) const;
  [[nodiscard]] double longest_right_step(const Vibration& vibration) const {
    return averages ? longest_averaged_step(vibration) : longest_explicit_step(vibration);
  }
  [[nodiscard]] PadTangents stuck_pads(bool touching_only) const;
  void check_limit(double time);
  [[nodiscard]] static const ContactFrame& truth_of(const Pad& pad, FramePart part) {
    return pad.pillars ? pad.pillars->frame() : pad.instance->truth(part);
  }
  [[nodiscard]] bool touching() const {
    return std::ranges::any_of(pads,
                               [](const Pad& pad) { return truth_of(pad, FramePart::states).state != PadState::no_contact; });
  }
  void read_bodies();  // updates `bodies` to the current tick
  // Updates poses and velocities from the step's start to its end. Forces and contacts stay those
  // of the step.
  void follow() {
    call_mujoco([this] {
      mj_kinematics(m(), d());
      mj_comPos(m(), d());
      mj_comVel(m(), d());
    });
  }

  bool judge_fields = true;  // the energy stored in the pads is known
  void find_watched(const WatchLimits& limits);
  void watch_step(double time, const Eigen::VectorXd& velocity);
  void watch(double time, const Eigen::VectorXd& velocity);
  void find_field_force();
  void note_works();
  void weigh(double time, const Eigen::VectorXd& velocity);
  [[nodiscard]] double weight_work();
};

}  // namespace slipbench
