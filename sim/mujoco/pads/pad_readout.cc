#include "sim/mujoco/pads/pad_readout.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

// A sample is due when its time is reached up to the rounding of a sum of steps.
constexpr double rounding = 1e-6;

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

// Formats a time with three digits.
std::string rounded_time(double time) { return format_quantity(rounded_to_digits(time, 3), Quantity::time); }

}  // namespace

PadReadout::PadReadout(ModelView model, int instance, const PadConfig& config, const PadCatalogue& catalogue)
    : sensor_(config.make_sensor(catalogue)),
      sensor_memory_(sensor_->memory()),
      feels_every_tick_(sensor_->feels_every_tick()),
      sample_time_(sensor_->rate() > 0.0 ? 1.0 / (sensor_->rate() * static_cast<double>(sensor_->scans())) : 0.0),
      labels_(sensor_->layout()),
      writes_truth_(config.truth),
      unloaded_(config.unloaded) {
  for (int id = 0; id < static_cast<int>(model.nsensor()); ++id) {
    if (model.sensor_plugin()[id] == instance) outputs_.push_back(model.sensor_adr()[id]);
  }
  if (has_outputs()) watch();
  for (const std::span<double> memory : sensor_memory_) first_memory_.insert(first_memory_.end(), memory.begin(), memory.end());
}

void PadReadout::stop_sampling() {
  if (reader_ == Reader::sensor) reader_ = Reader::labels;
}

void PadReadout::check_step(double step, const std::string& name) const {
  // One reading per step: at a longer step a multiplexed sensor would miss electrodes, not only
  // samples.
  if (sensor_->scans() <= 1 || step <= sample_time_ * (1.0 + rounding)) return;
  throw InputError(fmt::format("plugin '{}': the time step {} must not be longer than the sampling time of the sensor, {}", name,
                               rounded_time(step), rounded_time(sample_time_)));
}

bool PadReadout::sample_is_due(double time, double next) const {
  return sample_time_ == 0.0 || time >= sample_time_ * (next - rounding);
}

double PadReadout::sample_after(double time) const { return std::floor(time / sample_time_ + rounding) + 1.0; }

void PadReadout::measure(std::span<Field> fields, const PluginState& state, double time, double dt, double step) {
  labels_.set_slip_angle(state.slip_angle());
  // without elapsed time nothing has slipped
  labels_.judge(fields, time, dt > 0.0 ? dt : step);
  sample_.reset();
  next_sample_ = state.next_sample();
  if (reader_ != Reader::sensor) return;
  labels_.fill(fields, FramePart::all);
  const bool due = sample_is_due(time, next_sample_);
  if (due || feels_every_tick_) {
    const double* remembered = state.placed() ? state.memory().data() : first_memory_.data();
    for (const std::span<double> memory : sensor_memory_) {
      std::copy_n(remembered, memory.size(), memory.begin());
      remembered += memory.size();
    }
  }
  if (due) {
    sample_ = sensor_->measure(labels_.frame()).values;
    if (sample_time_ > 0.0) next_sample_ = sample_after(time);
  } else if (feels_every_tick_) {
    sensor_->feel(labels_.frame());
  }
}

void PadReadout::commit(std::span<const Field> fields, const PluginState& state, double dt) {
  labels_.settle(fields, dt);
  state.next_sample() = next_sample_;
  state.slip_angle() = labels_.frame().slip_angle;
  if (sample_ || (feels_every_tick_ && reader_ == Reader::sensor)) {
    double* remembered = state.memory().data();
    for (const std::span<double> memory : sensor_memory_) remembered = std::copy(memory.begin(), memory.end(), remembered);
  }
  if (sample_) write_values(*sample_, state.held().data());
  if (writes_truth_) write_truth(labels_.frame(), unloaded_, state.truth().data());
}

void PadReadout::commit_idle(const PluginState& state, double time) const {
  if (watched() && sample_time_ > 0.0 && sample_is_due(time, state.next_sample())) state.next_sample() = sample_after(time);
}

void PadReadout::write(DataView data, const PluginState& state) const {
  const std::span<const double> held = state.held();
  for (const int address : outputs_) {
    double* const out = data.sensordata() + address;
    sample_ ? write_values(*sample_, out) : std::copy(held.begin(), held.end(), out);
    if (writes_truth_) write_truth(labels_.frame(), unloaded_, out + held.size());
  }
}

void PadReadout::write_committed(DataView data, const PluginState& state) const {
  const std::span<const double> held = state.held(), truth_values = state.truth();
  for (const int address : outputs_) {
    double* const out = std::copy(held.begin(), held.end(), data.sensordata() + address);
    std::copy(truth_values.begin(), truth_values.end(), out);
  }
}

}  // namespace slipbench
