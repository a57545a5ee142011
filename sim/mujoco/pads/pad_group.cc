#include "sim/mujoco/pads/pad_group.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/pose.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

// Factor by which a step may exceed longest_explicit_step(): h omega = 1 instead of 0.75. The pose
// of a user's model changes, and up to this factor weight, threshold and slide are accurate to 0.1
// % (tests/sim/mujoco/pads/plugin_grip_test.cc); beyond it a slide is wrong.
constexpr double bearable = 4.0 / 3.0;

// Formats a time with three digits.
std::string short_time(double time) { return format_quantity(rounded_to_digits(time, 3), Quantity::time); }

std::string names_of(const std::vector<PadInstance*>& pads) {
  std::string names;
  for (const PadInstance* pad : pads) names += (names.empty() ? "'" : ", '") + pad->config().name + "'";
  return names;
}

// After PadInstance::add_force(): adds, for every touched geom, the tangent of the pad's elements
// that touch in the trial, taken as stuck.
void add_touching_tangents(ModelView model, DataView data, const PadInstance& pad, PadTangents& pads) {
  if (pad.idle()) return;
  const PadKinematics& kinematics = pad.kinematics();
  const Pose pose = kinematics.pad_pose(data);
  for (std::size_t k = 0; k < pad.fields().size(); ++k) {
    const Field& field = pad.fields()[k];
    PadLayout touching;
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (field.bears(i)) touching.elements.push_back(field.layout().elements[i]);
    }
    if (touching.elements.empty()) continue;
    pads.bodies.push_back({kinematics.pad_body(model), kinematics.touched()[k].body, pose.position});
    pads.tangents.push_back(stuck_tangent(touching, pose, pose.position, pad.config().damping));
  }
}

// Adds the pad's tangent with all elements stuck on the touched body on which it vibrates fastest,
// moved onto that body if it is separated.
void add_stuck_tangent(ModelView model, DataView data, const PadInstance& pad, PadTangents& pads) {
  const PadKinematics& kinematics = pad.kinematics();
  const Pose pose = kinematics.pad_pose(data);
  PadOnBodies on{};
  PadTangent tangent;
  double fastest = -1.0;
  for (std::size_t k = 0; k < pad.fields().size(); ++k) {
    const Field& field = pad.fields()[k];
    const TouchedGeom& touched = kinematics.touched()[k];
    const Pose placed = kinematics.surface_pose(data, k);
    const Eigen::Vector3d origin = placed.inverse() * pose.position, axis = -(placed.rotation.transpose() * pose.rotation.col(2));
    const SurfacePoint met =
        std::visit([&](const auto& shape) { return shape.at(origin.x(), origin.y(), origin.z(), axis.x(), axis.y(), axis.z()); },
                   touched.shape);
    Pose there = pose;  // at its present distance it would have a lever that never occurs
    if (met.gap > 0.0) there.position -= met.gap * (placed.rotation * Eigen::Vector3d(met.nx, met.ny, met.nz));
    const PadOnBodies candidate{kinematics.pad_body(model), touched.body, there.position};
    const PadTangent stuck = stuck_tangent(field.layout(), there, there.position, pad.config().damping);
    const double omega = fastest_vibration(model, data, {&candidate, 1}, {&stuck, 1}).omega;
    if (omega <= fastest) continue;
    fastest = omega;
    on = candidate;
    tangent = stuck;
  }
  pads.bodies.push_back(on);
  pads.tangents.push_back(tangent);
}

}  // namespace

PadGroup::PadGroup(ModelView model, const std::vector<PadInstance*>& pads) {
  for (PadInstance* pad : pads) (pad->config().implicit ? implicit_ : explicit_).push_back(pad);
  std::size_t contacts = 0;
  for (const PadInstance* pad : explicit_) contacts += pad->config().geoms.size();
  touching_.assign(contacts, 0);
  for (std::size_t i = 0; i < pads.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (pads[k]->config().site != pads[i]->config().site) continue;
      pads[i]->config().report(
          fmt::format("it is on the same site '{}' as plugin '{}', so their forces would add up; use one site for each",
                      model.name_of(mj::site, pads[i]->config().site), pads[k]->config().name));
    }
  }
  if (implicit_.empty()) return;

  for (const PadInstance* pad : implicit_) {
    if (pad->config().damping != implicit_.front()->config().damping) {
      throw InputError(fmt::format("plugins {}: all implicit pads of a model need the same damping; found {} and {}",
                                   names_of(implicit_), format_quantity(implicit_.front()->config().damping, Quantity::time),
                                   format_quantity(pad->config().damping, Quantity::time)));
    }
    pad->describe(model, described_);
  }
  std::string failure = implicit_refusal(model, described_);
  if (failure.empty()) failure = implicit_self_test(model, described_);
  if (!failure.empty()) throw InputError(fmt::format("plugins {}: solver='implicit' {}", names_of(implicit_), failure));
  memory_.resize(described_.size() * ImplicitFields::memory_per_contact);
}

void PadGroup::add_force(ModelView model, DataView data) {
  if (guarded_ && !explicit_.empty()) refuse_long_step(model, data);
  if (implicit_.empty()) return;
  const auto refuse = [this](const std::string& failure) {
    if (!failure.empty()) throw InputError(fmt::format("plugins {}: solver='implicit' {}", names_of(implicit_), failure));
  };
  refuse(implicit_refusal(model, {}));  // options may have changed since the mjData was made
  contacts_.clear();
  double* gathered = memory_.data();
  for (PadInstance* pad : implicit_) {
    pad->begin_implicit(model, data, contacts_);
    const std::span<const double> memory = pad->implicit_memory(model, data);
    gathered = std::copy(memory.begin(), memory.end(), gathered);
  }
  // Tendons matter only if something may touch.
  const bool idle = std::ranges::all_of(contacts_, [](const ImplicitContact& contact) { return contact.field == nullptr; });
  std::string failure = idle ? "" : implicit_refusal(model, described_);
  if (failure.empty()) failure = solver_.apply(model, data, contacts_, memory_, implicit_.front()->config().damping);
  for (PadInstance* pad : implicit_) pad->forget_trial();
  refuse(failure);
}

void PadGroup::finish(ModelView model, DataView data) {
  if (implicit_.empty()) return;
  if (!solver_.converged()) ++unconverged_;
  solver_.finish(model, data, memory_);
  const double* gathered = memory_.data();
  for (PadInstance* pad : implicit_) {
    const std::span<double> memory = pad->implicit_memory(model, data);
    std::copy_n(gathered, memory.size(), memory.begin());
    gathered += memory.size();
  }
}

void PadGroup::add_applied(ModelView model, DataView data, double* force) const {
  std::size_t i = 0;
  for (const PadInstance* pad : implicit_) {
    const int site = pad->config().site;
    for (const int geom : pad->config().geoms) {
      const Wrench& wrench = solver_.applied(i++);
      const Eigen::Vector3d back_force = -wrench.force, back_torque = -wrench.torque;
      const double* origin = data.site_xpos() + 3 * site;
      model.mujoco().mj_applyFT(model.get(), data.get(), wrench.force.data(), wrench.torque.data(), origin,
                                model.site_bodyid()[site], force);
      model.mujoco().mj_applyFT(model.get(), data.get(), back_force.data(), back_torque.data(), origin, model.geom_bodyid()[geom],
                                force);
    }
  }
}

void PadGroup::copy_from(const PadGroup& other) {
  guarded_ = other.guarded_;
  pending_ = other.pending_;
  touching_ = other.touching_;
  solver_ = other.solver_;
  memory_ = other.memory_;
  unconverged_ = other.unconverged_;
}

double PadGroup::longest_step(ModelView model, DataView data) const {
  PadTangents pads;
  for (const PadInstance* pad : explicit_) add_stuck_tangent(model, data, *pad, pads);
  return bearable * longest_explicit_step(fastest_vibration(model, data, pads.bodies, pads.tangents));
}

// The step is checked when more elements of a pad touch than in the last step. Before the first
// commit nothing is thrown, since MuJoCo's compiler takes one step with the model's time step; a
// violation found then is thrown at the next step, with or without contact.
void PadGroup::refuse_long_step(ModelView model, DataView data) {
  const bool placed = explicit_.front()->placed(model, data);
  if (!placed) {
    pending_.clear();
    std::fill(touching_.begin(), touching_.end(), std::size_t{0});
  } else if (!pending_.empty()) {
    throw InputError(pending_);
  }
  bool more = false;
  touching_now_.clear();
  for (const PadInstance* pad : explicit_) {
    for (std::size_t k = 0; k < pad->fields().size(); ++k) {
      more = more || pad->touching(k) > touching_[touching_now_.size()];
      touching_now_.push_back(pad->touching(k));
    }
  }
  if (more) {
    PadTangents pads;
    for (const PadInstance* pad : explicit_) add_touching_tangents(model, data, *pad, pads);
    const Vibration vibration = fastest_vibration(model, data, pads.bodies, pads.tangents);
    const double longest = bearable * longest_explicit_step(vibration);
    if (!(model.opt_timestep() <= longest)) {
      pending_ = fmt::format(
          "plugins {}: the time step {} is too long for the pads in contact at {}, whose fastest vibration is {:.3g} rad/s; allowed: up to {:.3g} ms now, up to {:.3g} ms with all elements in contact, or any step with solver='implicit'",
          names_of(explicit_), short_time(model.opt_timestep()), short_time(data.time()), vibration.omega, 1e3 * longest,
          1e3 * std::min(longest, longest_step(model, data)));
      if (placed) throw InputError(std::exchange(pending_, ""));
    }
  }
  touching_.swap(touching_now_);
}

}  // namespace slipbench
