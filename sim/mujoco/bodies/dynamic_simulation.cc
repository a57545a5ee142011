#include "sim/mujoco/bodies/dynamic_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/quantity.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/mujoco/bodies/dynamic_state.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/mujoco_warnings.h"
#include "sim/mujoco/pads/field_plugin.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/stage/stage_setup.h"

namespace slipbench {
namespace {

// Factor by which the step may exceed the longest accurate one once the run has started and bodies
// have moved to other poses: h omega = 1. At 1.2 the acceleration of a slide was wrong by 1 to
// 11 %, measured with boxes between two pads.
constexpr double limit_slack = 4.0 / 3.0;

// Returns a control's value at time t [s].
double value_at(const std::vector<ControlScene::Point>& points, double t) {
  const auto next = std::ranges::upper_bound(points, t, {}, &ControlScene::Point::time);
  if (next == points.begin()) return points.front().value;
  const ControlScene::Point& from = *std::prev(next);
  if (next == points.end()) return from.value;
  return from.value + (next->value - from.value) * ((t - from.time) / (next->time - from.time));
}

// The custom text in which a model names bodies without a free joint that are to be recorded.
constexpr const char* record_text = "slipbench.record";

std::vector<std::string> recorded_by_wish(const mjModel* m) {
  const int text = mj_name2id(m, mjOBJ_TEXT, record_text);
  if (text < 0) return {};
  std::istringstream words(m->text_data + m->text_adr[text]);
  return {std::istream_iterator<std::string>(words), {}};
}

// True if other springs act than in the previous step, or if the springs rotate with a slip.
bool springs_changed(const Field& field) {
  if (field.slipping() > 0) return true;
  const std::span now(field.column(kernel::mode), field.size()), before(field.column(kernel::mode_before), field.size());
  return !std::ranges::equal(now, before);
}

// Returns the springs of a pad for stability: those of the sensor, or those of an elastic skin as a
// whole.
const PadLayout& springs_of(const Field& field, const PadLayout& sensor) { return field.has_skin() ? field.layout() : sensor; }

}  // namespace

double DynamicSimulation::State::rounded_down(double value) {
  if (!std::isfinite(value) || value <= 0.0) return value;
  const double unit = power_of_ten(decade_of(value) - 2);
  return rounded_to_digits(std::floor(value / unit) * unit, 3);
}

void DynamicSimulation::State::make_data() {
  call_mujoco([this] { data.reset(mj_makeData(m())); });
}

// Finds the model's pads in the scene's order, and the geoms that they touch.
void DynamicSimulation::State::find_pads(const Scene& scene) {
  pads.clear();
  contacts.clear();
  if (articulated) {
    find_pillars(scene);
  } else {
    find_fields(scene);
  }
}

void DynamicSimulation::State::find_fields(const Scene& scene) {
  fingers.clear();
  if (spring) {
    for (const FingerNames& finger : finger_names) fingers.push_back(mj_name2id(m(), mjOBJ_BODY, finger.body));
  }
  // the simulation checks the step itself, before the first one
  pad_group_of(m(), d())->allow_long_steps();
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const int instance = mj_name2id(m(), mjOBJ_PLUGIN, scene.sensors[i].name.c_str());
    PadInstance* pad = pad_of(m(), d(), instance);
    const int site = pad->config().site;
    if (i < read) pad->watch();
    pads.push_back({pad, nullptr, site, m()->site_bodyid[site]});
    for (std::size_t k = 0; k < pad->config().geoms.size(); ++k) {
      contacts.push_back({i, k, m()->geom_bodyid[pad->config().geoms[k]]});
    }
  }
}

void DynamicSimulation::State::find_controls(const Scene& scene) {
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
      // MuJoCo would clamp it silently.
      if (m()->actuator_ctrllimited[id] && !(point.value >= range[0] && point.value <= range[1])) {
        throw SceneValueError(path, fmt::format("{} is beyond the actuator's range; allowed: {} to {}",
                                                format_number(point.value), format_number(range[0]), format_number(range[1])));
      }
    }
    controls.push_back({id, control.points});
  }
}

void DynamicSimulation::State::find_bodies(const Scene& scene) {
  const auto add = [this](const std::string& name, mjtObj type, int id, const std::string& path) {
    if (std::ranges::find(bodies, name, &NamedBody::name) != bodies.end()) {
      throw SceneValueError(path, quote(name) + " would be the name of two recorded bodies; choose another name");
    }
    bodies.push_back({name, {}});
    recorded.push_back({type, id});
  };
  if (motion) add("pad", mjOBJ_XBODY, mj_name2id(m(), mjOBJ_BODY, stage_name), "sensors");
  for (std::size_t i = 0; i < pads.size(); ++i) {
    const SensorScene& sensor = scene.sensors[i];
    if (!sensor.site.empty()) add(sensor.name, mjOBJ_SITE, pads[i].site, "sensors." + sensor.name);
  }
  for (const BodyScene& body : scene.bodies) {
    add(body.name, mjOBJ_XBODY, mj_name2id(m(), mjOBJ_BODY, body.name.c_str()), "bodies." + body.name);
  }
  for (int body = 1; body < m()->nbody; ++body) {
    const char* name = mj_id2name(m(), mjOBJ_BODY, body);
    const bool is_free = m()->body_jntnum[body] == 1 && m()->jnt_type[m()->body_jntadr[body]] == mjJNT_FREE;
    const bool known = name == nullptr || std::string_view(name).starts_with(own_prefix) ||
                       std::ranges::find(scene.bodies, std::string(name), &BodyScene::name) != scene.bodies.end();
    if (is_free && !known) add(name, mjOBJ_XBODY, body, "model");
  }
  for (const std::string& name : recorded_by_wish(m())) {
    const int body = mj_name2id(m(), mjOBJ_BODY, name.c_str());
    if (body <= 0) {
      throw SceneValueError(
          "model",
          fmt::format(
              "its custom text {} names {}, which is not a body of the model; expected names of bodies separated by spaces",
              record_text, quote(name)));
    }
    add(name, mjOBJ_XBODY, body, "model");
  }
}

void DynamicSimulation::State::refuse_implicit() const {
  std::vector<ImplicitPad> joined;
  for (const Contact& contact : contacts) {
    const Pad& pad = pads[contact.pad];
    const Pose body = pose_at(d()->xpos + 3 * pad.body, d()->xmat + 9 * pad.body);
    joined.push_back({pad.body, contact.object_body, body.inverse() * pad_pose(pad), layouts[contact.pad]});
  }
  std::string why = implicit_refusal(m(), joined);
  if (why.empty()) why = implicit_self_test(m(), joined);
  if (!why.empty()) throw SceneValueError("field_solver", "implicit " + why);
}

// Returns the tangents of all pads with every element stuck, which is their greatest stiffness.
// Each tangent is taken at the point where a separated pad would touch the object: at the present
// distance of the pad its lever would be larger than any that occurs. Or returns the tangents of
// the touching elements only, where they are.
PadTangents DynamicSimulation::State::stuck_pads(bool touching_only) const {
  PadTangents stuck;
  for (const Contact& contact : contacts) {
    const Pad& pad = pads[contact.pad];
    const Field& field = pad.instance->fields()[contact.field];
    Pose pose = pad_pose(pad);
    PadLayout layout;
    const PadLayout& springs = springs_of(field, *layouts[contact.pad]);
    if (!touching_only) {
      layout = springs;
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
      for (std::size_t i = 0; i < field.size(); ++i) {
        if (field.bears(i)) layout.elements.push_back(springs.elements[i]);
      }
    }
    for (Element& element : layout.elements) element.k_tangential += field.stop_stiffness();
    stuck.bodies.push_back({pad.body, contact.object_body, pose.position});
    stuck.tangents.push_back(stuck_tangent(layout, pose, pose.position, pad.instance->config().damping));
  }
  if (spring) {
    for (const int body : fingers) {
      stuck.bodies.push_back({body, 0, MjVector(d()->xpos + 3 * body)});
      stuck.tangents.push_back(spring->tangent(MjMatrix(d()->xmat + 9 * body)));
    }
  }
  return stuck;
}

void DynamicSimulation::State::check_limit(double time) {
  if (!limited) return;
  std::size_t touching = 0;
  for (const Contact& contact : contacts) {
    touching += pads[contact.pad].instance->fields()[contact.field].touching();
  }
  const bool more = touching > touching_before;
  touching_before = touching;
  if (!more) return;
  if (free_bodies) {
    read_bodies();  // otherwise the code below would round centres of mass
    call_mujoco([this] { FreeBodies::factor(m(), d()); });
  }
  const PadTangents stuck = stuck_pads(true);
  if (dt <= limit_slack * longest_right_step(vibration_bound(m(), d(), stuck.bodies, stuck.tangents))) return;
  const double longest = limit_slack * longest_right_step(fastest_vibration(m(), d(), stuck.bodies, stuck.tangents));
  if (dt > longest) {
    throw SceneValueError("time_step", fmt::format("{} is too long for the pads' springs from {:.6g} s on; allowed: up to {}",
                                                   format_quantity(dt, Quantity::time), time,
                                                   format_quantity(rounded_down(longest), Quantity::time)));
  }
}

// Sets the scene's own start: velocities of its bodies, and the stage.
void DynamicSimulation::State::start(const Scene& scene) {
  for (const BodyScene& body : scene.bodies) {
    const int id = mj_name2id(m(), mjOBJ_BODY, body.name.c_str());
    if (m()->body_dofnum[id] == 6) std::ranges::copy(body.shape.parameters.vector("velocity"), d()->qvel + m()->body_dofadr[id]);
  }
  if (motion) {
    stage_joint = m()->body_jntadr[mj_name2id(m(), mjOBJ_BODY, stage_name)];
    stage_qpos = m()->jnt_qposadr[stage_joint];
    stage_dof = m()->jnt_dofadr[stage_joint];
    prescribe(0.0);
  }
}

void DynamicSimulation::State::prescribe(double time) {
  if (!motion) return;
  const BodyState stage = motion->pad_at(time);
  const Eigen::Quaterniond turn(stage.pose.rotation);
  // A free joint's angular velocity is in the body's own frame.
  const Eigen::Vector3d spin = stage.pose.rotation.transpose() * stage.angular_velocity;
  const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  mju_copy3(d()->qpos + stage_qpos, stage.pose.position.data());
  mju_copy4(d()->qpos + stage_qpos + 3, quaternion);
  mju_copy3(d()->qvel + stage_dof, stage.velocity.data());
  mju_copy3(d()->qvel + stage_dof + 3, spin.data());
}

// Replaces mj_step for a grasp: only the pads' forces and applied forces act.
void DynamicSimulation::State::step_free() {
  // True if MuJoCo might reject one of the values.
  const auto suspect = [](const mjtNum* values, mjtSize count) {
    return !(Eigen::Map<const Eigen::VectorXd>(values, count).squaredNorm() <= mjMAXVAL * mjMAXVAL);
  };
  if (suspect(d()->qpos, m()->nq)) call_mujoco([this] { mj_checkPos(m(), d()); });
  if (suspect(d()->qvel, m()->nv)) call_mujoco([this] { mj_checkVel(m(), d()); });
  free_bodies->place(m(), d());
  const auto all = [this](mjtNum* values) { return Eigen::Map<Eigen::VectorXd>(values, m()->nv); };
  all(d()->qfrc_passive).setZero();
  for (const Pad& pad : pads) pad.instance->add_force(m(), d());
  all(d()->qfrc_smooth) = all(d()->qfrc_passive) - all(d()->qfrc_bias) + all(d()->qfrc_applied);
  averages ? average() : free_bodies->accelerate(d());
  if (suspect(d()->qacc, m()->nv)) call_mujoco([this] { mj_checkAcc(m(), d()); });
  all(d()->qvel) += dt * all(d()->qacc);
  mj_integratePos(m(), d()->qpos, d()->qvel, dt);
  d()->time += dt;
  for (const Pad& pad : pads) pad.instance->commit(m(), d());
}

// Computes the accelerations by average_acceleration.h.
void DynamicSimulation::State::average() {
  std::array<Matrix6d, 2> between{Matrix6d::Zero(), Matrix6d::Zero()};
  Matrix6d ground = Matrix6d::Zero();
  const int held = held_bodies->held();
  const auto in_held = [&](const Pad& pad, const Field& field, const Matrix6d& inertia) {
    const Pose surface = pad_pose(pad) * field.pad_in_surface().inverse();
    return seen_from(pose_at(d()->xpos + 3 * held, d()->xmat + 9 * held).inverse() * surface, inertia);
  };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Pad& pad = pads[contacts[i].pad];
    const Field& field = pad.instance->fields()[contacts[i].field];
    const bool stands = pad.body == held;  // on a surface that does not move with the held body
    if (tick == 0 || springs_changed(field)) {
      added[i] = added_inertia(field, pad.instance->config().damping, dt);
      if (!stands) added[i] = in_held(pad, field, added[i]);
    }
    if (field.touching() == 0) continue;
    if (stands) {
      ground += in_held(pad, field, added[i]);
    } else {
      between[pad.body == fingers[0] ? 0 : 1] += added[i];
    }
  }
  held_bodies->solve(m(), d(), between, ground, carriages);
}

// Takes one step of MuJoCo, from a tick to the next.
void DynamicSimulation::State::advance(std::size_t from) {
  const double time = time_of(from);
  for (const Control& control : controls) d()->ctrl[control.actuator] = value_at(control.points, time);
  // RK4's fields were committed at the end of the last step, at the time that MuJoCo gave it.
  if (!leads || articulated) d()->time = time;
  // Tips stick through positions, which follow from velocities: they need the step's mean velocity.
  if (articulated && motion) {
    drive_free_joint(m(), d(), stage_joint, motion->pad_at(time).pose, motion->pad_at(time_of(from + 1)).pose, dt);
  }
  before = Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
  try {
    free_bodies ? step_free() : call_mujoco([this] { mj_step(m(), d()); });
  } catch (const SceneValueError&) {
    throw;
  } catch (const FailedRun&) {
    throw;
  } catch (const InputError& error) {  // a pad's, which knows no scene
    throw SceneValueError("sensors", error.what());
  }
  refuse_warnings(m(), d(), time);
  after = Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
  if (implicit && d()->nefmcon == 0 && touching()) {
    // a pad that separates within the step has neither springs nor a force at its end
    find_field_force();
    if (!field_force.isZero(0.0)) {
      throw InputError(
          fmt::format("at {:.6g} s the pads' implicit springs are missing in MuJoCo's solver; use field_solver: explicit", time));
    }
  }
  if (articulated) {
    if (!own_contact) refuse_other_contacts(time);
    read_pillars(time_of(from + 1));
    if (!own_contact) refuse_overcompressed(time_of(from + 1));
  }
  prescribe(time_of(from + 1));
}

void DynamicSimulation::State::read_bodies() {
  if (!std::exchange(to_read, false)) return;
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

// Prepares the model at the start of the run.
void DynamicSimulation::State::begin(const Scene& scene) {
  make_data();
  find_pads(scene);
  find_controls(scene);
  start(scene);
  call_mujoco([this] { mj_forward(m(), d()); });
  if (motion) leave_out_of_scale(model.get(), d(), stage_dof);
}

// True if the springs of a grasp are implicit. With `automatic` they are implicit if that is
// cheaper: an implicit step costs up to half as much again as an explicit one, so the springs are
// explicit if a sensor or an effect needs steps nearly as short as explicit springs do. A step
// given by the scene is chosen for accuracy and therefore implicit: its error falls with the square
// of the step, while the error of an explicit step, whose dashpots use the velocity of half a step
// ago, falls linearly. `longest`: the longest step for the effects.
bool DynamicSimulation::State::choose_implicit(const Scene& scene, FieldSolver wished, std::span<const double> rates,
                                               double longest, const Vibration& fastest) const {
  const auto steps = [&](double bearable) {
    const double sampling_time = 1.0 / *std::ranges::max_element(rates);
    return std::ceil(sampling_time / std::min({sampling_time, longest, bearable}));
  };
  if (wished != FieldSolver::automatic) return wished == FieldSolver::implicit_springs;
  const double explicit_step = rounded_down(longest_explicit_step(fastest));
  if (!scene.integrator.empty()) return false;
  if (scene.time_step) return true;
  return !rates.empty() && steps(explicit_step) >= 1.5 * steps(rounded_down(longest_averaged_step(fastest)));
}

// Returns the limit by the motion of the stage or the arm, if there is one.
StepLimit DynamicSimulation::State::limit_of_motion(const DynamicSimulationOptions& options) const {
  const Motion* const moves = options.arm != nullptr ? options.arm : motion.get();
  return moves != nullptr ? step_limit(*moves, {}, 0.0) : StepLimit{};
}

// Builds the model with fields and plans its longest step.
StepPlan DynamicSimulation::State::plan_fields(const Scene& scene, std::span<const double> rates, std::uint64_t trial,
                                               const DynamicSimulationOptions& options) {
  model = build_model(scene, layouts, trial, options.hand, handed);
  begin(scene);
  StepLimit limit = limit_of_motion(options);
  bool springs_known = true, skins = false;
  for (std::size_t i = 0; i < layouts.size(); ++i) {
    if (scene.sensors[i].friction) continue;  // without effects
    const PadLayout* pad = layouts[i];
    const FieldEffects effects = install_effects(scene.effects, *pad, Plane{}, scene.seed, trial);
    if (motion) {
      const StepLimit of_pad = step_limit(*motion, effects, reach_of(*pad));
      if (of_pad.longest < limit.longest) limit = of_pad;
    }
    judge_fields = judge_fields && effects.surface.empty() && effects.rheology.empty() && !effects.lean;
    springs_known = springs_known && effects.rheology.empty() && !effects.lean;
    skins = skins || effects.skin != nullptr;
  }
  if (!springs_known && options.hand_solver == FieldSolver::implicit_springs) {
    throw SceneValueError(
        "field_solver",
        "implicit springs of a grasp cannot be combined with effects that change their stiffness, such as viscoelastic and lean; allowed: auto, explicit");
  }
  limited = options.refuse_long_steps && !implicit;
  if (limited) {
    const PadTangents stuck = stuck_pads(false);
    const Vibration fastest = fastest_vibration(m(), d(), stuck.bodies, stuck.tangents);
    averages = springs_known && choose_implicit(scene, options.hand_solver, rates, limit.longest, fastest);
    if (const double right = longest_right_step(fastest); right < limit.longest) {
      limit.longest = rounded_down(right);
      limit.cause =
          averages
              ? fmt::format(
                    "implicit springs of the pads, which vibrate at up to {:.4g} rad/s on their bodies and are damped at {:.4g} /s",
                    fastest.omega, fastest.damping_rate)
              : fmt::format(
                    "explicit springs of the pads, which vibrate at up to {:.4g} rad/s on their bodies and are damped at {:.4g} /s{}",
                    fastest.omega, fastest.damping_rate,
                    skins                     ? ""
                    : options.hand != nullptr ? " (`field_solver: implicit` has a longer limit)"
                                              : " (`field_solver: implicit` has no such limit)");
    }
  }
  if (implicit) refuse_implicit();
  return plan_steps(scene, rates, limit);
}

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

void DynamicSimulation::State::find_followers(const Scene& scene, std::span<const PadLayout* const> pad_layouts,
                                              std::span<const double> rates) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!sensors[i].follows) continue;
    const PadInstance* pad = pad_of(m(), d(), mj_name2id(m(), mjOBJ_PLUGIN, scene.sensors[i].follows.c_str()));
    const double speed = motion ? motion->top_speed(reach_of(*pad_layouts[i]) + scene.sensors[i].ahead) : 0.0;
    followers.push_back(std::make_unique<PadFollower>(m(), *pad, *pad_layouts[i], scene.sensors[i].ahead, rates[i], speed, dt));
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
  if (options.hand != nullptr) s.spring = finger_spring(options.hand->grip);
  s.articulated = scene.fidelity != "field";
  s.own_contact = scene.contact.has_value();
  s.implicit = scene.implicit_fields();
  const bool staged = std::ranges::any_of(carrying.sensors, [](const SensorScene& sensor) { return sensor.site.empty(); });
  if (staged) {
    s.motion = make_motion(scene, trial);
    refuse_motors(*s.motion);
  }
  const StepPlan plan = s.articulated ? s.plan_pillars(carrying, rates, options) : s.plan_fields(carrying, rates, trial, options);
  s.dt = plan.dt;
  s.ticks = plan.ticks;

  // The pads read the step when the data is made.
  s.model->opt.timestep = s.dt;
  if (s.averages) {
    s.held_bodies.emplace(s.m(), std::array{s.fingers[0], s.fingers[1]}, mj_name2id(s.m(), mjOBJ_BODY, options.hand->box),
                          s.spring->tangent(Eigen::Matrix3d::Identity()), s.dt);
    s.added.assign(s.contacts.size(), Matrix6d::Zero());
  }
  if (options.hand != nullptr && !s.own_contact && s.model->opt.integrator == mjINT_EULER) s.free_bodies.emplace(s.m());
  if (s.averages && !s.free_bodies) throw std::logic_error("implicit springs of a grasp under another integrator than Euler");
  s.make_data();
  s.find_pads(carrying);
  s.start(carrying);
  for (std::size_t i = 0; i < s.read; ++i) s.pads[i].stride = plan.strides[i];
  s.find_followers(scene, pads, output_rates);
  s.find_bodies(carrying);
  s.leads = s.model->opt.integrator == mjINT_RK4;
  if (s.articulated) s.settle_tips();
  s.to_keep = !s.articulated && !s.implicit && !s.leads;
  call_mujoco([&s] { mj_forward(s.model.get(), s.data.get()); });
  // RK4 commits only at the end of a step. Pads that touch at t = 0 must stick there, unstrained,
  // as with any other integrator. Otherwise no tip would hold in the first step, and tick 0 would
  // have no truth.
  if (s.leads && !s.articulated) {
    for (const State::Pad& pad : s.pads) pad.instance->commit(s.m(), s.d());
  }
  s.find_watched(s.averages ? averaged(options.limits) : options.limits);
}

DynamicSimulation::~DynamicSimulation() = default;

std::size_t DynamicSimulation::ticks(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->ticks(s.time_of(s.ticks - 1)) : s.ticks;
}
double DynamicSimulation::time_step(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->time_step() : s.dt;
}
std::size_t DynamicSimulation::stride(std::size_t pad) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->stride() : s.pads[s.sensors[pad].index].stride;
}
const ContactFrame& DynamicSimulation::contact_part(std::size_t pad, FramePart part) const {
  const State& s = *state_;
  return s.sensors[pad].follows ? s.followers[s.sensors[pad].index]->contact()
                                : State::truth_of(s.pads[s.sensors[pad].index], part);
}
void DynamicSimulation::disable_slip_angle() {
  for (const State::Pad& pad : state_->pads) {
    if (pad.instance != nullptr) pad.instance->disable_slip_angle();
  }
}
double DynamicSimulation::normal_force(std::size_t carrying) const {
  const State::Pad& pad = state_->pads[carrying];
  if (pad.pillars) return pad.pillars->normal_force();
  double force = 0.0;
  for (const Field& field : pad.instance->fields()) {
    for (const double f_normal : std::span(field.column(kernel::f_normal), field.size())) force += std::max(0.0, f_normal);
  }
  return force;
}
double DynamicSimulation::contact_normal_force(const std::string& body, const std::string& other) const {
  const mjModel* m = state_->m();
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
const std::vector<NamedBody>& DynamicSimulation::bodies() const {
  state_->read_bodies();
  return state_->bodies;
}
bool DynamicSimulation::rotating() const { return state_->motion && state_->motion->turns(); }
const mjModel* DynamicSimulation::model() const { return state_->m(); }
mjData* DynamicSimulation::data() const { return state_->d(); }

void DynamicSimulation::set_carriage_acceleration(std::size_t finger, const Vector6d& acceleration) {
  state_->carriages[finger] = acceleration;
}

// Steps from one tick of the simulation to the next.
void DynamicSimulation::State::take_tick() {
  const double time = time_of(tick);
  if (!articulated && !leads) {
    advance(tick);
    if (std::exchange(to_keep, false)) {
      for (const Pad& pad : pads) pad.instance->keep_state();
    }
  } else if (tick > 0) {
    advance(tick - 1);
    if (!leads) watch_step(time_of(tick - 1), before);
    if (articulated) follow();
  } else {
    after = Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
  }
  to_read = true;
  check_limit(time);
  if (!articulated || leads) watch_step(time, leads ? after : before);
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
