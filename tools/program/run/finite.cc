#include "tools/program/run/finite.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <fmt/format.h>
#include <Eigen/Core>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

[[noreturn]] void refuse(const std::string& what, double time) {
  throw InputError(fmt::format("{} is not finite at {} s: the scene's values are beyond what the bench can compute", what,
                               format_number(time)));
}

// The earliest row of a record that is not finite.
class FirstBadRow {
 public:
  // A column of `time.size()` rows; `what` names it.
  void look(std::span<const float> column, std::span<const double> time, const std::string& what) {
    if (Eigen::Map<const Eigen::ArrayXf>(column.data(), static_cast<Eigen::Index>(column.size())).allFinite()) return;
    const auto bad = std::ranges::find_if(column, [](float value) { return !std::isfinite(value); });
    note(static_cast<std::size_t>(bad - column.begin()) / (column.size() / time.size()), time, what);
  }

  // The margins of units, which count only while they touch.
  void look_at_margins(const LabelRecord& labels, std::span<const double> time, const std::string& what) {
    for (std::size_t i = 0; i < labels.margin.size(); ++i) {
      const bool touches = labels.unit_state[i] != static_cast<std::uint8_t>(UnitState::detached);
      if (touches && !std::isfinite(labels.margin[i])) return note(i / labels.units(), time, what);
    }
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

  std::string what_;  // empty: all is finite
  double time_ = 0.0;
};

}  // namespace

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
  // As the dataset would hold them: in single precision.
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
