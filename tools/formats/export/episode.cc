#include "tools/formats/export/formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "tools/dataset/record/encoder.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

constexpr double counts = 127.5;  // half the range of a register
constexpr std::array<const char*, 6> velocity_names{"vx", "vy", "vz", "wx", "wy", "wz"};
constexpr std::size_t linear = 3;  // number of translational components, which come first

// A signal that holds its value from one of its times to the next.
struct Signal {
  std::span<const double> time;
  std::span<const float> values;  // [time, width]
  std::size_t width = 1;
};

// Instants of an episode.
struct Grid {
  double start = 0.0, period = 0.0;  // s
  std::size_t points = 0;

  [[nodiscard]] double at(std::size_t point) const { return start + period * static_cast<double>(point); }
};

template <class T>
std::vector<float> floats(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

std::vector<float> resampled(const Signal& signal, const Grid& grid, std::size_t points) {
  std::vector<float> values;
  values.reserve(points * signal.width);
  for (std::size_t point = 0; point < points; ++point) {
    const auto row = signal.values.subspan(*latest_row(signal.time, grid.at(point)) * signal.width, signal.width);
    values.insert(values.end(), row.begin(), row.end());
  }
  return values;
}

// From the first instant at which every signal has a value to the last sample of the sensor that
// ends first.
Grid grid_of(const TrialRecord& record, const std::vector<std::string>& sensors, double rate) {
  Grid grid{record.body_time.front(), 1.0 / rate, 0};
  double end = record.body_time.back();
  double fastest = 0.0;
  for (const SensorRecord& sensor : record.sensors) {
    if (std::find(sensors.begin(), sensors.end(), sensor.name) == sensors.end()) continue;
    fastest = std::max(fastest, sensor.rate);
    end = std::min(end, sensor.time.back());
    for (const SensorColumn& channel : sensor.channels) {
      const std::vector<double>& time = sensor.times_of(channel);
      grid.start =
          std::max({grid.start, sensor.time.front(), time.empty() ? std::numeric_limits<double>::infinity() : time.front()});
    }
  }
  if (record.control && !record.control->time.empty()) {
    grid.start = std::max(grid.start, record.control->time.front());
    end = std::min(end, record.control->time.back());
  }
  if (rate > fastest) {
    reject("a rate of {} Hz would repeat samples; allowed: up to {} Hz, the rate of the fastest sensor", rate, fastest);
  }
  if (end + time_rounding >= grid.start) {
    grid.points = static_cast<std::size_t>(std::floor((end - grid.start + time_rounding) * rate)) + 1;
  }
  if (grid.points < 2) reject("trial {}: is too short for two samples at {} Hz", record.trial, rate);
  return grid;
}

Episode::Column actions_of(const TrialRecord& record, const Grid& grid, std::size_t steps, const ActionSpace& space) {
  Episode::Column actions{"actions", space.names.size(), {}};
  if (space.bodies.empty()) {
    if (!record.control || record.control->grip.command.empty()) {
      reject("trial {}: is a grasp without a control loop, so it has no actions", record.trial);
    }
    actions.values = resampled({record.control->time, floats(record.control->grip.command), actions.width}, grid, steps);
  } else {
    actions.values.resize(steps * actions.width);
    for (std::size_t carrier = 0; carrier < space.bodies.size(); ++carrier) {
      const BodyRecord& body = record.body(space.bodies[carrier]);
      const std::vector<float> velocity = resampled({record.body_time, body.velocity, velocity_names.size()}, grid, steps);
      for (std::size_t i = 0; i < velocity.size(); ++i) {
        actions.values[i / velocity_names.size() * actions.width + carrier * velocity_names.size() + i % velocity_names.size()] =
            velocity[i];
      }
    }
  }
  for (std::size_t i = 0; i < actions.values.size(); ++i) {
    const std::size_t column = i % actions.width;
    actions.values[i] = static_cast<float>((static_cast<double>(actions.values[i]) - space.offset[column]) / space.scale[column]);
  }
  return actions;
}

Episode::Column bodies_of(const TrialRecord& record, const Grid& grid, std::size_t steps) {
  constexpr std::size_t pose = 7;
  constexpr std::size_t body = pose + velocity_names.size();
  Episode::Column column{"states", body * record.bodies.size(), std::vector<float>(steps * body * record.bodies.size())};
  for (std::size_t k = 0; k < record.bodies.size(); ++k) {
    const std::vector<float> poses = resampled({record.body_time, record.bodies[k].pose, pose}, grid, steps);
    const std::vector<float> velocities =
        resampled({record.body_time, record.bodies[k].velocity, velocity_names.size()}, grid, steps);
    for (std::size_t row = 0; row < steps; ++row) {
      float* const first = column.values.data() + row * column.width + k * body;
      std::copy_n(poses.data() + row * pose, pose, first);
      std::copy_n(velocities.data() + row * velocity_names.size(), velocity_names.size(), first + pose);
    }
  }
  return column;
}

}  // namespace

ActionSpace action_space(const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  const std::size_t first = trials.front();
  if (parse_outcome(reader.info(first).outcome).grasp) {
    return {{"command_position", "command_speed", "command_force"}, {}, {counts, counts, counts}, {counts, counts, counts}};
  }
  ActionSpace space;
  const std::vector<std::string> sensors = reader.sensors(first);
  for (const std::string& body : reader.bodies(first)) {
    if (body == "pad" || std::find(sensors.begin(), sensors.end(), body) != sensors.end()) space.bodies.push_back(body);
  }
  if (space.bodies.empty()) reject("trial {}: no body carries a sensor, so there are no actions", first);
  std::array<double, 2> greatest{};  // m/s, rad/s; maximum over the trials
  for (const std::size_t trial : trials) {
    for (const std::string& body : space.bodies) {
      const auto velocity = reader.read<float>(trial, body_group(body) + "/velocity");
      for (std::size_t i = 0; i < velocity.size(); ++i) {
        double& top = greatest[i % velocity_names.size() < linear ? 0 : 1];
        top = std::max(top, std::abs(static_cast<double>(velocity[i])));
      }
    }
  }
  for (const std::string& body : space.bodies) {
    for (std::size_t i = 0; i < velocity_names.size(); ++i) {
      const double top = greatest[i < linear ? 0 : 1];
      space.names.push_back(fmt::format("{}_{}", body, velocity_names[i]));
      space.scale.push_back(top > 0.0 ? top : 1.0);
      space.offset.push_back(0.0);
    }
  }
  return space;
}

double slowest_rate(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked) {
  double rate = std::numeric_limits<double>::infinity();
  for (const std::string& name : chosen_sensors(reader, trial, asked))
    rate = std::min(rate, reader.read_sensor(trial, name).rate);
  return rate;
}

Episode make_episode(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked, double rate,
                     const ActionSpace& space) {
  const std::vector<std::string> sensors = chosen_sensors(reader, trial, asked);
  const TrialRecord record = reader.read_trial(trial);
  const Grid grid = grid_of(record, sensors, rate);
  Episode episode;
  episode.steps = grid.points - 1;
  for (const SensorRecord& one : record.sensors) {
    if (std::find(sensors.begin(), sensors.end(), one.name) == sensors.end()) continue;
    for (const SensorColumn& channel : one.channels) {
      const std::size_t width = channel.row_size();
      episode.observations.push_back({fmt::format("{}_{}", one.name, channel.name), width,
                                      resampled({one.times_of(channel), channel.values, width}, grid, grid.points)});
    }
    for (const LabelRuleInfo& rule : stored_rules()) {
      episode.states.push_back({fmt::format("{}_{}", one.name, array_of(rule)), 1,
                                resampled({one.time, floats(one.labels.*rule.stored), 1}, grid, episode.steps), rule.value});
    }
  }
  if (record.control && !record.control->grip.measured_position.empty()) {
    episode.observations.push_back(
        {"gripper_position", 1,
         resampled({record.control->time, floats(record.control->grip.measured_position), 1}, grid, grid.points)});
  }
  episode.actions = actions_of(record, grid, episode.steps, space);
  episode.bodies = bodies_of(record, grid, episode.steps);
  episode.rewards.assign(episode.steps, 0.0F);
  if (record.outcome.grasp && record.outcome.grasp->held()) episode.rewards.back() = 1.0F;
  return episode;
}

}  // namespace slipbench
