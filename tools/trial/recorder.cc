#include "tools/trial/recorder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "tools/dataset/record/encoder.h"
#include "tools/trial/recorded_scene.h"

namespace slipbench {
namespace {

constexpr const char* pad_frame_text =
    "pad frame P: x and y in the plane of the pad, +z into the sensor, so that compression is positive; forces act on the sensor, displacements are of its tips; a pad that faces down on a horizontal surface has P parallel to the world. Labels: force and slip_velocity lie in the contact plane, P turned the shortest way until +z is the surface's normal";

// Index of the sensor whose sample times are used for the bodies: the fastest sensor with its own
// pad, the first of equals.
std::size_t fastest_of(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors) {
  const auto rate = [&](std::size_t pad) { return scene.sensors[pad].follows.empty() ? sensors[pad]->rate() : 0.0; };
  std::size_t fastest = 0;
  for (std::size_t pad = 1; pad < sensors.size(); ++pad) {
    if (rate(pad) > rate(fastest)) fastest = pad;
  }
  return fastest;
}

// Number of rows of a channel for `samples` samples of its sensor.
std::size_t rows_of(const Channel& channel, std::size_t samples) { return samples / channel.every; }

// `ahead` [m]: offset of a follower. `scale`: scale of the trial's friction.
void describe_units(const PadLayout& layout, double ahead, const FrictionScene& friction, double scale, LabelRecord& labels) {
  for (const UnitRange& unit : layout.units) {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
    double k_normal = 0.0;
    double k_tangential = 0.0;
    for (std::size_t i = unit.first; i < unit.first + unit.count; ++i) {
      tip += layout.elements[i].tip / static_cast<double>(unit.count);
      k_normal += layout.elements[i].k_normal;
      k_tangential += layout.elements[i].k_tangential;
    }
    labels.unit_positions.insert(labels.unit_positions.end(), {tip.x(), tip.y()});
    labels.unit_heights.push_back(tip.z() - ahead);
    labels.k_normal.push_back(k_normal);
    labels.k_tangential.push_back(k_tangential);
  }
  labels.mu_static.assign(layout.units.size(), scale * friction.static_coefficient);
  labels.mu_kinetic.assign(layout.units.size(), scale * friction.kinetic_coefficient);
}

// Number of values in one row of a column with extents `tail` after the first axis.
std::size_t row_size(const Extents& tail) {
  return std::accumulate(tail.begin(), tail.end(), std::size_t{1}, std::multiplies<>());
}

template <class Column>
std::size_t row_bytes(const Extents& tail, const Column& column) {
  return sizeof(column.front()) * row_size(tail);
}

// Bytes of one event.
double event_bytes() {
  const LabelRecord labels;
  std::size_t size = 0;
  for_each_event_column(
      labels, [&size](const char*, const char*, const Extents& tail, const auto& column) { size += row_bytes(tail, column); });
  return static_cast<double>(size);
}

// Index of the sensor whose samples determine the loop's rows; empty if the scene has no loop.
std::optional<std::size_t> control_pad(const Scene& scene) {
  if (scene.detector) return scene.detector->sensor;
  if (scene.controller) return 0;  // the pad of a grasp
  return std::nullopt;
}

// Calls `visit` for every column of the scene's loop except its time.
template <class Control, class Visit>
void for_each_loop_column(const Scene& scene, Control& control, const Visit& visit) {
  for_each_control_column(control, visit);
  if (scene.grasp) for_each_grip_column(control.grip, visit);
  if (scene.guided()) for_each_arm_column(control.grip, visit);
}

// Writes an Eigen array [C,N] to row `row` of a column [L,N,C].
template <class Derived>
void write_row(std::vector<float>& column, std::size_t row, const Eigen::ArrayBase<Derived>& values) {
  Eigen::Map<Eigen::Array<float, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime>>(
      column.data() + row * static_cast<std::size_t>(values.size()), values.rows(), values.cols()) =
      values.template cast<float>();
}

[[noreturn]] void refuse(const std::string& what, double time) {
  throw FailedRun(fmt::format("{} is not finite at {} s: the simulation has overflowed with the values of the scene", what,
                              format_number(time)));
}

// Finds the earliest row of a record that is not finite.
class FirstBadRow {
 public:
  // Checks a column of `time.size()` rows; `what` names it.
  void look(std::span<const float> column, std::span<const double> time, const std::string& what) {
    unsigned any = 0;  // a branch-free pass first: find_if() tests value by value
    for (const float value : column) any |= std::isfinite(value) ? 0U : 1U;
    if (any == 0) return;
    const auto bad = std::ranges::find_if(column, [](float value) { return !std::isfinite(value); });
    note(static_cast<std::size_t>(bad - column.begin()) / (column.size() / time.size()), time, what);
  }

  // Checks the margins of units, which must be finite only in contact.
  void look_at_margins(const LabelRecord& labels, std::span<const double> time, const std::string& what) {
    const auto is_bad = [&labels](std::size_t i) {
      const unsigned touches = labels.unit_state[i] != static_cast<std::uint8_t>(UnitState::detached) ? 1U : 0U;
      return touches & (std::isfinite(labels.margin[i]) ? 0U : 1U);
    };
    unsigned any = 0;
    for (std::size_t i = 0; i < labels.margin.size(); ++i) any |= is_bad(i);
    if (any == 0) return;
    std::size_t first = 0;
    while (is_bad(first) == 0) ++first;
    note(first / labels.units(), time, what);
  }

  void refuse_if_any() const {
    if (!what_.empty()) refuse(what_, time_);
  }

 private:
  void note(std::size_t row, std::span<const double> time, const std::string& what) {
    if (!what_.empty() && time_ <= time[row]) return;
    what_ = what;
    time_ = time[row];
  }

  std::string what_;  // empty: everything is finite
  double time_ = 0.0;
};

}  // namespace

double record_bytes(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                    const Sampler& sampler) {
  const LabelRecord labels;
  const ControlRecord control;
  const BodyRecord body;
  double bytes = 0.0;
  std::size_t row = 0;
  const auto add = [&row](const char*, const char*, const Extents& tail, const auto& column) { row += row_bytes(tail, column); };
  // Adds the columns of a group: its time, and the columns since the last group.
  const auto close_group = [&](std::size_t pad) {
    row += sizeof(double);
    bytes += static_cast<double>(std::exchange(row, 0)) * static_cast<double>(sampler.samples(pad));
  };
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    for (const Channel& channel : sensors[pad]->channels()) {
      const std::size_t channel_row = channel.size() * sizeof(float) + (channel.has_own_time() ? sizeof(double) : 0);
      bytes += static_cast<double>(channel_row) * static_cast<double>(rows_of(channel, sampler.samples(pad)));
    }
    for_each_label(labels, sensors[pad]->layout().units.size(), add);
    close_group(pad);
  }
  if (const auto pad = control_pad(scene)) {
    for_each_loop_column(scene, control, add);
    close_group(*pad);
  }
  for (std::size_t k = 0; k < simulation.bodies().size(); ++k) for_each_body_column(body, add);
  close_group(fastest_of(scene, sensors));
  return bytes;
}

void check_record_size(const Scene& scene, double bytes, double max_bytes) {
  if (bytes <= max_bytes) return;
  throw SceneValueError(
      "duration",
      fmt::format(
          "{} needs {:.3g} GB or more of memory for the record; allowed: {:.3g} GB, which is {:.3g} GB shared by the jobs; use a shorter trial, slower sensors or fewer --jobs",
          format_quantity(scene.duration, Quantity::time), 1e-9 * bytes, 1e-9 * max_bytes, 1e-9 * max_record_bytes));
}

TrialRecord new_record(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                       std::uint64_t trial) {
  TrialRecord record;
  record.trial = trial;
  record.seed = scene.seed;
  record.material = split_group(scene);
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    SensorRecord& sensor = record.sensors.emplace_back();
    sensor.name = scene.sensors[pad].name;
    describe_units(sensors[pad]->layout(), scene.sensors[pad].ahead, scene.friction, simulation.friction_scale(), sensor.labels);
  }
  if (const auto pad = control_pad(scene)) {
    ControlRecord& control = record.control.emplace();
    control.detector = scene.detector ? scene.detector->type : "";
    control.controller = scene.controller ? scene.controller->name : "";
    control.sensor = scene.sensors[*pad].name;
    control.rate = sensors[*pad]->rate();
  }
  return record;
}

Recorder::Recorder(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                   const HeldBox* box, const Sampler& sampler, double max_bytes, TrialRecord& record)
    : scene_(scene),
      sensors_(sensors),
      simulation_(simulation),
      box_(box),
      max_bytes_(max_bytes),
      bytes_(record_bytes(scene, sensors, simulation, sampler)),
      body_pad_(fastest_of(scene, sensors)),
      rows_(sensors.size(), 0),
      record_(record) {
  check_record_size(scene, bytes_, max_bytes_);
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    SensorRecord& sensor = record_.sensors[pad];
    const std::size_t rows = sampler.samples(pad);
    sensor.type = scene.sensors[pad].type;
    sensor.follows = scene.sensors[pad].follows;
    sensor.rate = sensors[pad]->rate();
    sensor.frame = pad_frame_text;
    sensor.time.resize(rows);
    for (const Channel& channel : sensors[pad]->channels()) {
      const std::size_t channel_rows = rows_of(channel, rows);
      sensor.channels.push_back({channel.name, channel.unit, channel.shape, std::vector<float>(channel_rows * channel.size())});
      if (channel.has_own_time()) sensor.channels.back().time.emplace(channel_rows);
      sensor.channel_names.insert(sensor.channel_names.end(), channel.channel_names.begin(), channel.channel_names.end());
    }
    for_each_label(sensor.labels, sensor.labels.units(),
                   [rows](const char*, const char*, const Extents& tail, auto& column) { column.resize(rows * row_size(tail)); });
  }
  if (const auto pad = control_pad(scene)) {
    const std::size_t rows = sampler.samples(*pad);
    record_.control->time.reserve(rows);
    for_each_loop_column(scene, *record_.control, [rows](const char*, const char*, const Extents& tail, auto& column) {
      column.reserve(rows * row_size(tail));
    });
  }
  const std::size_t rows = sampler.samples(body_pad_);
  record_.body_time.resize(rows);
  for (const NamedBody& body : simulation.bodies()) {
    record_.bodies.push_back({body.name, std::vector<float>(rows * 7), std::vector<float>(rows * 6), body.size});
  }
}

void Recorder::record(std::span<const Tick> ticks, const ControlLoop& loop) {
  for (const Tick& tick : ticks) {
    const FramePart part = tick.sample == nullptr ? FramePart::states : FramePart::all;
    const ContactFrame& truth = simulation_.contact_part(tick.pad, part);
    if (!truth.events.empty()) write_events(tick.pad, truth.events);
    if (tick.sample == nullptr) continue;
    const std::size_t row = rows_[tick.pad]++;
    write_sample(tick.pad, row, *tick.sample);
    write_labels(tick.pad, row, truth);
    if (tick.pad == body_pad_) write_bodies(row, truth.time);
    if (record_.control && tick.pad == loop.pad()) write_control(truth.time, loop);
  }
}

void Recorder::write_events(std::size_t pad, const std::vector<ContactEvent>& events) {
  static const double one_event = event_bytes();
  bytes_ += one_event * static_cast<double>(events.size());
  check_record_size(scene_, bytes_, max_bytes_);
  LabelRecord& labels = record_.sensors[pad].labels;
  for (const ContactEvent& event : events) {
    labels.event_time.push_back(event.time);
    labels.event_unit.push_back(event.unit);
    labels.event_kind.push_back(static_cast<std::uint8_t>(event.kind));
  }
}

void Recorder::write_sample(std::size_t pad, std::size_t row, const SensorFrame& frame) {
  SensorRecord& sensor = record_.sensors[pad];
  sensor.time[row] = frame.time;
  const float* values = frame.values.data();
  for (std::size_t c = 0; c < sensor.channels.size(); ++c) {
    const Channel& about = sensors_[pad]->channels()[c];
    if ((row + 1) % about.every == 0) {
      const std::size_t channel_row = row / about.every;
      std::copy_n(values, about.size(), sensor.channels[c].values.data() + channel_row * about.size());
      if (about.has_own_time()) (*sensor.channels[c].time)[channel_row] = frame.time - about.age;
    }
    values += about.size();
  }
}

void Recorder::write_labels(std::size_t pad, std::size_t row, const ContactFrame& truth) {
  LabelRecord& labels = record_.sensors[pad].labels;
  const std::size_t units = labels.units();
  for (std::size_t unit = 0; unit < units; ++unit) {
    labels.unit_state[row * units + unit] = static_cast<std::uint8_t>(truth.unit_state[unit]);
  }
  write_row(labels.slip_velocity, row, truth.slip_velocity);
  write_row(labels.slip_distance, row, truth.slip_distance);
  write_row(labels.margin, row, truth.margin);
  write_row(labels.force, row, truth.contact_force);
  labels.state[row] = static_cast<std::uint8_t>(truth.state);
  labels.state_micro[row] = static_cast<std::uint8_t>(truth.state_micro);
  labels.state_paper[row] = static_cast<std::uint8_t>(sensors_[pad]->paper_label(truth, simulation_.rotating()));
  labels.stuck_fraction[row] = static_cast<float>(truth.stuck_fraction);
  labels.slip_direction[row] = static_cast<float>(truth.slip_direction);
  write_row(labels.slip_centre, row, truth.slip_centre);
  labels.slip_angle[row] = static_cast<float>(truth.slip_angle);
}

void Recorder::write_bodies(std::size_t row, double time) {
  record_.body_time[row] = time;
  for (std::size_t b = 0; b < record_.bodies.size(); ++b) {
    const BodyState& state = simulation_.bodies()[b].state;
    float* pose = record_.bodies[b].pose.data() + row * 7;
    Eigen::Vector4f turn = Eigen::Quaterniond(state.pose.rotation).coeffs().cast<float>();  // x y z w
    if (row > 0 && turn.dot(Eigen::Vector4f(pose[-3], pose[-2], pose[-1], pose[-4])) < 0.0F) turn = -turn;
    Eigen::Map<Eigen::Vector3f>{pose} = state.pose.position.cast<float>();
    Eigen::Map<Eigen::Vector4f>{pose + 3} = Eigen::Vector4f(turn.w(), turn.x(), turn.y(), turn.z());
    Eigen::Map<Eigen::Matrix<float, 6, 1>>{record_.bodies[b].velocity.data() + row * 6} << state.velocity.cast<float>(),
        state.angular_velocity.cast<float>();
  }
}

void Recorder::write_control(double time, const ControlLoop& loop) {
  ControlRecord& control = *record_.control;
  control.time.push_back(time);
  control.detector_class.push_back(static_cast<std::uint8_t>(loop.seen()));
  if (box_ == nullptr) return;
  GripRecord& grip = control.grip;
  const GripCommand& written = loop.written();
  for (const int value : {written.position, written.speed, written.force}) {
    grip.command.push_back(static_cast<std::uint8_t>(value));
  }
  grip.measured_position.push_back(static_cast<std::uint8_t>(loop.measured_position()));
  grip.grip_force.push_back(static_cast<float>(box_->truth().grip_force));
  if (!scene_.guided()) return;
  for (const double speed : {loop.arm_command().sideways, loop.arm_command().up}) grip.arm.push_back(static_cast<float>(speed));
}

void check_finite(const TrialRecord& record) {
  FirstBadRow bad;
  for (const SensorRecord& sensor : record.sensors) {
    const LabelRecord& labels = sensor.labels;
    const std::string path = "sensors." + sensor.name + ": ";
    for (const SensorColumn& channel : sensor.channels) bad.look(channel.values, sensor.times_of(channel), path + channel.name);
    bad.look(labels.force, sensor.time, path + "contact force");
    bad.look(labels.slip_velocity, sensor.time, path + "slip velocity");
    bad.look(labels.slip_distance, sensor.time, path + "slip distance");
    bad.look_at_margins(labels, sensor.time, path + "margin");
  }
  for (const BodyRecord& body : record.bodies) {
    bad.look(body.pose, record.body_time, "pose of the body " + body.name);
    bad.look(body.velocity, record.body_time, "velocity of the body " + body.name);
  }
  bad.refuse_if_any();
}

void check_finite(const std::string& sensor, const ContactFrame& truth) {
  const auto check = [&](bool finite, const char* what) {
    if (!finite) refuse("sensors." + sensor + ": " + what, truth.time);
  };
  // In the dataset's single precision.
  check(truth.force.cast<float>().allFinite(), "force");
  check(truth.displacement.cast<float>().allFinite(), "displacement");
  check(truth.contact_force.cast<float>().allFinite(), "contact force");
  check(truth.slip_velocity.cast<float>().allFinite(), "slip velocity");
  check(truth.slip_distance.cast<float>().allFinite(), "slip distance");
  for (std::size_t unit = 0; unit < truth.unit_state.size(); ++unit) {
    const bool touches = truth.unit_state[unit] != UnitState::detached;
    check(!touches || std::isfinite(static_cast<float>(truth.margin(static_cast<Eigen::Index>(unit)))), "margin");
  }
}

void check_finite(const std::string& sensor, const std::vector<Channel>& channels, const SensorFrame& frame) {
  std::span<const float> values = frame.values;
  for (const Channel& channel : channels) {
    const bool finite = std::ranges::all_of(values.first(channel.size()), [](float value) { return std::isfinite(value); });
    if (!finite) refuse("sensors." + sensor + ": " + channel.name, frame.time);
    values = values.subspan(channel.size());
  }
}

void check_finite(double time, const std::vector<NamedBody>& bodies) {
  for (const NamedBody& body : bodies) {
    const BodyState& state = body.state;
    if (!state.pose.position.cast<float>().allFinite() || !state.pose.rotation.cast<float>().allFinite()) {
      refuse("pose of the body " + body.name, time);
    }
    if (!state.velocity.cast<float>().allFinite() || !state.angular_velocity.cast<float>().allFinite()) {
      refuse("velocity of the body " + body.name, time);
    }
  }
}

}  // namespace slipbench
