#include "sim/mujoco/pads/pad_group.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {
namespace {

// How much longer than longest_explicit_step() a step may be: h omega = 1 instead of 0.75. A user's model is what it is, its pose changes,
// and up to there weight, threshold and slide are right to 0.1 % (tests/sim/mujoco/pads/plugin_grip_test.cc); beyond, a slide comes out wrong.
constexpr double bearable = 4.0 / 3.0;

// With three digits.
std::string short_time(double time) { return format_quantity(std::stod(fmt::format("{:.3g}", time)), Quantity::time); }

std::string names_of(const std::vector<PadInstance*>& pads) {
  std::string names;
  for (const PadInstance* pad : pads) names += (names.empty() ? "'" : ", '") + pad->config().name + "'";
  return names;
}

}  // namespace

PadGroup::PadGroup(const mjModel* model, const std::vector<PadInstance*>& pads) {
  for (PadInstance* pad : pads) (pad->config().implicit ? implicit_ : explicit_).push_back(pad);
  std::size_t contacts = 0;
  for (const PadInstance* pad : explicit_) contacts += pad->config().geoms.size();
  touching_.assign(contacts, 0);
  for (std::size_t i = 0; i < pads.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (pads[k]->config().site != pads[i]->config().site) continue;
      pads[i]->config().report(
          fmt::format("it is on the site '{}' of plugin '{}', so that their forces would add up; allowed: a site for each",
                      mj_id2name(model, mjOBJ_SITE, pads[i]->config().site), pads[k]->config().name));
    }
  }
  if (implicit_.empty()) return;

  for (const PadInstance* pad : implicit_) {
    if (pad->config().damping != implicit_.front()->config().damping) {
      throw InputError(fmt::format("plugins {}: implicit pads of one model have one damping; found {} and {}",
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

void PadGroup::add_force(const mjModel* model, mjData* data) {
  if (guarded_ && !explicit_.empty()) refuse_long_step(model, data);
  if (implicit_.empty()) return;
  // Options may have been changed since the mjData was made.
  if (const std::string refusal = implicit_refusal(model, described_); !refusal.empty()) {
    throw InputError(fmt::format("plugins {}: solver='implicit' {}", names_of(implicit_), refusal));
  }
  std::vector<ImplicitContact> contacts;
  double* gathered = memory_.data();
  for (PadInstance* pad : implicit_) {
    pad->begin_implicit(model, data, contacts);
    const std::span<const double> memory = pad->implicit_memory(model, data);
    gathered = std::copy(memory.begin(), memory.end(), gathered);
  }
  const std::string failure = solver_.apply(model, data, contacts, memory_, implicit_.front()->config().damping);
  for (PadInstance* pad : implicit_) pad->forget_trial();
  if (!failure.empty()) throw InputError(fmt::format("plugins {}: solver='implicit' {}", names_of(implicit_), failure));
}

void PadGroup::finish(const mjModel* model, mjData* data) {
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

void PadGroup::add_applied(const mjModel* model, mjData* data, mjtNum* force) const {
  std::size_t i = 0;
  for (const PadInstance* pad : implicit_) {
    const int site = pad->config().site;
    for (const int geom : pad->config().geoms) {
      const Wrench& wrench = solver_.applied(i++);
      const Eigen::Vector3d back_force = -wrench.force, back_torque = -wrench.torque;
      const mjtNum* origin = data->site_xpos + 3 * site;
      mj_applyFT(model, data, wrench.force.data(), wrench.torque.data(), origin, model->site_bodyid[site], force);
      mj_applyFT(model, data, back_force.data(), back_torque.data(), origin, model->geom_bodyid[geom], force);
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

double PadGroup::longest_step(const mjModel* model, mjData* data) const {
  std::vector<PadOnBodies> bodies;
  std::vector<PadTangent> tangents;
  for (const PadInstance* pad : explicit_) pad->add_stuck_tangent(model, data, bodies, tangents);
  return bearable * longest_explicit_step(fastest_vibration(model, data, bodies, tangents));
}

// The step is judged when more elements of a pad touch than in the step before. Before the first commit nothing is thrown, since MuJoCo's
// compiler takes one step with whatever step the model has; what was found then is thrown at the next one, contact or not.
void PadGroup::refuse_long_step(const mjModel* model, mjData* data) {
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
    std::vector<PadOnBodies> bodies;
    std::vector<PadTangent> tangents;
    for (const PadInstance* pad : explicit_) pad->add_touching_tangents(model, data, bodies, tangents);
    const Vibration vibration = fastest_vibration(model, data, bodies, tangents);
    const double longest = bearable * longest_explicit_step(vibration);
    if (!(model->opt.timestep <= longest)) {
      pending_ = fmt::format(
          "plugins {}: the time step {} is too long for what touches at {}: its fastest vibration is {:.3g} rad/s; allowed: up to {:.3g} ms now, up to {:.3g} ms with all elements touching at once, or solver='implicit'",
          names_of(explicit_), short_time(model->opt.timestep), short_time(data->time), vibration.omega, 1e3 * longest,
          1e3 * std::min(longest, longest_step(model, data)));
      if (placed) throw InputError(std::exchange(pending_, ""));
    }
  }
  touching_.swap(touching_now_);
}

}  // namespace slipbench
