// A box between two pads, stepped by mj_step with the fields in mjcb_passive: what the plugin does, without the plugin.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/implicit.h"

namespace slipbench {

using Spec = SpecPointer;
using Model = ModelPointer;
using Data = DataPointer;

inline Spec parse(const std::string& xml) {
  std::array<char, 500> error{};
  Spec spec(mj_parseXMLString(xml.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!spec) throw std::runtime_error(error.data());
  return spec;
}

inline Model compile(mjSpec* spec) {
  Model model(mj_compile(spec, nullptr));
  if (!model) throw std::runtime_error(mjs_getError(spec));
  return model;
}

// Nine pillars at 7 mm, flat: k_n 3 kN/m and k_t 500 N/m, times `stiffer`.
inline PadLayout nine_flat_pillars(double stiffer) {
  PadLayout pad;
  for (int i = 0; i < 9; ++i) {
    Element element;
    element.tip = {0.007 * (i / 3 - 1), 0.007 * (i % 3 - 1), 0.0};
    element.k_normal = 3000.0 * stiffer;
    element.k_tangential = 500.0 * stiffer;
    pad.units.push_back({pad.elements.size(), 1});
    pad.elements.push_back(element);
  }
  return pad;
}

inline Pose pose_of(const double* position, const double* rotation) {
  return {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation), Eigen::Map<const Eigen::Vector3d>(position)};
}

// Fields of pads (sites) on geoms, evaluated in mjcb_passive and committed after mj_step. One at a time: the callback is MuJoCo's
// only.
class FieldRig {
 public:
  struct Pair {
    std::string site, geom;
  };
  FieldRig(Model model, const std::vector<Pair>& pairs, const PadLayout& layout, Friction friction, double viscous_time,
           bool implicit)
      : model_(std::move(model)), data_(mj_makeData(model_.get())), viscous_time_(viscous_time), implicit_(implicit) {
    for (const Pair& pair : pairs) {
      const int site = mj_name2id(m(), mjOBJ_SITE, pair.site.c_str()), geom = mj_name2id(m(), mjOBJ_GEOM, pair.geom.c_str());
      const Box box{Eigen::Vector3d(m()->geom_size + 3 * geom)};
      contacts_.push_back(
          {site, geom, m()->site_bodyid[site], m()->geom_bodyid[geom], std::make_unique<Field>(layout, box, friction), {}, {}});
      contacts_.back().committed.resize(contacts_.back().field->state_size());
      contacts_.back().now = contacts_.back().committed;
    }
    memory_.resize(ImplicitFields::memory_per_contact * contacts_.size());
    wrenches_.resize(contacts_.size());
    if (implicit_) {
      std::vector<ImplicitPad> pads;
      mj_forward(m(), d());
      for (const Contact& c : contacts_) {
        const Pose body = pose_of(d()->xpos + 3 * c.pad_body, d()->xmat + 9 * c.pad_body);
        pads.push_back({c.pad_body, c.object_body, body.inverse() * pad(c), &c.field->layout()});
      }
      if (std::string why = implicit_refusal(m(), pads); !why.empty()) throw std::runtime_error(why);
      if (std::string why = implicit_self_test(m(), pads); !why.empty()) throw std::runtime_error(why);
    }
  }
  FieldRig(const FieldRig&) = delete;
  ~FieldRig() { mjcb_passive = nullptr; }

  [[nodiscard]] mjModel* m() { return model_.get(); }
  [[nodiscard]] mjData* d() { return data_.get(); }
  [[nodiscard]] const ImplicitFields& implicit() const { return solver_; }
  [[nodiscard]] int unconverged() const { return unconverged_; }
  [[nodiscard]] int iterations() const { return iterations_; }
  // On the pad, about its origin, in world axes.
  [[nodiscard]] const Wrench& wrench(std::size_t i) const { return wrenches_[i]; }
  [[nodiscard]] Field& field(std::size_t i) { return *contacts_[i].field; }
  // States that the elements were in at the pose of the last step.
  [[nodiscard]] ElementState state(std::size_t contact, std::size_t element) const { return contacts_[contact].states[element]; }

  // With every element stuck.
  [[nodiscard]] Vibration vibration() {
    std::vector<PadOnBodies> pads;
    std::vector<PadTangent> tangents;
    for (Contact& c : contacts_) {
      pads.push_back({c.pad_body, c.object_body, pad(c).position});
      tangents.push_back(stuck_tangent(c.field->layout(), pad(c), pad(c).position, viscous_time_));
    }
    return fastest_vibration(m(), d(), pads, tangents);
  }

  void step() {
    current() = this;
    mjcb_passive = [](const mjModel*, mjData*) { current()->passive(); };
    mj_step(m(), d());
    mjcb_passive = nullptr;
    for (Contact& c : contacts_) c.committed = c.now;
    if (!implicit_) return;
    solver_.finish(m(), d(), memory_);
    for (std::size_t i = 0; i < contacts_.size(); ++i) wrenches_[i] = solver_.applied(i);
    iterations_ += solver_.iterations();
    unconverged_ += solver_.converged() ? 0 : 1;
  }

 private:
  struct Contact {
    int site, geom, pad_body, object_body;
    std::unique_ptr<Field> field;
    std::vector<double> committed, now;
    std::vector<ElementState> states{};
  };
  static FieldRig*& current() {
    static FieldRig* rig = nullptr;
    return rig;
  }
  Pose pad(const Contact& c) { return pose_of(d()->site_xpos + 3 * c.site, d()->site_xmat + 9 * c.site); }
  Pose surface(const Contact& c) { return pose_of(d()->geom_xpos + 3 * c.geom, d()->geom_xmat + 9 * c.geom); }

  void passive() {
    std::vector<ImplicitContact> implicit;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      Contact& c = contacts_[i];
      const Pose at = pad(c), touched = surface(c);
      c.field->load_state(c.committed);
      c.field->step(touched.inverse() * at, m()->opt.timestep);
      c.field->save_state(c.now);
      c.states.resize(c.field->size());
      for (std::size_t e = 0; e < c.field->size(); ++e) c.states[e] = c.field->state(e);
      if (implicit_) {
        implicit.push_back({c.field.get(), c.now, c.pad_body, c.object_body, at, touched});
        continue;
      }
      Eigen::Map<Eigen::VectorXd> qfrc(d()->qfrc_passive, m()->nv);
      RowMatrix jacobian(6, m()->nv);
      relative_jacobian(m(), d(), {c.pad_body, c.object_body, at.position}, jacobian.data());
      const Vector6d w = jacobian * Eigen::Map<Eigen::VectorXd>(d()->qvel, m()->nv);
      const Eigen::Matrix3d& turn = touched.rotation;
      const Wrench own =
          c.field->damped_wrench_on_pad({turn.transpose() * w.head<3>(), turn.transpose() * w.tail<3>()}, viscous_time_);
      Vector6d force;
      force << turn * own.force, turn * own.torque;
      qfrc += jacobian.transpose() * force;
      wrenches_[i] = {force.head<3>(), force.tail<3>()};
    }
    if (!implicit_) return;
    if (std::string why = solver_.apply(m(), d(), implicit, memory_, viscous_time_); !why.empty()) throw std::runtime_error(why);
  }

  Model model_;
  Data data_;
  double viscous_time_;
  bool implicit_;
  std::vector<Contact> contacts_;
  std::vector<double> memory_;
  std::vector<Wrench> wrenches_;
  ImplicitFields solver_;
  int unconverged_ = 0;
  int iterations_ = 0;
};

// A box of `mass` [kg] between a fixed pad and one on a slider that a force closes. Moved by 0.13 mm and turned by 4 mrad, so
// that nothing balances by symmetry.
struct GripScene {
  double mass = 0.005;
  double stiffer = 1.0;
  double dt = 0.001;
  bool implicit = false;
  bool perturbed = true;
  double mu = 0.5;
  double damping = 0.4;  // viscous time times omega along the normals: twice the damping ratio
};

class GripRig {
 public:
  static constexpr double g = 9.81;

  explicit GripRig(const GripScene& scene)
      : scene_(scene),
        rig_(model(scene), {{"left", "box"}, {"right", "box"}}, nine_flat_pillars(scene.stiffer), {scene.mu, scene.mu},
             scene.damping / std::sqrt(2.0 * 9.0 * 3000.0 * scene.stiffer / scene.mass), scene.implicit) {
    rig_.m()->opt.gravity[2] = 0.0;
  }

  [[nodiscard]] FieldRig& rig() { return rig_; }
  // The least grip [N] that holds the box: two pads, each with mu F.
  [[nodiscard]] double threshold() const { return scene_.mass * g / (2.0 * scene_.mu); }
  [[nodiscard]] double height() { return rig_.d()->qpos[2]; }
  [[nodiscard]] double fall_speed() { return -rig_.d()->qvel[2]; }
  // Force of the pads on the box, upwards [N].
  [[nodiscard]] double carried() const { return -rig_.wrench(0).force.z() - rig_.wrench(1).force.z(); }

  // Steps for `duration`, force and weight going linearly to the given grip [N] and gravity [m/s2]. False when anything is not
  // finite.
  bool go(double duration, double grip, double gravity) {
    const int steps = static_cast<int>(std::lround(duration / scene_.dt));
    const double grip_before = grip_, gravity_before = gravity_;
    for (int i = 1; i <= steps; ++i) {
      const double part = static_cast<double>(i) / steps;
      grip_ = grip_before + part * (grip - grip_before);
      gravity_ = gravity_before + part * (gravity - gravity_before);
      rig_.d()->qfrc_applied[rig_.m()->nv - 1] = grip_;
      rig_.m()->opt.gravity[2] = -gravity_;
      rig_.step();
      if (!std::isfinite(height()) || std::abs(height()) > 1.0) return false;
    }
    return true;
  }

  // Grips at 1.5 times the threshold, then lets the weight on.
  bool hold() {
    grip_ = 1.5 * threshold();
    return go(0.3, grip_, 0.0) && go(0.2, grip_, g) && go(0.2, grip_, g);
  }

 private:
  static Model model(const GripScene& scene) {
    const std::string pose = scene.perturbed ? "pos='0 0.00013 0.00013' axisangle='0.5 0.7 0.6 0.004'" : "";
    Spec spec = parse(
        "<mujoco><option timestep='" + std::to_string(scene.dt) + "' integrator='implicitfast'/><worldbody><body name='box' " +
        pose + "><freejoint/><geom name='box' type='box' size='0.015 0.02 0.06' mass='" + std::to_string(scene.mass) +
        "' contype='0' conaffinity='0'/><site name='middle'/></body><body name='left' pos='-0.0151 0 0' euler='0 -90 0'><site name='left'/></body><body name='right' pos='0.0151 0 0'><joint type='slide' axis='-1 0 0' damping='50'/><geom type='sphere' size='0.01' mass='0.05' contype='0' conaffinity='0'/><site name='right' euler='0 90 0'/></body></worldbody></mujoco>");
    const std::vector<SitePair> pairs{{"left", "middle"}, {"right", "middle"}};
    if (scene.implicit) prepare_implicit(spec.get(), pairs);
    return compile(spec.get());
  }

  GripScene scene_;
  FieldRig rig_;
  double grip_ = 0.0, gravity_ = 0.0;
};

}  // namespace slipbench
