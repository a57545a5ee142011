#include "sim/mujoco/dynamic_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/effects/install.h"
#include "sim/motion/motion.h"
#include "sim/mujoco/field_plugin.h"
#include "sim/mujoco/geom_surface.h"
#include "sim/mujoco/implicit.h"
#include "sim/mujoco/model_builder.h"
#include "sim/mujoco/stability.h"
#include "sim/testbench/stage_setup.h"
#include "sim/testbench/step_plan.h"

namespace slipbench {
namespace {

// By how much the step may exceed the longest right one once the run is on its way and bodies have moved to other poses: h omega =
// 1. Beyond that a slide begins to come out wrong by percents (shared MUJOCO.md, section B).
constexpr double limit_slack = 4.0 / 3.0;

// Down to three digits: what a message allows must be allowed when it is typed in.
double rounded_down(double value) {
  if (!std::isfinite(value) || value <= 0.0) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::stod(fmt::format("{:.2e}", std::floor(value / unit) * unit));
}

using MjMatrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using MjVector = Eigen::Map<const Eigen::Vector3d>;

Pose pose_at(const mjtNum* position, const mjtNum* rotation) { return {MjMatrix(rotation), MjVector(position)}; }

// A control's value at time t [s].
double value_at(const std::vector<ControlScene::Point>& points, double t) {
  const auto next = std::ranges::upper_bound(points, t, {}, &ControlScene::Point::time);
  if (next == points.begin()) return points.front().value;
  const ControlScene::Point& from = *std::prev(next);
  if (next == points.end()) return from.value;
  return from.value + (next->value - from.value) * ((t - from.time) / (next->time - from.time));
}

// A pad and one of the geoms that it touches.
struct Contact {
  std::size_t pad;
  std::size_t field;  // of the pad
  int object_body;
};

struct Pad {
  PadInstance* instance;
  int site;
  int body;
  double damping_constant;  // N s/m, tau K
  double reach;             // m
  std::size_t stride;
};

struct Control {
  int actuator;
  std::vector<ControlScene::Point> points;
};

// A body that is recorded: its frame, or a site.
struct Recorded {
  mjtObj type;
  int id;
};

struct WeighedBody {
  int body;
  int dof;  // the first of its six
  WeightRule rule;
  WatchedBody now;
};

}  // namespace

struct DynamicBench::State {
  std::unique_ptr<Motion> motion;  // of the stage; null: there is none
  ModelPointer model;
  DataPointer data;
  std::vector<const PadLayout*> layouts;
  std::vector<Pad> pads;
  std::vector<Contact> contacts;
  std::vector<Control> controls;
  std::vector<Recorded> recorded;
  std::vector<NamedBody> bodies;
  int stage_qpos = -1, stage_dof = -1;
  double dt = 0.0;
  std::size_t ticks = 0, tick = 0;
  bool leads = false;  // RK4: a step tells the truth of its end
  bool implicit = false;
  bool limited = false;             // explicit fields, and the limit is obeyed
  std::size_t touching_before = 0;  // elements, at the tick before

  std::vector<WeighedBody> weighed;
  std::vector<int> moving;  // bodies that the ejection rule watches
  std::optional<EnergyRule> energy;
  WatchedEnergy pending;          // works of the step that began at the tick looked at last
  Eigen::VectorXd before, after;  // velocities of the last step, `after` with the stage as MuJoCo left it
  Eigen::VectorXd field_force;    // generalized, of that step
  Vector6d stage_force = Vector6d::Zero(), stage_way = Vector6d::Zero();  // of the step before
  Eigen::VectorXd mean, work_space;
  double last_slip_loss = 0.0;  // J, of the step before
  std::vector<double> centres;  // [3 nbody] m, at the tick before

  [[nodiscard]] const mjModel* m() const { return model.get(); }
  [[nodiscard]] mjData* d() const { return data.get(); }
  [[nodiscard]] Pose pad_pose(const Pad& pad) const {
    return pose_at(d()->site_xpos + 3 * pad.site, d()->site_xmat + 9 * pad.site);
  }

  void find_pads(const Scene& scene);
  void find_controls(const Scene& scene);
  void find_bodies(const Scene& scene);
  void refuse_implicit() const;
  void start(const Scene& scene);
  void leave_stage_out_of_scale();
  void prescribe(double time);
  [[nodiscard]] double time_of(std::size_t at) const { return static_cast<double>(at) * dt; }
  void advance(std::size_t from);
  [[nodiscard]] Vibration vibration(bool touching_only) const;
  void check_limit(double time);
  [[nodiscard]] bool touching() const {
    return std::ranges::any_of(pads, [](const Pad& pad) { return pad.instance->truth().state != PadState::no_contact; });
  }
  void read_bodies();

  void find_watched(const WatchLimits& limits, bool judge_fields);
  void watch(double time, const Eigen::VectorXd& velocity);
  void find_field_force();
  void note_works();
  void weigh(double time, const Eigen::VectorXd& velocity);
  [[nodiscard]] double weight_work();
};

// Pads of the model in the scene's order, and what they touch.
void DynamicBench::State::find_pads(const Scene& scene) {
  pad_group_of(m(), d())->allow_long_steps();  // the bench sees to the step itself, before the first one
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const int instance = mj_name2id(m(), mjOBJ_PLUGIN, scene.sensors[i].name.c_str());
    PadInstance* pad = pad_of(m(), d(), instance);
    double stiffness = 0.0;
    for (const Element& element : layouts[i]->elements) stiffness += element.k_normal;
    const double damping = scene.sensors[i].damping;
    pad->watch();
    pads.push_back(
        {pad, pad->config().site, m()->site_bodyid[pad->config().site], damping * stiffness, reach_of(*layouts[i]), 1});
    for (std::size_t k = 0; k < pad->config().geoms.size(); ++k) {
      contacts.push_back({i, k, m()->geom_bodyid[pad->config().geoms[k]]});
    }
  }
}

void DynamicBench::State::find_controls(const Scene& scene) {
  for (const ControlScene& control : scene.controls) {
    const std::string path = "controls." + control.actuator;
    const int id = mj_name2id(m(), mjOBJ_ACTUATOR, control.actuator.c_str());
    if (id < 0) {
      std::vector<std::string> known;
      for (int k = 0; k < m()->nu; ++k) {
        if (const char* name = mj_id2name(m(), mjOBJ_ACTUATOR, k)) known.emplace_back(name);
      }
      throw SceneValueError(path,
                            "the model has no actuator " + quote(control.actuator) + allowed_names(control.actuator, known));
    }
    const mjtNum* range = m()->actuator_ctrlrange + 2 * id;
    for (const ControlScene::Point& point : control.points) {
      // MuJoCo would clamp it and not say so.
      if (m()->actuator_ctrllimited[id] && !(point.value >= range[0] && point.value <= range[1])) {
        throw SceneValueError(path, fmt::format("{} is beyond the actuator's range; allowed: {} to {}",
                                                format_number(point.value), format_number(range[0]), format_number(range[1])));
      }
    }
    controls.push_back({id, control.points});
  }
}

void DynamicBench::State::find_bodies(const Scene& scene) {
  const auto add = [this](const std::string& name, mjtObj type, int id, const std::string& path) {
    if (std::ranges::find(bodies, name, &NamedBody::name) != bodies.end()) {
      throw SceneValueError(path, quote(name) + " names two bodies of the trial's record; allowed: another name");
    }
    bodies.push_back({name, {}});
    recorded.push_back({type, id});
  };
  if (motion) add("pad", mjOBJ_XBODY, mj_name2id(m(), mjOBJ_BODY, stage_name), "sensors");
  for (std::size_t i = 0; i < pads.size(); ++i) {
    if (!scene.sensors[i].site.empty()) add(scene.sensors[i].name, mjOBJ_SITE, pads[i].site, "sensors." + scene.sensors[i].name);
  }
  for (const BodyScene& body : scene.bodies) {
    add(body.name, mjOBJ_XBODY, mj_name2id(m(), mjOBJ_BODY, body.name.c_str()), "bodies." + body.name);
  }
  for (int body = 1; body < m()->nbody; ++body) {
    const char* name = mj_id2name(m(), mjOBJ_BODY, body);
    const bool is_free = m()->body_jntnum[body] == 1 && m()->jnt_type[m()->body_jntadr[body]] == mjJNT_FREE;
    const bool known = name == nullptr || name == std::string(stage_name) ||
                       std::ranges::find(scene.bodies, std::string(name), &BodyScene::name) != scene.bodies.end();
    if (is_free && !known) add(name, mjOBJ_XBODY, body, "model");
  }
}

void DynamicBench::State::refuse_implicit() const {
  std::vector<ImplicitPad> joined;
  for (const Contact& contact : contacts) {
    const Pad& pad = pads[contact.pad];
    const Pose body = pose_at(d()->xpos + 3 * pad.body, d()->xmat + 9 * pad.body);
    joined.push_back({pad.body, contact.object_body, body.inverse() * pad_pose(pad), layouts[contact.pad]});
  }
  std::string why = implicit_refusal(m(), joined);
  if (why.empty()) why = implicit_self_test(m(), joined);
  if (!why.empty()) throw SceneValueError("field_solver", why);
}

// With every element of every pad stuck, as stiff as it can get, where a pad that is away would come down on what it touches: from
// afar it would turn the object by a lever that it will never have. Or with the elements that touch, where they are.
Vibration DynamicBench::State::vibration(bool touching_only) const {
  std::vector<PadOnBodies> on_bodies;
  std::vector<PadTangent> tangents;
  for (const Contact& contact : contacts) {
    const Pad& pad = pads[contact.pad];
    Pose pose = pad_pose(pad);
    PadLayout layout = *layouts[contact.pad];
    if (!touching_only) {
      const int geom = pad.instance->config().geoms[contact.field];
      const GeomSurface surface = surface_of_geom(m(), geom);
      const Pose placed = pose_at(d()->geom_xpos + 3 * geom, d()->geom_xmat + 9 * geom) * surface.in_geom;
      const Eigen::Vector3d origin = placed.inverse() * pose.position,
                            axis = -(placed.rotation.transpose() * pose.rotation.col(2));
      const SurfacePoint met = std::visit(
          [&](const auto& shape) { return shape.at(origin.x(), origin.y(), origin.z(), axis.x(), axis.y(), axis.z()); },
          surface.shape);
      if (met.gap > 0.0) pose.position -= met.gap * (placed.rotation * Eigen::Vector3d(met.nx, met.ny, met.nz));
    } else {
      const Field& field = pad.instance->fields()[contact.field];
      std::size_t i = 0;
      std::erase_if(layout.elements, [&](const Element&) { return field.state(i++) == ElementState::detached; });
    }
    on_bodies.push_back({pad.body, contact.object_body, pose.position});
    tangents.push_back(stuck_tangent(layout, pose, pose.position, pad.instance->config().damping));
  }
  return fastest_vibration(m(), d(), on_bodies, tangents);
}

void DynamicBench::State::check_limit(double time) {
  if (!limited) return;
  std::size_t touching = 0;
  for (const Contact& contact : contacts) {
    const Field& field = pads[contact.pad].instance->fields()[contact.field];
    for (std::size_t i = 0; i < field.size(); ++i) touching += field.state(i) != ElementState::detached ? 1 : 0;
  }
  const bool more = touching > touching_before;
  touching_before = touching;
  if (!more) return;
  const double longest = limit_slack * longest_explicit_step(vibration(true));
  if (dt > longest) {
    throw SceneValueError(
        "time_step",
        fmt::format("{} has become too long for the pads' explicit springs at {:.6g} s; allowed are up to {}",
                    format_quantity(dt, Quantity::time), time, format_quantity(rounded_down(longest), Quantity::time)));
  }
}

// The scene's own start: velocities of its bodies, and the stage.
void DynamicBench::State::start(const Scene& scene) {
  for (const BodyScene& body : scene.bodies) {
    const int id = mj_name2id(m(), mjOBJ_BODY, body.name.c_str());
    if (m()->body_dofnum[id] == 6) std::ranges::copy(body.shape.parameters.vector("velocity"), d()->qvel + m()->body_dofadr[id]);
  }
  if (motion) {
    const int joint = m()->body_jntadr[mj_name2id(m(), mjOBJ_BODY, stage_name)];
    stage_qpos = m()->jnt_qposadr[joint];
    stage_dof = m()->jnt_dofadr[joint];
    prescribe(0.0);
  }
}

// MuJoCo's solver measures what is small by the mean inertia. With the stage in it the solver would stop before it has begun, and
// bodies would sink into each other without a warning.
void DynamicBench::State::leave_stage_out_of_scale() {
  if (!motion) return;
  RowMatrix inertia(m()->nv, m()->nv);
  mj_fullM(m(), d(), inertia.data());
  const double others = inertia.trace() - inertia.diagonal().segment<6>(stage_dof).sum();
  model->stat.meaninertia = m()->nv > 6 ? others / static_cast<double>(m()->nv - 6) : 1.0;
}

void DynamicBench::State::prescribe(double time) {
  if (!motion) return;
  const BodyState stage = motion->pad_at(time);
  const Eigen::Quaterniond turn(stage.pose.rotation);
  const Eigen::Vector3d spin =
      stage.pose.rotation.transpose() * stage.angular_velocity;  // of a free joint: in the body's own frame
  const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  mju_copy3(d()->qpos + stage_qpos, stage.pose.position.data());
  mju_copy4(d()->qpos + stage_qpos + 3, quaternion);
  mju_copy3(d()->qvel + stage_dof, stage.velocity.data());
  mju_copy3(d()->qvel + stage_dof + 3, spin.data());
}

// One step of MuJoCo, from a tick to the next.
void DynamicBench::State::advance(std::size_t from) {
  const double time = time_of(from);
  for (const Control& control : controls) d()->ctrl[control.actuator] = value_at(control.points, time);
  // RK4's pads have been committed at the end of the step before, at the time that MuJoCo gave it.
  if (!leads) d()->time = time;
  before = Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
  call_mujoco([this] { mj_step(m(), d()); });
  refuse_warnings(m(), d(), time);
  after = Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
  if (implicit && d()->nefmcon == 0 && touching()) {
    throw InputError(
        fmt::format("the pads' implicit springs are not in MuJoCo's solver at {:.6g} s; allowed: field_solver explicit", time));
  }
  prescribe(time_of(from + 1));
}

void DynamicBench::State::read_bodies() {
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const auto [type, id] = recorded[i];
    mjtNum velocity[6];
    mj_objectVelocity(m(), d(), type, id, velocity, 0);
    const bool site = type == mjOBJ_SITE;
    BodyState& state = bodies[i].state;
    state.pose = pose_at((site ? d()->site_xpos : d()->xpos) + 3 * id, (site ? d()->site_xmat : d()->xmat) + 9 * id);
    state.angular_velocity = MjVector(velocity);
    state.velocity = MjVector(velocity + 3);
  }
}

// ---- The watch ----

void DynamicBench::State::find_watched(const WatchLimits& limits, bool judge_fields) {
  energy.emplace(limits, judge_fields);
  const int stage = motion ? mj_name2id(m(), mjOBJ_BODY, stage_name) : -1;
  for (int body = 1; body < m()->nbody; ++body) {
    if (body == stage || m()->body_weldid[body] == 0) continue;
    moving.push_back(body);
    const bool is_free = m()->body_jntnum[body] == 1 && m()->jnt_type[m()->body_jntadr[body]] == mjJNT_FREE;
    // With more bodies in the tree the six coordinates are not this body's alone.
    if (!is_free || m()->body_subtreemass[body] != m()->body_mass[body]) continue;
    WeighedBody weighed_body{body, m()->body_dofadr[body], WeightRule(limits), {}};
    weighed_body.now.mass = m()->body_mass[body];
    weighed_body.now.weight = weighed_body.now.mass * (1.0 - m()->body_gravcomp[body]) * MjVector(m()->opt.gravity);
    weighed.push_back(std::move(weighed_body));
  }
  const Eigen::Index nv = m()->nv;
  mean = work_space = field_force = Eigen::VectorXd::Zero(nv);
  before = after = Eigen::Map<Eigen::VectorXd>(d()->qvel, nv);
  centres.assign(d()->xipos, d()->xipos + 3 * m()->nbody);
}

// Work of the weights since the tick before [J].
double DynamicBench::State::weight_work() {
  const MjVector gravity(m()->opt.gravity);
  double work = 0.0;
  for (const int body : moving) {
    const MjVector now(d()->xipos + 3 * body);
    work += m()->body_mass[body] * (1.0 - m()->body_gravcomp[body]) *
            gravity.dot(now - MjVector(&centres[3 * static_cast<std::size_t>(body)]));
  }
  return work;
}

// The generalized force of all fields in the step that has been taken.
void DynamicBench::State::find_field_force() {
  const auto force = [this](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, m()->nv); };
  const auto others = force(d()->qfrc_spring) + force(d()->qfrc_damper) + force(d()->qfrc_gravcomp) + force(d()->qfrc_fluid);
  if (!implicit) {
    field_force = force(d()->qfrc_passive) - others;
    return;
  }
  field_force.setZero();
  pad_group_of(m(), d())->add_applied(m(), d(), field_force.data());
}

// Works of the step that has been taken. That of the fields on the stage waits for the force at the step's end: what moves as
// prescribed does not answer the force at its start, and the trapezoid is what the springs take up.
void DynamicBench::State::note_works() {
  const auto force = [this](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, m()->nv); };
  mean = 0.5 * (before + force(d()->qvel));
  pending = {};
  pending.field_work = dt * field_force.dot(mean);
  if (motion) {
    stage_force = field_force.segment<6>(stage_dof);
    stage_way = dt * mean.segment<6>(stage_dof);
    pending.field_work -= stage_force.dot(stage_way);
  }
  pending.supply = dt * std::max(0.0, (force(d()->qfrc_spring) + force(d()->qfrc_actuator) + force(d()->qfrc_applied)).dot(mean));
  pending.contact_supply = dt * std::max(0.0, force(d()->qfrc_constraint).dot(mean));
}

void DynamicBench::State::weigh(double time, const Eigen::VectorXd& velocity) {
  for (WeighedBody& body : weighed) {
    WatchedBody& now = body.now;
    const auto linear = [&body](const mjtNum* values) { return MjVector(values + body.dof); };
    now.force = linear(d()->qfrc_constraint) + linear(d()->qfrc_actuator) + linear(d()->qfrc_applied) + linear(d()->qfrc_spring) +
                linear(d()->qfrc_damper) + linear(d()->qfrc_fluid);
    now.dashpots.clear();
    for (const Contact& contact : contacts) {
      const Pad& pad = pads[contact.pad];
      if (contact.object_body != body.body && pad.body != body.body) continue;
      const Field& field = pad.instance->fields()[contact.field];
      const Eigen::Vector3d on_pad = pad_pose(pad).rotation * field.wrench_on_pad().force;
      now.force += pad.body == body.body ? on_pad : Eigen::Vector3d(-on_pad);
      now.dashpots.push_back({pad.damping_constant, pad.reach, field.pad_in_surface()});
    }
    // The coordinates are those of the body's frame; its momentum is that of its centre.
    const MjMatrix rotation(d()->xmat + 9 * body.body);
    const Eigen::Vector3d arm = MjVector(d()->xipos + 3 * body.body) - MjVector(d()->xpos + 3 * body.body);
    const Eigen::Vector3d spin = rotation * velocity.segment<3>(body.dof + 3);
    now.momentum = now.mass * (velocity.segment<3>(body.dof) + spin.cross(arm));
    if (const auto wrong = body.rule.check(now, dt)) {
      const char* name = mj_id2name(m(), mjOBJ_BODY, body.body);
      throw InputError(
          fmt::format("the run has gone wrong at {:.6g} s: body '{}' {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
}

// Looks at the tick at `time`, when the bodies had the given velocity, after the step that tells its truth.
void DynamicBench::State::watch(double time, const Eigen::VectorXd& velocity) {
  WatchedEnergy now = pending;
  now.supply += std::max(0.0, weight_work());
  if (motion) {
    const double on_stage = 0.5 * (stage_force + field_force.segment<6>(stage_dof)).dot(stage_way);
    now.field_work += on_stage;
    now.supply += std::max(0.0, -on_stage);
  }
  double slip_loss = 0.0;  // with the speed at the end of the step
  for (const Contact& contact : contacts) {
    const Field& field = pads[contact.pad].instance->fields()[contact.field];
    const std::vector<Element>& elements = field.layout().elements;
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (field.state(i) == ElementState::detached) continue;
      const double pressed = field.normal_force(i);
      const Eigen::Vector3d dragged = field.tangential_force(i);
      now.elastic += 0.5 * (pressed * pressed / elements[i].k_normal + dragged.squaredNorm() / elements[i].k_tangential);
      slip_loss += dragged.dot(field.slip_step(i));
    }
  }
  // The fields' work is taken with the mean speed of a step, and so must be what is lost: else a slide that gains dv seems to give mu f_n h dv/2.
  now.slip_loss = 0.5 * (slip_loss + std::exchange(last_slip_loss, slip_loss));
  mean = velocity;
  if (motion) mean.segment<6>(stage_dof).setZero();
  mj_mulM(m(), d(), work_space.data(), mean.data());
  now.kinetic = 0.5 * mean.dot(work_space);
  if (const auto wrong = energy->check(now, dt)) {
    throw InputError(fmt::format("the run has gone wrong at {:.6g} s: {}", time, *wrong));
  }
  for (const int body : moving) {
    const MjVector centre(d()->xipos + 3 * body);
    const double speed = (centre - MjVector(&centres[3 * static_cast<std::size_t>(body)])).norm() / dt;
    if (const auto wrong = energy->check_body(0.5 * m()->body_mass[body] * speed * speed)) {
      const char* name = mj_id2name(m(), mjOBJ_BODY, body);
      throw InputError(
          fmt::format("the run has gone wrong at {:.6g} s: body '{}' {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
  weigh(time, velocity);
  centres.assign(d()->xipos, d()->xipos + 3 * m()->nbody);
}

// ---- The bench ----

DynamicBench::DynamicBench(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                           std::uint64_t trial, const DynamicBenchOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.layouts.assign(pads.begin(), pads.end());
  s.implicit = scene.implicit_fields;
  const bool staged = std::ranges::any_of(scene.sensors, [](const SensorScene& sensor) { return sensor.site.empty(); });
  if (staged) s.motion = make_motion(scene);
  s.model = build_model(scene, pads, trial);
  const auto make_data = [&s] { call_mujoco([&s] { s.data.reset(mj_makeData(s.model.get())); }); };
  make_data();
  s.find_pads(scene);
  s.find_controls(scene);
  s.start(scene);
  call_mujoco([&s] { mj_forward(s.model.get(), s.data.get()); });
  s.leave_stage_out_of_scale();

  double longest = std::numeric_limits<double>::infinity();
  bool judge_fields = true;
  for (const PadLayout* pad : pads) {
    const FieldEffects effects = install_effects(scene.effects, *pad, Plane{}, scene.seed, trial);
    longest = std::min(longest, longest_step(effects, s.motion ? s.motion->top_speed(reach_of(*pad)) : 0.0));
    judge_fields = judge_fields && effects.surface.empty() && effects.rheology.empty();
  }
  std::string limited_by = "the scene's effects";
  s.limited = options.refuse_long_steps && !s.implicit;
  if (s.limited) {
    const Vibration vibration = s.vibration(false);
    if (const double limit = longest_explicit_step(vibration); limit < longest) {
      longest = rounded_down(limit);
      limited_by = fmt::format(
          "explicit springs of the pads, which vibrate at up to {:.4g} rad/s on their bodies and are damped at {:.4g} /s "
          "(`field_solver: implicit` has no such limit)",
          vibration.omega, vibration.damping_rate);
    }
  }
  if (s.implicit) s.refuse_implicit();
  const StepPlan plan = plan_steps(scene, output_rates, longest, limited_by);
  s.dt = plan.dt;
  s.ticks = plan.ticks;

  // The pads take the step when the data is made.
  s.model->opt.timestep = s.dt;
  s.pads.clear();
  s.contacts.clear();
  make_data();
  s.find_pads(scene);
  s.start(scene);
  for (std::size_t i = 0; i < pads.size(); ++i) s.pads[i].stride = plan.strides[i];
  s.find_bodies(scene);
  s.leads = s.model->opt.integrator == mjINT_RK4;
  call_mujoco([&s] { mj_forward(s.model.get(), s.data.get()); });
  s.find_watched(options.limits, judge_fields);
}

DynamicBench::~DynamicBench() = default;

std::size_t DynamicBench::ticks() const { return state_->ticks; }
double DynamicBench::time_step() const { return state_->dt; }
std::size_t DynamicBench::stride(std::size_t pad) const { return state_->pads[pad].stride; }
const ContactFrame& DynamicBench::contact(std::size_t pad) const { return state_->pads[pad].instance->truth(); }
const std::vector<NamedBody>& DynamicBench::bodies() const { return state_->bodies; }
bool DynamicBench::rotating() const { return state_->motion && state_->motion->turns(); }
const mjModel* DynamicBench::model() const { return state_->m(); }
mjData* DynamicBench::data() { return state_->d(); }

void DynamicBench::step() {
  State& s = *state_;
  const double time = s.time_of(s.tick);
  if (!s.leads) {
    s.advance(s.tick);
  } else if (s.tick > 0) {
    s.advance(s.tick - 1);
  }
  s.read_bodies();
  s.check_limit(time);
  s.find_field_force();
  if (s.leads && s.tick > 0) s.note_works();
  s.watch(time, s.leads ? s.after : s.before);
  if (!s.leads) s.note_works();
  ++s.tick;
}

}  // namespace slipbench
