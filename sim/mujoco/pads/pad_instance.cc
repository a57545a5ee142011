#include "sim/mujoco/pads/pad_instance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/contact/several_surfaces.h"
#include "sim/contact/surface/thickness.h"
#include "sim/core/error.h"
#include "sim/mujoco/pads/pad_field.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

std::vector<Field> make_fields(ModelView model, const PadConfig& config, const Sensor& sensor,
                               std::span<const TouchedGeom> touched) {
  const PadLayout layout = without_dashpots(sensor.layout());
  std::vector<Field> fields;
  for (const TouchedGeom& one : touched) fields.push_back(make_pad_field(model, config, layout, one.geom, one.shape));
  return fields;
}

std::size_t state_values(std::span<const Field> fields) {
  std::size_t size = 0;
  for (const Field& field : fields) size += field.state_size();
  return size;
}

Wrench no_wrench() { return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}; }

}  // namespace

PadInstance::PadInstance(ModelView model, int instance, PadConfig config, const PadCatalogue& catalogue)
    : config_(std::move(config)),
      instance_(instance),
      step_(model.opt_timestep()),
      readout_(model, instance, config_, catalogue),
      kinematics_(model, config_, readout_.sensor().layout()),
      fields_(make_fields(model, config_, readout_.sensor(), kinematics_.touched())),
      layout_(config_, readout_.sensor(), state_values(fields_)),
      may_be_idle_(!config_.unchecked && config_.effects.empty() && config_.sensor.electronics.empty() && !readout_.has_memory()),
      began_with_(layout_.start()),
      applied_(fields_.size(), no_wrench()),
      poses_(fields_.size()),
      motions_(fields_.size()) {
  if (!config_.unchecked) {
    if (const std::string contact = possible_contact(model, config_); !contact.empty()) config_.report(contact);
  }
  if (layout_.total() != static_cast<std::size_t>(model.plugin_statenum()[instance_])) {
    throw std::logic_error("slipbench.field: a state of another size than the model was compiled for");
  }
}

PluginState PadInstance::state(ModelView model, DataView data) const {
  return {data.plugin_state() + model.plugin_stateadr()[instance_], layout_};
}

// A pad that keeps its state moves between any two calls, so comparing would cost more than it
// saves.
void PadInstance::locate(ModelView model, DataView data) {
  if (!kinematics_.locate(model, data, keeps_state_) && holds_trial()) phase_ = PadPhase::outdated;
}

// True if nothing needs to be computed: the pad has touched nothing, and cannot at its pose.
bool PadInstance::is_idle(ModelView model, DataView data, const PluginState& state, double time) {
  if (!may_be_idle_ || keeps_state_ || state.separation() < Separation::left || !(time >= state.committed_time())) return false;
  if (kinematics_.is_far(data)) return true;
  locate(model, data);
  return kinematics_.is_clear();
}

void PadInstance::load(const PluginState& state) {
  std::ranges::copy(state.start(), began_with_.begin());
  std::span<const double> rest = state.start();
  for (Field& field : fields_) {
    field.load_state(rest.first(field.state_size()));
    rest = rest.subspan(field.state_size());
  }
}

void PadInstance::save(const PluginState& state) {
  std::span<double> rest = state.start();
  for (Field& field : fields_) {
    field.save_state(rest.first(field.state_size()));
    rest = rest.subspan(field.state_size());
  }
}

// Makes the fields hold the trial at `time` for the poses found by locate().
void PadInstance::evaluate(const PluginState& state, double time) {
  const bool same_start = keeps_state_ || std::memcmp(state.start().data(), began_with_.data(), state.start().size_bytes()) == 0;
  if (holds_trial() && same_start && time == time_) return;
  const double dt = state.placed() ? time - state.committed_time() : 0.0;
  if (dt < 0.0) {
    throw InputError(fmt::format(
        "plugin '{}': the time went back from {:.9g} s to {:.9g} s without a reset; call mj_resetData, or restore the whole state with mj_setState",
        config_.name, state.committed_time(), time));
  }
  const bool at_start = phase_ == PadPhase::committed && same_start;
  phase_ = PadPhase::outdated;
  if (keeps_state_) {
    if (!at_start) throw std::logic_error("slipbench.field: a pad that keeps its state was tried twice from it");
  } else {
    if (!at_start) load(state);
    if (state.separation() == Separation::idle) {
      for (std::size_t k = 0; k < fields_.size(); ++k) {
        fields_[k].exclude({});
        fields_[k].step(kinematics_.stored_pad_in_surface(state.poses(), k), step_);
      }
    }
  }
  step_fields(dt);
  phase_ = PadPhase::evaluated;
  time_ = time;
  dt_ = dt;
}

void PadInstance::step_fields(double dt) {
  const std::vector<TouchedGeom>& touched = kinematics_.touched();
  if (fields_.size() == 1) {
    fields_.front().step(touched.front().pad_in_surface, dt, &touched.front().motion);
    return;
  }
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    poses_[k] = touched[k].pad_in_surface;
    motions_[k] = touched[k].motion;
  }
  step_on_surfaces(fields_, poses_, dt, motions_);
}

// Evaluates labels and sensor for the trial.
void PadInstance::measure(const PluginState& state) {
  if (phase_ == PadPhase::measured) return;
  readout_.measure(fields_, state, time_, dt_, step_);
  phase_ = PadPhase::measured;
}

// Refuses models in which a pad cannot work, and changes of the model that it cannot follow.
void PadInstance::check_model(ModelView model) const {
  readout_.check_step(step_, config_.name);
  const int no_passive_forces = mj::disable_spring | mj::disable_damper;
  if ((model.opt_disableflags() & no_passive_forces) == no_passive_forces) {
    throw InputError(fmt::format(
        "plugin '{}': the flags spring and damper are both disabled, so MuJoCo omits all passive forces, including the pad's; enable at least one",
        config_.name));
  }
  if (sleep_enabled(model)) {
    throw InputError(fmt::format(
        "plugin '{}': the flag sleep is enabled, but MuJoCo does not know that a pad connects two bodies, so a sleeping body would hang in the air when the other releases it; disable sleep",
        config_.name));
  }
  if (const double step = model.opt_timestep(); step != step_) {
    throw InputError(
        fmt::format("plugin '{}': the time step has changed from {:.9g} s to {:.9g} s; call mj_makeData after the change",
                    config_.name, step_, step));
  }
}

// Reads the sizes of the touched geoms again, which the caller may change between any two calls.
void PadInstance::follow_shapes(ModelView model) {
  if (!kinematics_.update_shapes(model)) return;
  fields_ = make_fields(model, config_, readout_.sensor(), kinematics_.touched());
  phase_ = PadPhase::outdated;
}

// Reports a mistake in the pose of the site once.
void PadInstance::check_site(ModelView model, const PluginState& state) {
  if (config_.unchecked || warned_) return;
  const std::string mistake = kinematics_.site_mistake(model, fields_, state.placed());
  warned_ = !mistake.empty();
  if (warned_) config_.report(mistake);
}

void PadInstance::add_force(ModelView model, DataView data) {
  if (!keeps_state_) {
    check_model(model);
    follow_shapes(model);
  }
  const PluginState state = this->state(model, data);
  computed_at_ = data.time();
  if (is_idle(model, data, state, data.time())) {
    phase_ = PadPhase::idle;
    std::ranges::fill(applied_, no_wrench());
    return;
  }
  locate(model, data);
  evaluate(state, data.time());
  check_site(model, state);
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const Wrench& wrench = applied_[k] = fields_[k].damped_wrench_on_pad(motion(k), config_.damping);
    if (wrench.force.isZero(0.0) && wrench.torque.isZero(0.0)) continue;
    kinematics_.apply(model, data, k, wrench);
  }
}

void PadInstance::describe(ModelView model, std::vector<ImplicitPad>& pads) const {
  double rotation[9];
  model.mujoco().mju_quat2Mat(rotation, model.site_quat() + 4 * config_.site);
  const Pose pad_in_body = pose_at(model.site_pos() + 3 * config_.site, rotation);
  for (const TouchedGeom& touched : kinematics_.touched()) {
    pads.push_back({kinematics_.pad_body(model), touched.body, pad_in_body, &readout_.sensor().layout()});
  }
}

void PadInstance::begin_implicit(ModelView model, DataView data, std::vector<ImplicitContact>& contacts) {
  check_model(model);
  follow_shapes(model);
  const PluginState state = this->state(model, data);
  computed_at_ = data.time();
  const int pad_body = kinematics_.pad_body(model);
  const Pose pad = kinematics_.pad_pose(data);
  if (is_idle(model, data, state, data.time())) {
    bool clear = kinematics_.stays_far(model, data, state.implicit(), step_);
    if (!clear) {
      locate(model, data);
      clear = kinematics_.stays_clear(state.implicit(), step_);
    }
    if (clear) {
      for (const TouchedGeom& touched : kinematics_.touched()) {
        contacts.push_back({nullptr, {}, pad_body, touched.body, pad, Pose{}});
      }
      return;
    }
  }
  locate(model, data);
  evaluate(state, data.time());
  check_site(model, state);
  ended_with_.resize(began_with_.size());
  std::span<double> rest = ended_with_;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const std::span<double> ended = rest.first(fields_[k].state_size());
    rest = rest.subspan(ended.size());
    fields_[k].save_state(ended);
    const TouchedGeom& touched = kinematics_.touched()[k];
    contacts.push_back({&fields_[k], ended, pad_body, touched.body, pad, kinematics_.surface_pose(data, k)});
    poses_[k] = touched.pad_in_surface;
    poses_[k].position += step_ * touched.motion.linear;
  }
  exclude_all_but_first(fields_, poses_);  // the solver steps one field at a time
}

// Ends the run. A pad of a scene has the name of its sensor.
void PadInstance::refuse(const std::string& what) const {
  if (config_.unchecked) throw SceneValueError("sensors." + config_.name, what);
  throw InputError(fmt::format("plugin '{}': {}", config_.name, what));
}

// The force of an element that has passed through a thin or round body would vanish without a
// message.
void PadInstance::refuse_lost(ModelView model) const {
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const std::optional<Field::Lost>& lost = fields_[k].lost();
    if (!lost) continue;
    const TouchedGeom& touched = kinematics_.touched()[k];
    const char* const body = model.name_of(mj::body, touched.body);
    const double thickness = thickness_of(touched.shape);
    refuse(fmt::format(
        "at {:.6g} s element {}, which was {:.3g} mm deep in geom '{}' of body '{}'{}, passed through it; press less or make the body thicker",
        time_, lost->element, 1e3 * lost->depth, name_of_geom(model, touched.geom), body == nullptr ? "" : body,
        std::isfinite(thickness) ? fmt::format(" ({:.3g} mm thick)", 1e3 * thickness) : ""));
  }
}

// Springs go on beyond the height of a unit, a real unit does not.
void PadInstance::refuse_overcompressed(ModelView model) const {
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const std::optional<std::size_t> element = fields_[k].overcompressed();
    if (!element) continue;
    refuse(fmt::format(
        "at {:.6g} s element {} is compressed by more than the height of a unit of the pad, {:.3g} mm, on geom '{}'; press less",
        time_, *element, 1e3 * fields_[k].layout().unit_height, name_of_geom(model, kinematics_.touched()[k].geom)));
  }
}

void PadInstance::write_sensors(ModelView model, DataView data) {
  check_model(model);
  if (!keeps_state_) follow_shapes(model);
  if (!readout_.has_outputs()) return;  // MuJoCo calls this for every instance, read or not
  const PluginState state = this->state(model, data);
  // RK4 commits at the end of a step, so that at the start of the next one nothing has moved: the
  // last readings are still valid.
  if ((state.placed() && data.time() == state.committed_time()) || is_idle(model, data, state, data.time())) {
    readout_.write_committed(data, state);
    return;
  }
  locate(model, data);
  evaluate(state, data.time());
  measure(state);
  if (!keeps_state_) readout_.write(data, state);
}

void PadInstance::keep_state() {
  if (phase_ != PadPhase::committed) throw std::logic_error("PadInstance::keep_state() must be called between two steps");
  keeps_state_ = true;
  readout_.stop_sampling();
}

void PadInstance::commit(ModelView model, DataView data) {
  if (!keeps_state_) check_model(model);
  const PluginState state = this->state(model, data);
  if (is_idle(model, data, state, computed_at_)) {
    state.committed_time() = computed_at_;
    readout_.commit_idle(state, computed_at_);
    kinematics_.store_poses(data, state.poses());
    state.set_separation(Separation::idle);
    if (holds_trial()) phase_ = PadPhase::outdated;
    return;
  }
  // With keep_state() nothing has moved since the force was computed.
  if (!(keeps_state_ && holds_trial())) {
    locate(model, data);
    evaluate(state, computed_at_);
  }
  refuse_lost(model);
  // Not in the first step, which MuJoCo's compiler takes before bodies are where the scene has them.
  if (state.placed()) refuse_overcompressed(model);
  state.committed_time() = time_;
  if (readout_.watched()) {
    measure(state);
    readout_.commit(fields_, state, dt_);
  }
  phase_ = PadPhase::committed;
  if (keeps_state_) {
    state.set_placed();
    return;
  }
  save(state);
  const Separation before = state.separation();
  if (std::ranges::any_of(fields_, [](const Field& field) { return field.touching() > 0; })) {
    state.set_separation(Separation::touching);
  } else if (before == Separation::touching || (before == Separation::just_left && readout_.watched() && !readout_.sampled())) {
    state.set_separation(Separation::just_left);
  } else {
    state.set_separation(Separation::left);
  }
  std::ranges::copy(state.start(), began_with_.begin());
}

void PadInstance::draw(ModelView model, DataView data, SlipbenchScene* scene) {
  const PluginState state = this->state(model, data);
  locate(model, data);
  evaluate(state, data.time());

  const Pose pad = kinematics_.pad_pose(data);
  const double radius = model.site_size()[3 * config_.site];
  constexpr double metres_per_newton = 0.01;  // at MuJoCo's default scale of forces
  constexpr double default_force_scale = 0.005;
  constexpr float colours[3][4] = {{0.55F, 0.58F, 0.62F, 1.0F}, {0.17F, 0.48F, 0.75F, 1.0F}, {0.82F, 0.29F, 0.11F, 1.0F}};
  const double scale = metres_per_newton * model.vis_map_force() / default_force_scale;
  const MujocoLibrary& mujoco = model.mujoco();
  // Returns a new geom of decoration, or null if the scene is full.
  const auto next_geom = [&](int type, const double* size, const double* position, const float* colour) -> mjvGeom_* {
    if (scene->ngeom >= scene->maxgeom) return nullptr;
    char* const geom = scene->geoms + static_cast<std::ptrdiff_t>(mujoco.layout.mjvGeom_size) * scene->ngeom++;
    mujoco.mjv_initGeom(reinterpret_cast<mjvGeom_*>(geom), type, size, position, nullptr, colour);
    reinterpret_cast<SlipbenchGeom*>(geom)->category = mj::decor;
    return reinterpret_cast<mjvGeom_*>(geom);
  };
  for (Field& field : fields_) field.view_from_pad();
  for (std::size_t i = 0; i < fields_.front().size(); ++i) {
    Eigen::Vector3d tip = fields_.front().layout().elements[i].tip, force = Eigen::Vector3d::Zero();
    ElementState shown = ElementState::detached;
    for (const Field& field : fields_) {
      if (field.state(i) == ElementState::detached) continue;
      tip += field.deflection(i);
      force += field.force_on_pad(i);
      // After a step the kinematics are those of the commit: nothing has moved since, and elements
      // that slipped would seem to stick.
      shown = state.placed() ? field.state_before(i) : field.state(i);
    }
    const Eigen::Vector3d from = pad * tip, to = from + scale * (pad.rotation * force);
    const float* colour = colours[static_cast<std::size_t>(shown)];
    const double size[3] = {radius, radius, radius};
    next_geom(mj::sphere_geom, size, from.data(), colour);
    if (shown == ElementState::detached) continue;
    if (mjvGeom_* arrow = next_geom(mj::arrow_geom, nullptr, nullptr, colour)) {
      mujoco.mjv_connector(arrow, mj::arrow_geom, 0.4 * radius, from.data(), to.data());
    }
  }
}

}  // namespace slipbench
