#include "sim/mujoco/modes/dynamic_world.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/quantity.h"
#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/pads/pad_kinematics.h"

namespace slipbench {
namespace {

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

std::vector<std::string> bodies_to_record(const mjModel* m) {
  const int text = mj_name2id(m, mjOBJ_TEXT, record_text);
  if (text < 0) return {};
  std::istringstream words(m->text_data + m->text_adr[text]);
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

DynamicWorld::DynamicWorld(const Scene& scene, const Motion* motion, ModelPointer model)
    : motion_(motion), model_(std::move(model)) {
  start(scene);
  find_controls(scene);
}

void DynamicWorld::find_controls(const Scene& scene) {
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
    controls_.push_back({id, control.points});
  }
}

void DynamicWorld::record(const Scene& scene, std::span<const int> sites) {
  const auto add = [this](const std::string& name, mjtObj type, int id, const std::string& path) {
    if (std::ranges::find(bodies_, name, &NamedBody::name) != bodies_.end()) {
      throw SceneValueError(path, quote(name) + " would be the name of two recorded bodies; choose another name");
    }
    bodies_.push_back({name, {}});
    recorded_.push_back({type, id});
  };
  if (motion_ != nullptr) add("pad", mjOBJ_XBODY, mj_name2id(m(), mjOBJ_BODY, stage_name), "sensors");
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const SensorScene& sensor = scene.sensors[i];
    if (!sensor.site.empty()) add(sensor.name, mjOBJ_SITE, sites[i], "sensors." + sensor.name);
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
  for (const std::string& name : bodies_to_record(m())) {
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

void DynamicWorld::start(const Scene& scene) {
  call_mujoco([this] { data_.reset(mj_makeData(m())); });
  for (const BodyScene& body : scene.bodies) {
    const int id = mj_name2id(m(), mjOBJ_BODY, body.name.c_str());
    if (m()->body_dofnum[id] == 6) std::ranges::copy(body.shape.parameters.vector("velocity"), d()->qvel + m()->body_dofadr[id]);
  }
  if (motion_ != nullptr) {
    stage_joint_ = m()->body_jntadr[mj_name2id(m(), mjOBJ_BODY, stage_name)];
    stage_qpos_ = m()->jnt_qposadr[stage_joint_];
    stage_dof_ = m()->jnt_dofadr[stage_joint_];
    prescribe(0.0);
  }
}

void DynamicWorld::measure_scale() {
  call_mujoco([this] { mj_forward(m(), d()); });
  if (motion_ != nullptr) leave_out_of_scale(model_.get(), d(), stage_dof_);
}

void DynamicWorld::restart(const Scene& scene, double dt) {
  dt_ = dt;
  model_->opt.timestep = dt;  // the pads read it when the data is made
  start(scene);
}

void DynamicWorld::apply_controls(double time) {
  for (const Control& control : controls_) d()->ctrl[control.actuator] = value_at(control.points, time);
}

void DynamicWorld::prescribe(double time) {
  if (motion_ == nullptr) return;
  const BodyState stage = motion_->pad_at(time);
  const Eigen::Quaterniond turn(stage.pose.rotation);
  // A free joint's angular velocity is in the body's own frame.
  const Eigen::Vector3d spin = stage.pose.rotation.transpose() * stage.angular_velocity;
  const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  mju_copy3(d()->qpos + stage_qpos_, stage.pose.position.data());
  mju_copy4(d()->qpos + stage_qpos_ + 3, quaternion);
  mju_copy3(d()->qvel + stage_dof_, stage.velocity.data());
  mju_copy3(d()->qvel + stage_dof_ + 3, spin.data());
}

const std::vector<NamedBody>& DynamicWorld::bodies() {
  if (!std::exchange(outdated_, false)) return bodies_;
  for (std::size_t i = 0; i < recorded_.size(); ++i) {
    const auto [type, id] = recorded_[i];
    mjtNum velocity[6];
    mj_objectVelocity(m(), d(), type, id, velocity, 0);
    const bool site = type == mjOBJ_SITE;
    BodyState& state = bodies_[i].state;
    state.pose = pose_at((site ? d()->site_xpos : d()->xpos) + 3 * id, (site ? d()->site_xmat : d()->xmat) + 9 * id);
    state.angular_velocity = MjVector(velocity);
    state.velocity = MjVector(velocity + 3);
  }
  return bodies_;
}

}  // namespace slipbench
