#include "sim/mujoco/pads/pad_instance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "sim/contact/several_surfaces.h"
#include "sim/contact/surface/thickness.h"
#include "sim/core/error.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/mujoco/mujoco_differences.h"
#include "sim/mujoco/pads/geom_surface.h"

namespace slipbench {
namespace {

// Header of the instance's share of plugin_state. All zero: never stepped.
enum Header : std::size_t { committed_time, next_sample, slip_angle, header_size };

// Work that an instance without contact may skip, but only after two steps without contact and one
// sample: a step that ends without contact may have slipped, and a sensor may have read the
// previous step.
namespace phase {
// resting: since then only the poses are those of the last step
constexpr double awake = 0.0, apart_once = 1.0, apart = 2.0, resting = 3.0;
}  // namespace phase

// Stored with the fields' states: the poses of the pad and of each touched geom, position and
// rotation in MuJoCo's format, then the phase.
constexpr std::size_t frame_values = 12;
std::size_t rest_values(const PadConfig& config) { return frame_values * (1 + config.geoms.size()) + 1; }
mjtNum* save_frame(const mjtNum* position, const mjtNum* rotation, mjtNum* to) {
  return std::copy_n(rotation, 9, std::copy_n(position, 3, to));
}

constexpr double far_enough = 1e-5;  // m, more than the rounding of positions

// A sample is due when its time is reached up to the rounding of a sum of steps.
constexpr double rounding = 1e-6;

std::size_t channel_values(const Sensor& sensor) {
  std::size_t size = 0;
  for (const Channel& channel : sensor.channels()) size += channel.size();
  return size;
}

std::size_t truth_values(const PadConfig& config, const Sensor& sensor) {
  return config.truth ? 8 * sensor.layout().units.size() + 3 : 0;
}

std::size_t implicit_values(const PadConfig& config) {
  return config.implicit ? config.geoms.size() * ImplicitFields::memory_per_contact : 0;
}

std::size_t memory_values(Sensor& sensor) {
  std::size_t size = 0;
  for (const std::span<double> memory : sensor.memory()) size += memory.size();
  return size;
}

// Returns the geom's name, or its number if it has none.
std::string name_of_geom(const mjModel* model, int geom) {
  const char* name = mj_id2name(model, mjOBJ_GEOM, geom);
  return name == nullptr ? std::to_string(geom) : name;
}

Field field_of(const mjModel* model, const PadConfig& config, const PadLayout& layout, int geom, const Surface& surface) {
  FieldEffects effects;
  try {
    effects = install_effects(config.effects, layout, surface, config.seed, config.trial);
  } catch (const SceneValueError& error) {
    throw InputError(fmt::format("plugin '{}', geom '{}': {}", config.name, name_of_geom(model, geom), error.what()));
  }
  // Bodies that move by forces accelerate below the tips, and are solved with springs that have no
  // state of their own.
  if (effects.tip) {
    throw InputError(
        fmt::format("plugin '{}': effects: inertia works only for pads with a prescribed motion; leave it out", config.name));
  }
  if (effects.skin && config.implicit) {
    throw InputError(fmt::format(
        "plugin '{}': effects: elastic_skin does not work with the implicit solver; use solver='explicit'", config.name));
  }
  return {layout, surface, config.friction, std::move(effects)};
}

// Returns a surface of the same kind as the geom's, as far as effects distinguish kinds and the
// state's size depends on it.
Surface kind_of_surface(int geom_type) {
  if (geom_type == mjGEOM_PLANE) return Plane{};
  if (geom_type == mjGEOM_BOX) return Box{{1.0, 1.0, 1.0}};
  return Sphere{1.0};
}

// True if the fields of a state have been stepped (Field::save_state).
bool is_placed(std::span<const double> fields) { return fields[0] != 0.0; }

using MjMatrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using MjVector = Eigen::Map<const Eigen::Vector3d>;

Pose pose_at(const mjtNum* position, const mjtNum* rotation) { return {MjMatrix(rotation), MjVector(position)}; }

bool same(const Pose& a, const Pose& b) { return a.position == b.position && a.rotation == b.rotation; }

// Returns the velocity in the world of a frame of body `body` at `point`, like mj_objectVelocity.
// cvel, rotation first, is that of the reference point of the body's tree.
Twist velocity_of(const mjModel* model, const mjData* data, int body, const mjtNum* point) {
  const MjVector angular(data->cvel + 6 * body), linear(data->cvel + 6 * body + 3);
  const Eigen::Vector3d arm = MjVector(point) - MjVector(data->subtree_com + 3 * model->body_rootid[body]);
  return {linear - arm.cross(angular), angular};
}

// Adds a force and a torque at `point` of a body to qfrc_passive, like mj_applyFT, but only along
// the body's own degrees of freedom; a body fixed to the world has none.
void push(const mjModel* model, mjData* data, const Eigen::Vector3d& force, const Eigen::Vector3d& torque, const mjtNum* point,
          int body) {
  const int moving = model->body_weldid[body];
  if (moving == 0) return;
  const Eigen::Vector3d arm = MjVector(point) - MjVector(data->subtree_com + 3 * model->body_rootid[body]);
  Eigen::Matrix<double, 6, 1> wrench;  // rotation first, about cdof's reference point
  wrench << torque + arm.cross(force), force;
  for (int dof = model->body_dofadr[moving] + model->body_dofnum[moving] - 1; dof >= 0; dof = model->dof_parentid[dof]) {
    data->qfrc_passive[dof] += Eigen::Map<const Eigen::Matrix<double, 6, 1>>(data->cdof + 6 * dof).dot(wrench);
  }
}

// Writes values for readers. Adding 0 removes the sign that a zero gets from the rotation into the
// pad's frame.
template <class Values>
double* write_values(const Values& values, double* out) {
  return std::transform(std::begin(values), std::end(values), out, [](auto value) { return static_cast<double>(value) + 0.0; });
}

void write_truth(const ContactFrame& frame, double unloaded, double* out) {
  const Eigen::Index n = frame.margin.size();
  const auto numbers = [](const auto& array) { return std::span(array.data(), static_cast<std::size_t>(array.size())); };
  const auto or_unloaded = [unloaded](double value) { return std::isnan(value) ? unloaded : value; };
  for (const UnitState state : frame.unit_state) *out++ = static_cast<double>(state);
  out = write_values(numbers(frame.slip_velocity), out);
  out = write_values(numbers(frame.slip_distance), out);
  out = std::transform(frame.margin.data(), frame.margin.data() + n, out, or_unloaded);
  out = write_values(numbers(frame.contact_force), out);
  *out++ = static_cast<double>(frame.state);
  *out++ = static_cast<double>(frame.state_micro);
  *out++ = or_unloaded(frame.stuck_fraction);
}

}  // namespace

PadLayout without_dashpots(PadLayout layout) {
  for (Element& element : layout.elements) element.c_normal = element.c_tangential = 0.0;
  return layout;
}

std::size_t pad_state_size(const mjModel* model, const PadConfig& config, const PadCatalogue& catalogue) {
  const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue);
  const PadLayout layout = without_dashpots(sensor->layout());
  std::size_t fields = 0;
  for (const int geom : config.geoms) {
    fields += field_of(model, config, layout, geom, kind_of_surface(model->geom_type[geom])).state_size();
  }
  return header_size + fields + rest_values(config) + implicit_values(config) + memory_values(*sensor) +
         pad_sensor_size(config, catalogue);
}

std::size_t pad_sensor_size(const PadConfig& config, const PadCatalogue& catalogue) {
  const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue);
  return channel_values(*sensor) + truth_values(config, *sensor);
}

PadInstance::PadInstance(const mjModel* model, int instance, PadConfig config, const PadCatalogue& catalogue)
    : config_(std::move(config)),
      instance_(instance),
      sensor_(config_.make_sensor(catalogue)),
      sensor_memory_(sensor_->memory()),
      feels_every_tick_(sensor_->feels_every_tick()),
      labels_(sensor_->layout()),
      step_(model->opt.timestep),
      sample_time_(sensor_->rate() > 0.0 ? 1.0 / (sensor_->rate() * static_cast<double>(sensor_->scans())) : 0.0) {
  const PadLayout layout = without_dashpots(sensor_->layout());
  for (const int geom : config_.geoms) {
    const GeomSurface surface = surface_of_geom(model, geom);
    fields_.push_back(field_of(model, config_, layout, geom, surface.shape));
    const SiteWatch watch(layout);
    // A mesh's grid is rounded beyond the bounding ball.
    const bool in_ball = model->geom_rbound[geom] > 0.0 && model->geom_type[geom] != mjGEOM_MESH;
    touched_.push_back({geom, model->geom_bodyid[geom], surface.in_geom, surface.shape, watch,
                        in_ball ? model->geom_rbound[geom] + watch.radius() + far_enough : 0.0});
  }
  for (int id = 0; id < static_cast<int>(model->nsensor); ++id) {
    if (model->sensor_plugin[id] == instance_) outputs_.push_back(model->sensor_adr[id]);
  }
  watched_ = !outputs_.empty();
  for (const std::span<double> memory : sensor_memory_) first_memory_.insert(first_memory_.end(), memory.begin(), memory.end());
  may_rest_ = !config_.unchecked && config_.effects.empty() && config_.sensor.electronics.empty() && first_memory_.empty();
  constexpr std::size_t seen_of_a_frame = 21;
  pads_in_surfaces_.resize(fields_.size());
  motions_.resize(fields_.size());
  seen_.resize(seen_of_a_frame * (1 + config_.geoms.size()));
  sees_.resize(seen_.size());
  truth_ = truth_values(config_, *sensor_);
  readings_ = channel_values(*sensor_) + truth_;
  for (const Touched& touched : touched_) {
    if (model->body_weldid[touched.body] == model->body_weldid[model->site_bodyid[config_.site]]) {
      throw InputError(fmt::format("plugin '{}': the touched geom '{}' moves with the pad; name a geom of another body",
                                   config_.name, name_of_geom(model, touched.geom)));
    }
  }
  if (!config_.unchecked) {
    if (const std::string contact = possible_contact(model, config_); !contact.empty()) config_.report(contact);
  }
  std::size_t size = 0;
  for (Field& field : fields_) size += field.state_size();
  size += rest_values(config_);
  began_with_.resize(size);
  size += header_size + implicit_values(config_) + first_memory_.size() + readings_;
  if (size != static_cast<std::size_t>(model->plugin_statenum[instance_])) {
    throw std::logic_error("slipbench.field: a state of another size than the model was compiled for");
  }
}

PadInstance::Parts PadInstance::parts(const mjModel* model, mjData* data) const {
  std::span<double> rest(data->plugin_state + model->plugin_stateadr[instance_],
                         static_cast<std::size_t>(model->plugin_statenum[instance_]));
  const auto take = [&rest](std::size_t size) {
    const std::span<double> part = rest.first(size);
    rest = rest.subspan(size);
    return part;
  };
  return {.header = take(header_size),
          .fields = take(began_with_.size()),
          .implicit = take(implicit_values(config_)),
          .memory = take(rest.size() - readings_),
          .held = take(readings_ - truth_),
          .truth = take(truth_)};
}

// True if poses and velocities are those of the last call. Cheaper than recomputing the same
// results.
bool PadInstance::sees_the_same(const mjModel* model, const mjData* data) {
  double* out = sees_.data();
  const auto look_at_frame = [&](const mjtNum* position, const mjtNum* rotation, int body) {
    out = std::copy_n(position, 3, out);
    out = std::copy_n(rotation, 9, out);
    out = std::copy_n(data->cvel + 6 * body, 6, out);
    // cvel's reference point
    out = std::copy_n(data->subtree_com + 3 * model->body_rootid[body], 3, out);
  };
  look_at_frame(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site, model->site_bodyid[config_.site]);
  for (const Touched& touched : touched_) {
    look_at_frame(data->geom_xpos + 3 * touched.geom, data->geom_xmat + 9 * touched.geom, touched.body);
  }
  if (std::memcmp(sees_.data(), seen_.data(), sees_.size() * sizeof(double)) == 0) return true;
  seen_.swap(sees_);
  clear_.reset();
  return false;
}

// Finds the pad in the frame of every touched surface. Returns true if it is at the pose of the
// fields' present trial.
bool PadInstance::locate(const mjModel* model, const mjData* data) {
  if (!keeps_state_ && sees_the_same(model, data)) return evaluated_;
  bool unmoved = evaluated_;
  const Pose pad = pose_at(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site);
  const Twist pad_motion = velocity_of(model, data, model->site_bodyid[config_.site], data->site_xpos + 3 * config_.site);
  for (Touched& touched : touched_) {
    const Pose geom = pose_at(data->geom_xpos + 3 * touched.geom, data->geom_xmat + 9 * touched.geom);
    const Pose world_in_surface = (geom * touched.surface_in_geom).inverse();
    const Pose pad_in_surface = world_in_surface * pad;
    const Twist geom_motion = velocity_of(model, data, touched.body, data->geom_xpos + 3 * touched.geom);
    const Eigen::Vector3d spin = pad_motion.angular - geom_motion.angular;
    const Eigen::Vector3d carried = geom_motion.linear + geom_motion.angular.cross(pad.position - geom.position);
    const Twist motion{world_in_surface.rotation * (pad_motion.linear - carried), world_in_surface.rotation * spin};
    unmoved = unmoved && same(pad_in_surface, touched.pad_in_surface) && motion.linear == touched.motion.linear &&
              motion.angular == touched.motion.angular;
    touched.pad_in_surface = pad_in_surface;
    touched.motion = motion;
  }
  return unmoved;
}

// Makes the fields hold the trial at `time` for the poses found by locate().
void PadInstance::evaluate(const Parts& state, double time) {
  const bool same_start = keeps_state_ || std::memcmp(state.fields.data(), began_with_.data(), state.fields.size_bytes()) == 0;
  if (evaluated_ && same_start && time == time_) return;
  const double dt = is_placed(state.fields) ? time - state.header[committed_time] : 0.0;
  if (dt < 0.0) {
    throw InputError(fmt::format(
        "plugin '{}': the time went back from {:.9g} s to {:.9g} s without a reset; call mj_resetData, or restore the whole state with mj_setState",
        config_.name, state.header[committed_time], time));
  }
  if (keeps_state_) {
    if (std::exchange(tried_, true))
      throw std::logic_error("slipbench.field: a pad that keeps its state was tried twice from it");
  } else if (!(fields_hold_state_ && same_start)) {
    std::copy(state.fields.begin(), state.fields.end(), began_with_.begin());
    std::span<const double> rest = state.fields;
    for (Field& field : fields_) {
      field.load_state(rest.first(field.state_size()));
      rest = rest.subspan(field.state_size());
    }
  }
  if (!keeps_state_ && state.fields.back() == phase::resting) {
    const double* frame = state.fields.last(rest_values(config_)).data();
    const Pose pad = pose_at(frame, frame + 3);
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      frame += frame_values;
      fields_[k].exclude({});
      fields_[k].step((pose_at(frame, frame + 3) * touched_[k].surface_in_geom).inverse() * pad, step_);
    }
  }
  if (fields_.size() == 1) {
    fields_.front().step(touched_.front().pad_in_surface, dt, &touched_.front().motion);
  } else {
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      pads_in_surfaces_[k] = touched_[k].pad_in_surface;
      motions_[k] = touched_[k].motion;
    }
    step_on_surfaces(fields_, pads_in_surfaces_, dt, motions_);
  }
  fields_hold_state_ = false;
  evaluated_ = true;
  judged_ = measured_ = false;
  time_ = time;
  dt_ = dt;
}

// True if nothing needs to be computed: the pad has touched nothing, and cannot at its pose. Most
// pads are so far away that the bounding balls of the pad and the touched geoms suffice.
bool PadInstance::is_idle(const mjModel* model, const mjData* data, const Parts& state, double time) {
  if (!may_rest_ || keeps_state_ || state.fields.back() < phase::apart || !(time >= state.header[committed_time])) return false;
  const MjVector pad(data->site_xpos + 3 * config_.site);
  if (std::ranges::all_of(touched_, [&](const Touched& touched) {
        return touched.reach > 0.0 &&
               (pad - MjVector(data->geom_xpos + 3 * touched.geom)).squaredNorm() > touched.reach * touched.reach;
      })) {
    return true;
  }
  evaluated_ = locate(model, data);
  if (!clear_) {
    clear_ = std::ranges::all_of(
        touched_, [](const Touched& touched) { return touched.watch.clearance(touched.shape, touched.pad_in_surface) > 0.0; });
  }
  return *clear_;
}

// Commits a pad at rest.
void PadInstance::commit_idle(const mjData* data, const Parts& state, double time) {
  state.header[committed_time] = time;
  if (watched_ && sample_time_ > 0.0 && sample_is_due(time, state.header[next_sample])) {
    state.header[next_sample] = std::floor(time / sample_time_ + rounding) + 1.0;
  }
  const std::span<double> kept = state.fields.last(rest_values(config_));
  mjtNum* to = save_frame(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site, kept.data());
  for (const Touched& touched : touched_)
    to = save_frame(data->geom_xpos + 3 * touched.geom, data->geom_xmat + 9 * touched.geom, to);
  kept.back() = phase::resting;
  evaluated_ = false;
}

bool PadInstance::sample_is_due(double time, double next) const {
  return sample_time_ == 0.0 || time >= sample_time_ * (next - rounding);
}

void PadInstance::judge(const Parts& state) {
  if (judged_) return;
  labels_.set_slip_angle(state.header[slip_angle]);
  // without elapsed time nothing has slipped
  labels_.judge(fields_, time_, dt_ > 0.0 ? dt_ : step_);
  if (!keeps_state_) labels_.fill(fields_, FramePart::all);
  judged_ = true;
}

// Evaluates labels and sensor for the trial.
void PadInstance::measure(const Parts& state) {
  if (measured_) return;
  judge(state);
  next_sample_ = state.header[next_sample];
  // A simulation that keeps the state reads labels_ by its own sensors.
  sampled_ = !keeps_state_ && sample_is_due(time_, next_sample_);
  if (sampled_ || feels_every_tick_) {
    const double* remembered = is_placed(state.fields) ? state.memory.data() : first_memory_.data();
    for (const std::span<double> memory : sensor_memory_) {
      std::copy_n(remembered, memory.size(), memory.begin());
      remembered += memory.size();
    }
  }
  if (sampled_) {
    sample_ = sensor_->measure(labels_.frame()).values;
    if (sample_time_ > 0.0) next_sample_ = std::floor(time_ / sample_time_ + rounding) + 1.0;
  } else if (feels_every_tick_) {
    sensor_->feel(labels_.frame());
  }
  measured_ = true;
}

void PadInstance::refuse_what_cannot_work(const mjModel* model) const {
  // One reading per step: at a longer step a multiplexed sensor would miss electrodes, not only
  // samples.
  if (sensor_->scans() > 1 && step_ > sample_time_ * (1.0 + rounding)) {
    throw InputError(fmt::format("plugin '{}': the time step {} must not be longer than the sampling time of the sensor, {}",
                                 config_.name, format_quantity(std::stod(fmt::format("{:.3g}", step_)), Quantity::time),
                                 format_quantity(std::stod(fmt::format("{:.3g}", sample_time_)), Quantity::time)));
  }
  const int no_passive_forces = mjDSBL_SPRING | mjDSBL_DAMPER;
  if ((model->opt.disableflags & no_passive_forces) == no_passive_forces) {
    throw InputError(fmt::format(
        "plugin '{}': the flags spring and damper are both disabled, so MuJoCo omits all passive forces, including the pad's; enable at least one",
        config_.name));
  }
  if (sleep_enabled(model)) {
    throw InputError(fmt::format(
        "plugin '{}': the flag sleep is enabled, but MuJoCo does not know that a pad connects two bodies, so a sleeping body would hang in the air when the other releases it; disable sleep",
        config_.name));
  }
  if (const double step = model->opt.timestep; step != step_) {
    throw InputError(
        fmt::format("plugin '{}': the time step has changed from {:.9g} s to {:.9g} s; call mj_makeData after the change",
                    config_.name, step_, step));
  }
}

// Reports a mistake in the model: a pad that exerts no force because it points away, or a huge
// force because it starts deep inside.
void PadInstance::check_site(const mjModel* model, bool placed) {
  std::size_t touching = 0;  // on any geom: one may lie beside another
  for (const Field& field : fields_) touching += field.touching();
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    Touched& touched = touched_[k];
    const auto mistake = [&](const std::string& where, const std::string& what) {
      if (std::exchange(warned_, true)) return;
      config_.report(fmt::format("tips of the pad at site '{}' are {} the touched geom '{}'{}",
                                 mj_id2name(model, mjOBJ_SITE, config_.site), where, name_of_geom(model, touched.geom), what));
    };
    if (touched.watch.looks_out(touched.shape, touched.pad_in_surface, touching)) {
      mistake(
          "inside",
          " and point out of it: the site points the wrong way or lies inside; its +Z must point from the touched object into the pad");
    }
    if (placed || fields_[k].touching() == 0) continue;
    double deepest = 0.0;
    for (std::size_t i = 0; i < fields_[k].size(); ++i) deepest = std::max(deepest, fields_[k].penetration(i));
    if (deepest > touched.watch.deepest_start()) {
      mistake(fmt::format("{:.3g} mm inside", 1e3 * deepest),
              fmt::format(" at the start; allowed: up to {:.3g} mm", 1e3 * touched.watch.deepest_start()));
    }
  }
}

void PadInstance::add_force(const mjModel* model, mjData* data) {
  if (!keeps_state_) refuse_what_cannot_work(model);
  const Parts state = parts(model, data);
  computed_at_ = data->time;
  rested_ = is_idle(model, data, state, data->time);
  if (rested_) {
    for (Touched& touched : touched_) touched.applied = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    return;
  }
  evaluated_ = locate(model, data);
  evaluate(state, data->time);
  if (!config_.unchecked) check_site(model, is_placed(state.fields));
  const mjtNum* origin = data->site_xpos + 3 * config_.site;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const Wrench& wrench = touched_[k].applied = fields_[k].damped_wrench_on_pad(touched_[k].motion, config_.damping);
    if (wrench.force.isZero(0.0) && wrench.torque.isZero(0.0)) continue;
    const Touched& touched = touched_[k];
    const Eigen::Matrix3d surface = MjMatrix(data->geom_xmat + 9 * touched.geom) * touched.surface_in_geom.rotation;
    const Eigen::Vector3d force = surface * wrench.force, torque = surface * wrench.torque;
    const Eigen::Vector3d back_force = -force, back_torque = -torque;
    push(model, data, force, torque, origin, model->site_bodyid[config_.site]);
    push(model, data, back_force, back_torque, origin, touched.body);
  }
}

bool PadInstance::placed(const mjModel* model, mjData* data) const { return is_placed(parts(model, data).fields); }

void PadInstance::add_touching_tangents(const mjModel* model, const mjData* data, PadTangents& pads) const {
  const Pose pad = pose_at(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site);
  if (rested_) return;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    PadLayout touching;
    for (std::size_t i = 0; i < fields_[k].size(); ++i) {
      if (!fields_[k].bears(i)) continue;
      touching.elements.push_back(fields_[k].layout().elements[i]);
      touching.elements.back().k_tangential += fields_[k].stop_stiffness();
    }
    if (touching.elements.empty()) continue;
    pads.bodies.push_back({model->site_bodyid[config_.site], touched_[k].body, pad.position});
    pads.tangents.push_back(stuck_tangent(touching, pad, pad.position, config_.damping));
  }
}

void PadInstance::add_stuck_tangent(const mjModel* model, mjData* data, PadTangents& pads) const {
  const Pose pad = pose_at(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site);
  PadOnBodies on{};
  PadTangent tangent;
  double fastest = -1.0;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const Touched& touched = touched_[k];
    const Pose placed = pose_at(data->geom_xpos + 3 * touched.geom, data->geom_xmat + 9 * touched.geom) * touched.surface_in_geom;
    const Eigen::Vector3d origin = placed.inverse() * pad.position, axis = -(placed.rotation.transpose() * pad.rotation.col(2));
    const SurfacePoint met =
        std::visit([&](const auto& shape) { return shape.at(origin.x(), origin.y(), origin.z(), axis.x(), axis.y(), axis.z()); },
                   touched.shape);
    Pose there = pad;  // at its present distance it would have a lever that never occurs
    if (met.gap > 0.0) there.position -= met.gap * (placed.rotation * Eigen::Vector3d(met.nx, met.ny, met.nz));
    PadLayout layout = fields_[k].layout();
    for (Element& element : layout.elements) element.k_tangential += fields_[k].stop_stiffness();
    const PadOnBodies candidate{model->site_bodyid[config_.site], touched.body, there.position};
    const PadTangent stuck = stuck_tangent(layout, there, there.position, config_.damping);
    const double omega = fastest_vibration(model, data, {&candidate, 1}, {&stuck, 1}).omega;
    if (omega <= fastest) continue;
    fastest = omega;
    on = candidate;
    tangent = stuck;
  }
  pads.bodies.push_back(on);
  pads.tangents.push_back(tangent);
}

void PadInstance::describe(const mjModel* model, std::vector<ImplicitPad>& pads) const {
  mjtNum rotation[9];
  mju_quat2Mat(rotation, model->site_quat + 4 * config_.site);
  const Pose pad_in_body = pose_at(model->site_pos + 3 * config_.site, rotation);
  for (const Touched& touched : touched_) {
    pads.push_back({model->site_bodyid[config_.site], touched.body, pad_in_body, &sensor_->layout()});
  }
}

void PadInstance::begin_implicit(const mjModel* model, mjData* data, std::vector<ImplicitContact>& contacts) {
  refuse_what_cannot_work(model);
  const Parts state = parts(model, data);
  computed_at_ = data->time;
  const Pose pad = pose_at(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site);
  if (is_idle(model, data, state, data->time) && stays_clear(model, data, state)) {
    for (const Touched& touched : touched_) {
      contacts.push_back({nullptr, {}, model->site_bodyid[config_.site], touched.body, pad, Pose{}});
    }
    return;
  }
  evaluated_ = locate(model, data);
  evaluate(state, data->time);
  if (!config_.unchecked) check_site(model, is_placed(state.fields));
  ended_with_.resize(began_with_.size());
  std::span<double> rest = ended_with_;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const std::span<double> ended = rest.first(fields_[k].state_size());
    rest = rest.subspan(ended.size());
    fields_[k].save_state(ended);
    const Touched& touched = touched_[k];
    const Pose geom = pose_at(data->geom_xpos + 3 * touched.geom, data->geom_xmat + 9 * touched.geom);
    contacts.push_back({&fields_[k], ended, model->site_bodyid[config_.site], touched.body, pad, geom * touched.surface_in_geom});
    pads_in_surfaces_[k] = touched.pad_in_surface;
    pads_in_surfaces_[k].position += step_ * touched.motion.linear;
  }
  exclude_all_but_first(fields_, pads_in_surfaces_);  // the solver steps one field at a time
}

// The force of an element that has passed through a thin or round body would vanish without a
// message.
void PadInstance::refuse_lost(const mjModel* model) const {
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const std::optional<Field::Lost>& lost = fields_[k].lost();
    if (!lost) continue;
    const int geom = touched_[k].geom;
    const char* const body = mj_id2name(model, mjOBJ_BODY, touched_[k].body);
    const double thickness = thickness_of(touched_[k].shape);
    throw InputError(fmt::format(
        "plugin '{}': at {:.6g} s element {}, which was {:.3g} mm deep in geom '{}' of body '{}'{}, passed through it; press less or make the body thicker",
        config_.name, time_, lost->element, 1e3 * lost->depth, name_of_geom(model, geom), body == nullptr ? "" : body,
        std::isfinite(thickness) ? fmt::format(" ({:.3g} mm thick)", 1e3 * thickness) : ""));
  }
}

// True if the pad touches nothing at the end of the step either, as predicted by the implicit
// solver from its velocity and the relative acceleration in its memory. A tip's displacement is at
// most its path.
bool PadInstance::stays_clear(const mjModel* model, const mjData* data, const Parts& state) {
  const MjVector pad(data->site_xpos + 3 * config_.site);
  const Eigen::Vector3d motion = velocity_of(model, data, model->site_bodyid[config_.site], pad.data()).linear;
  const auto gained = [&](std::size_t k) { return state.implicit.data() + ImplicitFields::memory_per_contact * k; };
  bool far = true;
  for (std::size_t k = 0; far && k < touched_.size(); ++k) {
    const Eigen::Vector3d speed = motion - velocity_of(model, data, touched_[k].body, pad.data()).linear;
    const double way = step_ * (speed.norm() + step_ * MjVector(gained(k)).norm()), apart = touched_[k].reach + way;
    far = touched_[k].reach > 0.0 && (pad - MjVector(data->geom_xpos + 3 * touched_[k].geom)).squaredNorm() > apart * apart;
  }
  if (far) return true;
  evaluated_ = locate(model, data);
  for (std::size_t k = 0; k < touched_.size(); ++k) {
    const Touched& touched = touched_[k];
    const double radius = touched.watch.radius();
    const double speed = touched.motion.linear.norm() + touched.motion.angular.norm() * radius +
                         step_ * (MjVector(gained(k)).norm() + MjVector(gained(k) + 3).norm() * radius);
    if (!(touched.watch.clearance(touched.shape, touched.pad_in_surface) > step_ * speed)) return false;
  }
  return true;
}

void PadInstance::write_sensors(const mjModel* model, mjData* data) {
  refuse_what_cannot_work(model);
  if (outputs_.empty()) return;  // MuJoCo calls this for every instance, read or not
  const Parts state = parts(model, data);
  // RK4 commits at the end of a step, so that at the start of the next one nothing has moved: the
  // last readings are still valid.
  if ((is_placed(state.fields) && data->time == state.header[committed_time]) || is_idle(model, data, state, data->time)) {
    for (const int address : outputs_) {
      mjtNum* const out = std::copy(state.held.begin(), state.held.end(), data->sensordata + address);
      std::copy(state.truth.begin(), state.truth.end(), out);
    }
    return;
  }
  evaluated_ = locate(model, data);
  evaluate(state, data->time);
  measure(state);
  if (keeps_state_) return;
  for (const int address : outputs_) {
    mjtNum* const out = data->sensordata + address;
    sampled_ ? write_values(sample_, out) : std::copy(state.held.begin(), state.held.end(), out);
    if (config_.truth) write_truth(labels_.frame(), config_.unloaded, out + state.held.size());
  }
}

void PadInstance::commit(const mjModel* model, mjData* data) {
  if (!keeps_state_) refuse_what_cannot_work(model);
  const Parts state = parts(model, data);
  if (is_idle(model, data, state, computed_at_)) {
    commit_idle(data, state, computed_at_);
    return;
  }
  // With keep_state() nothing has moved since the force was computed.
  if (!(keeps_state_ && tried_)) {
    evaluated_ = locate(model, data);
    evaluate(state, computed_at_);
  }
  refuse_lost(model);
  state.header[committed_time] = time_;
  if (watched_) remember_readings(state);
  evaluated_ = false;
  if (keeps_state_) {
    tried_ = false;
    state.fields[0] = 1.0;  // is_placed()
    return;
  }
  std::span<double> rest = state.fields;
  for (Field& field : fields_) {
    field.save_state(rest.first(field.state_size()));
    rest = rest.subspan(field.state_size());
  }
  double& now = state.fields.back();
  if (std::ranges::any_of(fields_, [](const Field& field) { return field.touching() > 0; })) {
    now = phase::awake;
  } else if (now == phase::awake || (now == phase::apart_once && watched_ && !sampled_)) {
    now = phase::apart_once;
  } else {
    now = phase::apart;
  }
  std::copy(state.fields.begin(), state.fields.end(), began_with_.begin());
  fields_hold_state_ = true;
}

// Stores the state that labels and sensor carry to the next step.
void PadInstance::remember_readings(const Parts& state) {
  measure(state);
  labels_.settle(fields_, dt_);
  state.header[next_sample] = next_sample_;
  state.header[slip_angle] = labels_.frame().slip_angle;
  if (sampled_ || feels_every_tick_) {
    double* remembered = state.memory.data();
    for (const std::span<double> memory : sensor_memory_) remembered = std::copy(memory.begin(), memory.end(), remembered);
  }
  if (sampled_) write_values(sample_, state.held.data());
  if (config_.truth) write_truth(labels_.frame(), config_.unloaded, state.truth.data());
}

void PadInstance::draw(const mjModel* model, mjData* data, mjvScene* scene) {
  constexpr double metres_per_newton = 0.01;  // at MuJoCo's default scale of forces
  constexpr double default_force_scale = 0.005;
  constexpr float colours[3][4] = {{0.55F, 0.58F, 0.62F, 1.0F}, {0.17F, 0.48F, 0.75F, 1.0F}, {0.82F, 0.29F, 0.11F, 1.0F}};
  const Parts state = parts(model, data);
  evaluated_ = locate(model, data);
  evaluate(state, data->time);

  const bool placed = state.fields[0] != 0.0;
  const Pose pad = pose_at(data->site_xpos + 3 * config_.site, data->site_xmat + 9 * config_.site);
  const double radius = model->site_size[3 * config_.site];
  const double scale = metres_per_newton * model->vis.map.force / default_force_scale;
  const auto next_geom = [scene]() -> mjvGeom* {
    return scene->ngeom < scene->maxgeom ? scene->geoms + scene->ngeom++ : nullptr;
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
      shown = placed ? field.state_before(i) : field.state(i);
    }
    const Eigen::Vector3d from = pad * tip, to = from + scale * (pad.rotation * force);
    const float* colour = colours[static_cast<std::size_t>(shown)];
    const double size[3] = {radius, radius, radius};
    if (mjvGeom* ball = next_geom()) {
      mjv_initGeom(ball, mjGEOM_SPHERE, size, from.data(), nullptr, colour);
      ball->category = mjCAT_DECOR;
    }
    if (shown == ElementState::detached) continue;
    if (mjvGeom* arrow = next_geom()) {
      mjv_initGeom(arrow, mjGEOM_ARROW, nullptr, nullptr, nullptr, colour);
      mjv_connector(arrow, mjGEOM_ARROW, 0.4 * radius, from.data(), to.data());
      arrow->category = mjCAT_DECOR;
    }
  }
}

}  // namespace slipbench
