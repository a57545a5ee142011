#include "sim/mujoco/bodies/grasp_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/api/motion.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/grasp/push.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/modes/finger_spring.h"
#include "sim/mujoco/pads/field_plugin.h"
#include "sim/stage/stage_setup.h"
#include "sim/stage/step_plan.h"

namespace slipbench {
namespace {

// Texture and roughness are on the top face of a shape, but the fingers touch its sides.
void refuse_textures(const Scene& scene, const PadLayout& pad) {
  for (const Named& effect : scene.effects) {
    if (!install_effects({effect}, pad, Plane{}, scene.seed, 0).surface.empty()) {
      throw SceneValueError(
          "effects", effect.name + " shapes a top face only, but a gripper touches the sides of the box; leave this effect out");
    }
  }
}

constexpr const char* box_name = "box";
constexpr const char* table_name = "table";
constexpr const char* corners_name = "box_corners";
constexpr double never = std::numeric_limits<double>::infinity();
constexpr double corner_damping = 3e-4;  // s, of the dashpots parallel to their springs (assumed)

BodyScene body(const char* name, const char* shape) {
  const auto entry = std::ranges::find(body_catalogue(), shape, &Entry::name);
  return {name, {shape, defaults_of(entry->parameters)}};
}

std::vector<double> values(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

SensorScene mounted(SensorScene sensor, const char* site, const char* touched, double damping) {
  sensor.site = site;
  sensor.touches = {touched};
  sensor.damping = damping;
  return sensor;
}

// Pads that exert forces, as DynamicSimulation counts them: the sensor's is 0.
constexpr std::size_t second_pad_index = 1, corners_index = 2;

// Returns the scene that DynamicSimulation steps: a box, a table, two pads at the fingers' sites,
// and the box's corners, unless MuJoCo's own contact is between box and table.
Scene laid_out(const Scene& scene, const Grasp& grasp) {
  if (std::ranges::find(scene.sensors, second_pad_name, &SensorScene::name) != scene.sensors.end()) {
    throw SceneValueError("sensors", "'second_pad' is the name of the pad on the other finger; choose another name");
  }
  const Parameters &grip = scene.grasp->grip, &box = scene.grasp->box;
  Scene result = scene;
  result.grasp.reset();
  result.field_solver = FieldSolver::explicit_springs;  // of MuJoCo's own solver
  result.friction.static_coefficient *= grasp.friction_scale;
  result.friction.kinetic_coefficient *= grasp.friction_scale;

  BodyScene table = body(table_name, "plane"), held = body(box_name, "box");
  const double table_height = grasp.box_position.z() - 0.5 * grasp.box_size.z();
  table.shape.parameters.set("position", std::vector<double>{0.0, 0.0, table_height});
  held.shape.parameters.set("size", values(grasp.box_size));
  held.shape.parameters.set("position", values(grasp.box_position));
  held.shape.parameters.set("centre_of_mass", values(grasp.centre_of_mass));
  held.shape.parameters.set("mass", box.number("mass"));
  held.shape.parameters.set("weight", box.number("weight"));
  held.shape.parameters.set("weight_place", box.vector("weight_place"));
  for (BodyScene* touching : {&table, &held}) touching->shape.parameters.set("friction", box.number("table_friction"));
  result.bodies = {std::move(table), std::move(held)};

  SensorScene second, corners;
  second.name = second_pad_name;
  corners.name = corners_name;
  corners.friction = {box.number("table_friction"), box.number("table_friction"), 1.0};
  SensorScene& sensor = result.sensors.front();
  sensor = mounted(sensor, finger_names[0].site, box_name, sensor.damping);
  result.sensors.push_back(mounted(second, finger_names[1].site, box_name, grip.number("pad_damping")));
  if (!scene.contact) result.sensors.push_back(mounted(corners, corner_site, table_name, corner_damping));
  return result;
}

double stiffness_of(const PadLayout& pad) {
  double sum = 0.0;
  for (const Element& element : pad.elements) sum += element.k_normal;
  return sum;
}

}  // namespace

struct GraspSimulation::State {  // all members are public, for the functions of the class below
  // One finger and its state in MuJoCo.
  struct Finger {
    int qpos, dof;
    std::size_t pad;     // index in DynamicSimulation
    double impact;       // N, force of its pad when it arrives at the fastest speed
    double most = 0.0;   // N, largest force of its spring so far
    Pose at_rest;        // of the carriage in the arm, fully closed
    BodyState carriage;  // now
    // of the carriage, at the last tick
    Vector6d speed = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  };

  State(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> rates, std::uint64_t trial,
        const DynamicSimulationOptions& options)
      : grasp(draw_grasp(*scene.grasp, scene.seed, trial)),
        gripper(scene.grasp->grip, grasp.opening, grasp.phase, grasp.drift),
        motion(make_motion(scene, trial)),
        guided(dynamic_cast<Guided*>(motion.get())),
        lift(guided != nullptr ? LiftTimes{never, never} : lift_times(scene.motion.parameters)),
        spring(finger_spring(scene.grasp->grip)),
        push(scene.grasp->box.table("push")),
        push_place(Eigen::Vector3d::Map(scene.grasp->box.vector("push_place").data())),
        layouts{*pads.front(), second_pad(scene.grasp->grip, *pads.front()), box_corners(scene.grasp->box, grasp.box_size)},
        own_contact(scene.contact.has_value()) {
    const Parameters& grip = scene.grasp->grip;
    const Hand hand{grip, grasp.yaw, grasp.pitch, gripper.opening(0.0), box_name};
    DynamicSimulationOptions with_hand = options;
    with_hand.hand = &hand;
    with_hand.arm = motion.get();
    with_hand.hand_solver = own_contact ? FieldSolver::explicit_springs : scene.field_solver;
    std::vector<const PadLayout*> all(pads.begin(), pads.end());
    all.push_back(&layouts[1]);
    if (!scene.contact) all.push_back(&layouts[2]);
    const Scene inner = laid_out(scene, grasp);
    simulation = std::make_unique<DynamicSimulation>(inner, all, rates, trial, with_hand);
    const mjModel* m = simulation->model();
    for (std::size_t k = 0; k < 2; ++k) {
      const int joint = m->body_jntadr[mj_name2id(m, mjOBJ_BODY, finger_names[k].body)];
      Finger& finger = fingers[k];
      finger.qpos = m->jnt_qposadr[joint];
      finger.dof = m->jnt_dofadr[joint];
      finger.pad = k == 0 ? 0 : second_pad_index;
      finger.impact = 0.5 * grip.number("fastest") * std::sqrt(stiffness_of(layouts[k]) * grip.number("finger_mass"));
      finger.at_rest = carriage_in_arm(hand, k, 0.0);
    }
    finger_weight = grip.number("finger_mass") * Eigen::Vector3d::Map(m->opt.gravity);
    bodies = {{"arm", motion->pad_at(0.0)}};
    for (std::size_t i = 0; i < simulation->bodies().size(); ++i) {
      if (simulation->bodies()[i].name == corners_name) continue;  // same as the box
      bodies.push_back(simulation->bodies()[i]);
      shown.push_back(i);
    }
    box = mj_name2id(m, mjOBJ_BODY, box_name);
    std::ranges::find(bodies, box_name, &NamedBody::name)->size = values(grasp.box_size);
    if (grip.choice("second_pad") == "silicone") {
      const std::vector<double>& face = grip.vector("pad_size");
      std::ranges::find(bodies, second_pad_name, &NamedBody::name)->size = {face[0], face[1], 0.0};
    }
    // If the scene's friction depends on the direction, that of the weight counts.
    const double reach = own_contact
                             ? 1.0
                             : pad_of(m, simulation->data(), mj_name2id(m, mjOBJ_PLUGIN, inner.sensors.front().name.c_str()))
                                   ->fields()
                                   .front()
                                   .cone_gauge(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), 1.0);
    ideal = reach * ideal_grip_force(scene, grasp.friction_scale, -m->opt.gravity[2]);
    start_height = grasp.box_position.z();
    table_height = start_height - 0.5 * grasp.box_size.z();
    if (guided == nullptr) least_lift = std::min(1e-3, 0.1 * scene.motion.parameters.number("distance"));
    // The last tick decides if the lift ends with the trial, or is cut short by it.
    const double last = TickTimes(simulation->time_step(0)).at(simulation->ticks(0) - 1);
    if (guided == nullptr) lift.end = std::min(lift.end, last);
  }

  [[nodiscard]] double lift_start() const { return guided != nullptr ? guided->lift_start() : lift.start; }
  void drive(double time);
  void push_box(double time);
  void observe(double time);
  [[nodiscard]] BodyState finger_now(const Finger& finger) const;

  Grasp grasp;
  Gripper gripper;
  std::unique_ptr<Motion> motion;  // of the arm
  Guided* guided;                  // the same, if the controller commands it
  LiftTimes lift;                  // of a prescribed lift
  FingerSpring spring;
  Push push;
  Eigen::Vector3d push_place;        // m, from the box's middle, in its axes
  std::array<PadLayout, 3> layouts;  // the sensor's, the second pad's, the corners'
  std::unique_ptr<DynamicSimulation> simulation;
  std::array<Finger, 2> fingers{};
  bool own_contact;                // MuJoCo's, of the pads and between box and table
  Eigen::Vector3d finger_weight;   // N
  std::vector<NamedBody> bodies;   // the arm, then those of the simulation
  std::vector<std::size_t> shown;  // index of each in the simulation
  int box;                         // MuJoCo's body
  std::size_t tick = 0;
  double ideal = 0.0, start_height = 0.0, table_height = 0.0;
  // m, height of the lowest corner over the table: less is a hop of a slipping box.
  double least_lift = 0.0;
  GraspTruth truth;
  bool lifting = false;
  Pose taken;  // of the box in the arm, when the lift began
};

BodyState GraspSimulation::State::finger_now(const Finger& finger) const {
  const mjData* d = simulation->data();
  const mjtNum *position = d->qpos + finger.qpos, *velocity = d->qvel + finger.dof;
  const Eigen::Quaterniond turn(position[3], position[4], position[5], position[6]);
  BodyState state{.pose = {turn.toRotationMatrix(), Eigen::Vector3d::Map(position)}, .velocity = Eigen::Vector3d::Map(velocity)};
  state.angular_velocity = state.pose.rotation * Eigen::Vector3d::Map(velocity + 3);
  return state;
}

// Sets the fingers' springs to pull towards the position of arm and drive at the tick from which
// MuJoCo steps.
void GraspSimulation::State::drive(double time) {
  const BodyState arm = motion->pad_at(time);
  bodies.front().state = arm;
  for (Finger& finger : fingers) {
    finger.carriage.pose.rotation = arm.pose.rotation * finger.at_rest.rotation;
    finger.carriage.angular_velocity = arm.angular_velocity;
  }
  const auto place = [&] {
    const double half = 0.5 * gripper.opening(time), half_speed = 0.5 * gripper.opening_speed(time);
    for (Finger& finger : fingers) {
      const Eigen::Vector3d closing = finger.carriage.pose.rotation.col(0);
      const Eigen::Vector3d lever = arm.pose.rotation * finger.at_rest.position - half * closing;
      finger.carriage.pose.position = arm.pose.position + lever;
      finger.carriage.velocity = arm.velocity + arm.angular_velocity.cross(lever) - half_speed * closing;
    }
  };
  std::array<BodyState, 2> now;
  double force = 0.0;
  place();
  for (std::size_t k = 0; k < 2; ++k) {
    now[k] = finger_now(fingers[k]);
    force += 0.5 * spring.closing_force(fingers[k].carriage.pose, now[k].pose);
  }
  gripper.update(time, force);
  place();  // the motor may have stopped
  for (std::size_t k = 0; k < 2; ++k) {
    Finger& finger = fingers[k];
    finger.most = std::max(finger.most, spring.closing_force(finger.carriage.pose, now[k].pose));
    Vector6d wrench = spring.wrench(finger.carriage, now[k]);
    Vector6d speed;
    speed << finger.carriage.velocity, finger.carriage.angular_velocity;
    const Vector6d gained = speed - std::exchange(finger.speed, speed);
    if (time > 0.0) simulation->set_carriage_acceleration(k, gained / simulation->time_step(0));
    wrench.head<3>() -= finger_weight;
    // a free joint's is in its own frame
    const Eigen::Vector3d torque = now[k].pose.rotation.transpose() * wrench.tail<3>();
    mjtNum* applied = simulation->data()->qfrc_applied + finger.dof;
    mju_copy3(applied, wrench.data());
    mju_copy3(applied + 3, torque.data());
  }
  if (!push.empty()) push_box(time);
}

// Applies the push of the step that begins now.
void GraspSimulation::State::push_box(double time) {
  const mjModel* m = simulation->model();
  mjData* d = simulation->data();
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(d->xmat + 9 * box);
  const Eigen::Vector3d force = push.mean(time, time + simulation->time_step(0));
  // a free joint's is in its own frame
  const Eigen::Vector3d torque = push_place.cross(rotation.transpose() * force);
  mjtNum* applied = d->qfrc_applied + m->jnt_dofadr[m->body_jntadr[box]];
  mju_copy3(applied, force.data());
  mju_copy3(applied + 3, torque.data());
}

void GraspSimulation::State::observe(double time) {
  const Pose& arm = bodies.front().state.pose;
  const mjData* d = simulation->data();
  const Pose held{Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->xmat + 9 * box),
                  Eigen::Vector3d::Map(d->xpos + 3 * box)};
  truth.time = time;
  for (std::size_t k = 0; k < 2; ++k) {
    const Finger& finger = fingers[k];
    truth.pad_force[k] = simulation->normal_force(finger.pad);
    const double allowed = 2.0 * finger.most + finger.impact;
    if (truth.pad_force[k] > allowed) {
      throw FailedRun(fmt::format(
          "the simulation has diverged at {:.6g} s: the {}'s normal force is {:.4g} N, but the finger's spring has carried {:.4g} N at most; allowed: {:.4g} N",
          time, k == 0 ? "sensor's pad" : "second pad", truth.pad_force[k], finger.most, allowed));
    }
  }
  truth.grip_force = 0.5 * (truth.pad_force[0] + truth.pad_force[1]);
  truth.box_height = held.position.z() - start_height;
  truth.table_force =
      own_contact ? simulation->contact_normal_force(box_name, table_name) : simulation->normal_force(corners_index);
  truth.tilt = math::acos(std::min(1.0, std::abs(held.rotation(2, 1))));
  if (time < lift_start()) return;
  const Pose in_arm = arm.inverse() * held;
  if (!std::exchange(lifting, true)) taken = in_arm;
  truth.slip = in_arm.position - taken.position;
  truth.rotation = rotation_vector(in_arm.rotation * taken.rotation.transpose()).norm();
  const Eigen::Vector3d half_size = 0.5 * grasp.box_size;
  const double lowest = held.position.z() - held.rotation.row(2).cwiseAbs().dot(half_size) - table_height;
  truth.lift_height = std::max(truth.lift_height, lowest);
  truth.lifted = guided == nullptr && truth.lift_height > least_lift;
  const bool risen = time >= lift.end;
  const bool let_go = std::min(truth.pad_force[0], truth.pad_force[1]) == 0.0;
  const bool on_table = truth.table_force > 0.0;
  const bool lost = on_table ? risen : let_go;
  truth.dropped = truth.dropped || (lost && (truth.lifted || guided != nullptr));
  truth.left_behind = risen && !truth.lifted;
}

GraspSimulation::GraspSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                                 std::uint64_t trial, const DynamicSimulationOptions& options)
    : state_((refuse_textures(scene, *pads.front()), std::make_unique<State>(scene, pads, output_rates, trial, options))) {}

GraspSimulation::~GraspSimulation() = default;

std::size_t GraspSimulation::ticks(std::size_t pad) const { return state_->simulation->ticks(pad); }
double GraspSimulation::time_step(std::size_t pad) const { return state_->simulation->time_step(pad); }
std::size_t GraspSimulation::stride(std::size_t pad) const { return state_->simulation->stride(pad); }
std::span<const std::size_t> GraspSimulation::stepped() const { return state_->simulation->stepped(); }
const ContactFrame& GraspSimulation::contact_part(std::size_t pad, FramePart part) const {
  return state_->simulation->contact_part(pad, part);
}
void GraspSimulation::disable_slip_angle() { state_->simulation->disable_slip_angle(); }
const std::vector<NamedBody>& GraspSimulation::bodies() const {
  State& s = *state_;
  const std::vector<NamedBody>& moved = s.simulation->bodies();
  for (std::size_t i = 0; i < s.shown.size(); ++i) s.bodies[i + 1].state = moved[s.shown[i]].state;
  return s.bodies;
}
bool GraspSimulation::rotating() const { return state_->motion->turns(); }
Gripper& GraspSimulation::gripper() { return state_->gripper; }
Guided* GraspSimulation::arm() { return state_->guided; }
const GraspTruth& GraspSimulation::truth() const { return state_->truth; }
const Grasp& GraspSimulation::grasp() const { return state_->grasp; }
double GraspSimulation::friction_scale() const { return state_->grasp.friction_scale; }
double GraspSimulation::ideal_force() const { return state_->ideal; }
double GraspSimulation::lift_start() const { return state_->lift_start(); }
DynamicSimulation& GraspSimulation::dynamics() { return *state_->simulation; }

void GraspSimulation::step() {
  State& s = *state_;
  const double time = TickTimes(s.simulation->time_step(0)).at(s.tick);
  // A field's tick comes before the step that begins with it; the tick of MuJoCo's own contacts
  // comes after the step that leads to it. The fingers' springs are those at the start of the next
  // step.
  if (s.simulation->at_tick() && !s.own_contact) s.drive(time);
  s.simulation->step();
  if (!s.simulation->at_tick()) return;
  if (s.own_contact) s.drive(time);
  s.observe(time);
  ++s.tick;
}

}  // namespace slipbench
