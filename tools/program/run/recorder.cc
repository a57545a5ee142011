#include "tools/program/run/recorder.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "tools/base/dataset/layout.h"
#include "tools/program/run/finite.h"

namespace slipbench {
namespace {

constexpr double never = std::numeric_limits<double>::quiet_NaN();

constexpr const char* pad_frame_text =
    "pad frame P: x and y in the plane of the pad, +z into the sensor, so that compression is positive; forces act on the sensor, displacements are of its tips; a pad that faces down on a horizontal surface has P parallel to the world. Labels: force and slip_velocity lie in the contact plane, P turned the shortest way until +z is the surface's normal";

// The earlier of two times of which either may be NaN.
void keep_earliest(double& time, double candidate) {
  if (!(time <= candidate)) time = candidate;
}

Sampling sampling_of(const Sensor& sensor, const Simulation& simulation, std::size_t pad) {
  return {simulation.stride(pad), sensor.scans()};
}

// With whose samples the bodies are recorded: those of the fastest sensor that has a pad of its own, of equals the first.
std::size_t fastest_of(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors) {
  const auto rate = [&](std::size_t pad) { return scene.sensors[pad].follows.empty() ? sensors[pad]->rate() : 0.0; };
  std::size_t fastest = 0;
  for (std::size_t pad = 1; pad < sensors.size(); ++pad) {
    if (rate(pad) > rate(fastest)) fastest = pad;
  }
  return fastest;
}

// Rows that a channel has of `samples` samples of its sensor.
std::size_t rows_of(const Channel& channel, std::size_t samples) { return samples / channel.every; }

// `scale`: of the trial's friction.
void describe_units(const PadLayout& layout, const FrictionScene& friction, double scale, LabelRecord& labels) {
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
    labels.unit_heights.push_back(tip.z());
    labels.k_normal.push_back(k_normal);
    labels.k_tangential.push_back(k_tangential);
  }
  labels.mu_static.assign(layout.units.size(), scale * friction.static_coefficient);
  labels.mu_kinetic.assign(layout.units.size(), scale * friction.kinetic_coefficient);
  labels.onset_time.assign(layout.units.size(), never);
  labels.micro_onset_time.assign(layout.units.size(), never);
}

// Bytes of one row of a column whose extents after the first axis are `tail`.
template <class Column>
std::size_t row_bytes(const Extents& tail, const Column& column) {
  std::size_t size = sizeof(column.front());
  for (const std::size_t extent : tail) size *= extent;
  return size;
}

// Bytes of one event.
double event_bytes() {
  const LabelRecord labels;
  std::size_t size = 0;
  for_each_event_column(
      labels, [&size](const char*, const char*, const Extents& tail, const auto& column) { size += row_bytes(tail, column); });
  return static_cast<double>(size);
}

// Whether slip begins with the event, by the rule strict: on a pad of a single unit when a part of it slips (unit_rules.h).
bool begins_slip(const ContactEvent& event, const LabelRecord& labels) {
  return event.kind == EventKind::slip || (event.kind == EventKind::micro && labels.units() == 1);
}

// Whose samples the loop's rows go with; empty: the scene has no loop.
std::optional<std::size_t> control_pad(const Scene& scene) {
  if (scene.detector) return scene.detector->sensor;
  if (scene.controller) return 0;  // the pad of a grasp
  return std::nullopt;
}

// Writes an Eigen array of [C,N] as row `row` of a column [L,N,C].
template <class Derived>
void write_row(std::vector<float>& column, std::size_t row, const Eigen::ArrayBase<Derived>& values) {
  Eigen::Map<Eigen::Array<float, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime>>(
      column.data() + row * static_cast<std::size_t>(values.size()), values.rows(), values.cols()) =
      values.template cast<float>();
}

// A sensor that reads between its units must ride on a pad that tells of each element.
void refuse_without_elements(const std::string& sensor, const PadLayout& layout, const ContactFrame& truth) {
  const auto elements = static_cast<Eigen::Index>(layout.elements.size());
  if (!layout.element_truth || (truth.element_depth.size() == elements && truth.element_shear.rows() == elements)) return;
  throw std::logic_error(fmt::format("sensor '{}' reads {} elements of its pad, and the bench's frames tell of {}", sensor,
                                     elements, truth.element_depth.size()));
}

}  // namespace

double record_bytes(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation) {
  double bytes = 0.0;
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const std::size_t rows = sampling_of(*sensors[pad], simulation, pad).samples(simulation.ticks(pad));
    for (const Channel& channel : sensors[pad]->channels()) {
      const std::size_t row = channel.size() * sizeof(float) + (channel.has_own_time() ? sizeof(double) : 0);
      bytes += static_cast<double>(row) * static_cast<double>(rows_of(channel, rows));
    }
    std::size_t row = sizeof(double);  // the time
    const LabelRecord labels;
    for_each_label(labels, sensors[pad]->layout().units.size(),
                   [&row](const char*, const char*, const Extents& tail, const auto& column) { row += row_bytes(tail, column); });
    bytes += static_cast<double>(row) * static_cast<double>(rows);
  }
  if (const auto pad = control_pad(scene)) {
    std::size_t row = sizeof(double);
    const ControlRecord control;
    const auto add = [&row](const char*, const char*, const Extents& tail, const auto& column) {
      row += row_bytes(tail, column);
    };
    for_each_control_column(control, add);
    if (scene.grasp) for_each_grip_column(control.grip, add);
    if (scene.guided()) for_each_arm_column(control.grip, add);
    bytes += static_cast<double>(row) *
             static_cast<double>(sampling_of(*sensors[*pad], simulation, *pad).samples(simulation.ticks(*pad)));
  }
  std::size_t body_row = sizeof(double);
  for (const NamedBody& body : simulation.bodies()) {
    const BodyRecord record{body.name, {}, {}};
    for_each_body_column(record, [&body_row](const char*, const char*, const Extents& tail, const auto& column) {
      body_row += row_bytes(tail, column);
    });
  }
  const std::size_t fastest = fastest_of(scene, sensors);
  const std::size_t rows = sampling_of(*sensors[fastest], simulation, fastest).samples(simulation.ticks(fastest));
  return bytes + static_cast<double>(body_row) * static_cast<double>(rows);
}

void check_record_size(const Scene& scene, double bytes, double max_bytes) {
  if (bytes <= max_bytes) return;
  throw SceneValueError(
      "duration",
      fmt::format(
          "{} makes a record of {:.3g} GB or more; allowed: at most {:.3g} GB, which is {:.3g} GB shared by the jobs, so a shorter trial, slower sensors or fewer --jobs",
          format_quantity(scene.duration, Quantity::time), 1e-9 * bytes, 1e-9 * max_bytes, 1e-9 * max_record_bytes));
}

TrialRecorder::TrialRecorder(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                             std::uint64_t trial, Recording recording, double max_bytes)
    : scene_(scene),
      sensors_(sensors),
      simulation_(simulation),
      recording_(recording),
      max_bytes_(max_bytes),
      all_slipped_(sensors.size(), 0),
      rows_(sensors.size(), 0),
      last_(sensors.size()) {
  record_.trial = trial;
  record_.seed = scene.seed;
  record_.material = scene.material;
  record_.sensors.resize(sensors.size());
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    record_.sensors[pad].name = scene.sensors[pad].name;
    refuse_without_elements(scene.sensors[pad].name, sensors[pad]->layout(), simulation.contact(pad));
    describe_units(sensors[pad]->layout(), scene.friction, simulation.friction_scale(), record_.sensors[pad].labels);
    units_.emplace_back(sensors[pad]->layout().units.size());
    sampling_.push_back(sampling_of(*sensors[pad], simulation, pad));
    if (sampling_[pad].samples(simulation.ticks(pad)) == 0) {
      throw SceneValueError(
          "duration",
          fmt::format("ends before the first sample of sensor '{}' is complete; allowed: {} or longer", scene.sensors[pad].name,
                      format_quantity(static_cast<double>(sampling_[pad].ticks()) * simulation.time_step(pad), Quantity::time)));
    }
  }
  if (const auto pad = control_pad(scene)) {
    record_.control.emplace();
    record_.control->detector = scene.detector ? scene.detector->type : "";
    record_.control->controller = scene.controller ? scene.controller->name : "";
    record_.control->sensor = scene.sensors[*pad].name;
    record_.control->rate = sensors[*pad]->rate();
  }
  body_pad_ = fastest_of(scene, sensors);
  if (recording == Recording::full) allocate();
}

void TrialRecorder::allocate() {
  bytes_ = record_bytes(scene_, sensors_, simulation_);
  check_record_size(scene_, bytes_, max_bytes_);
  for (std::size_t pad = 0; pad < sensors_.size(); ++pad) {
    SensorRecord& sensor = record_.sensors[pad];
    const std::size_t rows = sampling_[pad].samples(simulation_.ticks(pad));
    sensor.type = scene_.sensors[pad].type;
    sensor.follows = scene_.sensors[pad].follows;
    sensor.rate = sensors_[pad]->rate();
    sensor.frame = pad_frame_text;
    sensor.time.resize(rows);
    for (const Channel& channel : sensors_[pad]->channels()) {
      const std::size_t channel_rows = rows_of(channel, rows);
      sensor.channels.push_back({channel.name, channel.unit, channel.shape, std::vector<float>(channel_rows * channel.size())});
      if (channel.has_own_time()) sensor.channels.back().time.emplace(channel_rows);
      sensor.channel_names.insert(sensor.channel_names.end(), channel.channel_names.begin(), channel.channel_names.end());
    }
    for_each_label(sensor.labels, sensor.labels.units(), [rows](const char*, const char*, const Extents& tail, auto& column) {
      std::size_t size = rows;
      for (const std::size_t extent : tail) size *= extent;
      column.resize(size);
    });
  }
  if (const auto pad = control_pad(scene_)) {
    const std::size_t rows = sampling_[*pad].samples(simulation_.ticks(*pad));
    record_.control->time.reserve(rows);
    record_.control->detector_class.reserve(rows);
    if (scene_.grasp) {
      GripRecord& grip = record_.control->grip;
      grip.command.reserve(3 * rows);
      grip.measured_position.reserve(rows);
      grip.grip_force.reserve(rows);
      if (scene_.guided()) grip.arm.reserve(2 * rows);
    }
  }
  record_.body_time.resize(sampling_[body_pad_].samples(simulation_.ticks(body_pad_)));
}

void TrialRecorder::note_events(std::size_t pad, const ContactFrame& truth) {
  LabelRecord& labels = record_.sensors[pad].labels;
  TrialOutcome nobody;
  TrialOutcome& outcome = follows(pad) ? nobody : record_.outcome;
  if (recording_ == Recording::full) {
    static const double one_event = event_bytes();
    bytes_ += one_event * static_cast<double>(truth.events.size());
    check_record_size(scene_, bytes_, max_bytes_);
  }
  for (const ContactEvent& event : truth.events) {
    if (event.kind == EventKind::touch) {
      keep_earliest(units_[pad][event.unit].touch_time, event.time);
      keep_earliest(outcome.touch_time, event.time);
    }
    if (event.kind == EventKind::slip) keep_earliest(labels.onset_time[event.unit], event.time);
    if (begins_slip(event, labels)) keep_earliest(outcome.first_slip_time, event.time);
    if (event.kind == EventKind::slip || event.kind == EventKind::micro) {
      keep_earliest(labels.micro_onset_time[event.unit], event.time);
      keep_earliest(outcome.first_micro_slip_time, event.time);
    }
    if (recording_ == Recording::full) {
      labels.event_time.push_back(event.time);
      labels.event_unit.push_back(event.unit);
      labels.event_kind.push_back(static_cast<std::uint8_t>(event.kind));
    }
  }
}

// The event that left no touching unit sticking is the last one of the step.
void TrialRecorder::note_gross_slip(std::size_t pad, const ContactFrame& truth) {
  all_slipped_[pad] = 1;
  if (follows(pad)) return;
  keep_earliest(record_.outcome.gross_slip_time, truth.events.empty() ? truth.time : truth.events.back().time);
}

void TrialRecorder::write_sample(std::size_t pad, const ContactFrame& truth, const SensorFrame& frame) {
  SensorRecord& sensor = record_.sensors[pad];
  LabelRecord& labels = sensor.labels;
  const std::size_t row = rows_[pad]++;
  const std::size_t units = labels.units();

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

void TrialRecorder::loop(std::size_t tick, const ContactFrame& truth, PadState seen) {
  TrialOutcome& outcome = record_.outcome;
  const LabelRecord& labels = record_.sensors[*control_pad(scene_)].labels;
  for (const ContactEvent& event : truth.events) {
    if (begins_slip(event, labels) && event.time >= lift_start_) keep_earliest(slip_began_, event.time);
  }
  const bool judged = truth.time >= lift_start_ && !(outcome.grasp && outcome.grasp->dropped);
  if (judged && (seen == PadState::incipient || seen == PadState::gross)) {
    double& first = std::isnan(slip_began_) ? outcome.false_alarm_time : outcome.detection_time;
    if (std::isnan(first)) first = truth.time;
  }
  if (!sampling_[*control_pad(scene_)].completes_at(tick)) return;
  ControlRecord& control = *record_.control;
  if (scene_.detector) ++control.confusion[static_cast<std::size_t>(truth.state)][static_cast<std::size_t>(seen)];
  if (recording_ == Recording::outcome) return;
  control.time.push_back(truth.time);
  control.detector_class.push_back(static_cast<std::uint8_t>(seen));
}

void TrialRecorder::grip(const ContactFrame& truth, const HeldBox& box, const GripLoop& loop) {
  const GraspTruth& now = box.truth();
  if (!record_.outcome.grasp) {
    record_.outcome.grasp.emplace();
    if (std::isfinite(box.ideal_force())) record_.outcome.grasp->ideal_grip_force = box.ideal_force();
  }
  GraspOutcome& grasp = *record_.outcome.grasp;
  if (now.dropped && !grasp.dropped) {
    grasp.dropped = true;
    grasp.drop_time = now.time;
  }
  grasp.slip_translation = grasp.dropped ? never : now.slip.norm();
  grasp.slip_rotation = grasp.dropped ? never : now.rotation;
  grasp.max_grip_force = std::max(grasp.max_grip_force, now.grip_force);
  grasp.final_grip_force = now.grip_force;
  if (scene_.guided()) note_turn(now, grasp);
  lift_start_ = box.lift_start();
  const bool slips = truth.state == PadState::incipient || truth.state == PadState::gross;
  if (now.time >= lift_start_ && slips) keep_earliest(true_slip_, now.time);
  if (std::isnan(grasp.reaction_time) && !grasp.dropped && loop.tightening().read >= true_slip_) {
    grasp.reaction_time = loop.tightening().acts - true_slip_;
  }
}

void TrialRecorder::grip_row(std::size_t tick, const HeldBox& box, const GripLoop& loop) {
  if (recording_ == Recording::outcome || !sampling_[*control_pad(scene_)].completes_at(tick)) return;
  GripRecord& rows = record_.control->grip;
  const GripCommand& written = loop.written();
  for (const int value : {written.position, written.speed, written.force}) {
    rows.command.push_back(static_cast<std::uint8_t>(value));
  }
  rows.measured_position.push_back(static_cast<std::uint8_t>(loop.measured_position()));
  rows.grip_force.push_back(static_cast<float>(box.truth().grip_force));
  if (!scene_.guided()) return;
  for (const double speed : {loop.told_arm().sideways, loop.told_arm().up}) rows.arm.push_back(static_cast<float>(speed));
}

void TrialRecorder::note_turn(const GraspTruth& now, GraspOutcome& grasp) {
  constexpr double upright = 5.0 * std::numbers::pi / 180.0;
  const bool alone = now.pad_force[0] == 0.0 && now.pad_force[1] == 0.0 && now.table_force > 0.0;
  const double least = grasp.turn ? std::min(grasp.turn->least_tilt, now.tilt) : now.tilt;
  grasp.turn = {.tilt = now.tilt, .least_tilt = least, .standing = alone && now.tilt < upright};
}

void TrialRecorder::write_bodies(double time, const std::vector<NamedBody>& bodies) {
  const std::size_t rows = record_.body_time.size();
  if (record_.bodies.empty()) {
    for (const NamedBody& body : bodies) {
      record_.bodies.push_back({body.name, std::vector<float>(rows * 7), std::vector<float>(rows * 6), body.size});
    }
  }
  const std::size_t row = body_row_++;
  record_.body_time[row] = time;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& state = bodies[b].state;
    float* pose = record_.bodies[b].pose.data() + row * 7;
    Eigen::Vector4f turn = Eigen::Quaterniond(state.pose.rotation).coeffs().cast<float>();  // x y z w
    if (row > 0 && turn.dot(Eigen::Vector4f(pose[-3], pose[-2], pose[-1], pose[-4])) < 0.0F) turn = -turn;
    Eigen::Map<Eigen::Vector3f>{pose} = state.pose.position.cast<float>();
    Eigen::Map<Eigen::Vector4f>{pose + 3} = Eigen::Vector4f(turn.w(), turn.x(), turn.y(), turn.z());
    Eigen::Map<Eigen::Matrix<float, 6, 1>>{record_.bodies[b].velocity.data() + row * 6} << state.velocity.cast<float>(),
        state.angular_velocity.cast<float>();
  }
}

TrialResult TrialRecorder::finish() {
  if (recording_ == Recording::full) check_finite(record_);
  record_.outcome.detection_delay = record_.outcome.detection_time - slip_began_;
  for (std::size_t pad = 0; pad < sensors_.size(); ++pad) {
    const ContactFrame& last = simulation_.contact(pad);
    check_finite(record_.sensors[pad].name, last);
    check_finite(record_.sensors[pad].name, sensors_[pad]->channels(), last_[pad]);
    if (!follows(pad)) {
      record_.outcome.max_slip_distance = std::max(record_.outcome.max_slip_distance, last.slip_distance.maxCoeff());
    }
    if (const std::uint64_t samples = sensors_[pad]->saturated(); samples > 0) {
      record_.outcome.saturated.emplace(record_.sensors[pad].name, samples);
    }
    const LabelRecord& labels = record_.sensors[pad].labels;
    for (std::size_t u = 0; u < labels.units(); ++u) {
      UnitOutcome& unit = units_[pad][u];
      const auto column = static_cast<Eigen::Index>(u);
      unit.micro_onset_time = labels.micro_onset_time[u];
      unit.onset_time = labels.onset_time[u];
      unit.slip_distance = static_cast<float>(last.slip_distance(column));
      unit.load = static_cast<float>(last.contact_force(2, column));
      unit.margin = static_cast<float>(last.margin(column));
    }
  }
  check_finite(simulation_.contact(0).time, simulation_.bodies());
  return {std::move(record_), std::move(units_)};
}

}  // namespace slipbench
