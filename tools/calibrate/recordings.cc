#include "tools/calibrate/recordings.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "detectors/channel.h"
#include "sim/core/math/decade.h"
#include "sim/core/quantity.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/files/given_once.h"
#include "tools/files/reject.h"
#include "tools/formats/import/import.h"

namespace slipbench::calibrate {
namespace {

std::string recording_name(std::size_t trial, const std::string& path) { return fmt::format("demo_{} of {}", trial, path); }

void check_even(const std::string& recording, const SensorRecord& sensor) {
  try {
    check_evenly_spaced(sensor);
  } catch (const InputError& error) {
    reject("{}: {}", recording, error.what());
  }
}

std::vector<RawRecording> dataset_recordings(const std::string& path) {
  const DatasetReader reader = checked_dataset(path);
  std::vector<RawRecording> recordings;
  for (const std::size_t trial : reader.trials()) {
    reader.check_recorded(trial);
    RawRecording recording{.name = recording_name(trial, path), .sensors = {}, .params = reader.info(trial).params};
    for (const std::string& name : reader.sensors(trial)) {
      recording.sensors.push_back(reader.read_sensor(trial, name));
      check_even(recording.name, recording.sensors.back());
    }
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

void check_values(const RawRecording& recording) {
  for (const SensorRecord& sensor : recording.sensors) {
    for (const SensorColumn& column : sensor.channels) {
      if (std::ranges::all_of(column.values, [](float value) { return std::isfinite(value); })) continue;
      reject("{}: {}/{} contains a value that is not finite", recording.name, sensor.name, column.name);
    }
  }
}

const SensorColumn* find_channel(const SensorRecord& sensor, const std::string& name) {
  const auto found = std::ranges::find(sensor.channels, name, &SensorColumn::name);
  return found == sensor.channels.end() ? nullptr : &*found;
}

const SensorRecord& sensor_of(const std::vector<SensorRecord>& sensors, Side side, const ChannelPlace& place) {
  return sensors[side == Side::real ? place.recorded_sensor : place.scene_sensor];
}

// Returns the index of the recorded sensor that corresponds to the simulated one; the number of
// recorded sensors if there is none.
std::size_t recorded_of(const RawRecording& real, const SensorRecord& simulated, const std::vector<SensorRecord>& scene) {
  const auto named = std::ranges::find(real.sensors, simulated.name, &SensorRecord::name);
  if (named != real.sensors.end()) return static_cast<std::size_t>(named - real.sensors.begin());
  std::size_t found = real.sensors.size();
  const auto without_namesake = [&](const SensorRecord& sensor) {
    return sensor.type == simulated.type &&
           std::ranges::find(real.sensors, sensor.name, &SensorRecord::name) == real.sensors.end();
  };
  if (std::ranges::count_if(scene, without_namesake) > 1) return found;  // it may be any of them
  for (std::size_t s = 0; s < real.sensors.size(); ++s) {
    if (real.sensors[s].type != simulated.type) continue;
    if (std::ranges::find(scene, real.sensors[s].name, &SensorRecord::name) != scene.end()) continue;  // matches another by name
    if (found != real.sensors.size()) return real.sensors.size();
    found = s;
  }
  return found;
}

// Mean period of a channel's samples [s]; 0 for fewer than two samples.
double mean_step(const std::vector<double>& times) {
  return times.size() < 2 ? 0.0 : (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

// In a shape [N, C], C up to this is the number of components per unit; a larger C is the width of
// an image.
constexpr std::size_t most_components = 4;

ChannelPlace place_of(const SensorRecord& sensor, const SensorColumn& column) {
  ChannelPlace place{.sensor = sensor.name, .channel = column.name, .unit = column.unit, .names = {}};
  place.components = column.shape.size() == 2 && column.shape[1] <= most_components ? column.shape[1] : 1;
  place.units = column.row_size() / place.components;
  for (std::size_t k = 0; k < place.components; ++k) {
    const bool axes = place.components == 3;
    place.names.push_back(place.components == 1 ? "" : axes ? std::string(1, "xyz"[k]) : std::to_string(k + 1));
  }
  return place;
}

}  // namespace

std::vector<RawRecording> read_recordings(const std::vector<std::string>& paths, const ImportFormat* format) {
  check_given_once(paths, "recording");
  std::vector<RawRecording> recordings;
  if (format != nullptr) {
    for_each_recording(paths, *format, [&](TrialRecord record, const std::string& source) {
      for (const SensorRecord& sensor : record.sensors) check_even(source, sensor);
      recordings.push_back({source, std::move(record.sensors), std::move(record.params)});
    });
  } else {
    for (const std::string& path : paths) {
      std::error_code error;
      if (std::filesystem::path(path).extension() == ".csv" || std::filesystem::is_directory(path, error))
        reject("{}: is not a dataset; expected FILE.h5, or --format NAME with {}", path, fmt::join(import_format_names(), ", "));
      for (RawRecording& recording : dataset_recordings(path)) recordings.push_back(std::move(recording));
    }
  }
  if (recordings.empty()) reject("{}: contains no recording", fmt::join(paths, ", "));
  for (const RawRecording& recording : recordings) check_values(recording);
  return recordings;
}

Columns shared_columns(const RawRecording& real, const std::vector<SensorRecord>& simulated) {
  Columns columns;
  for (std::size_t s = 0; s < simulated.size(); ++s) {
    const SensorRecord& sensor = simulated[s];
    const std::size_t recorded = recorded_of(real, sensor, simulated);
    if (recorded == real.sensors.size()) continue;
    for (const SensorColumn& column : sensor.channels) {
      const SensorColumn* found = find_channel(real.sensors[recorded], column.name);
      if (found == nullptr) continue;
      if (found->shape != column.shape)
        reject("{}: {}/{} has [{}] values per sample, but the scene's sensor has [{}]", real.name, sensor.name, column.name,
               fmt::join(found->shape, ", "), fmt::join(column.shape, ", "));
      if (found->unit != column.unit)
        reject("{}: {}/{} is in {}, but the scene's sensor has it in {}{}", real.name, sensor.name, column.name,
               quote(found->unit), quote(column.unit), other_unit_remedy(found->unit, column.unit));
      ChannelPlace place = place_of(sensor, column);
      place.first = columns.count;
      place.recorded_sensor = recorded;
      place.scene_sensor = s;
      columns.count += place.units * place.components;
      columns.channels.push_back(std::move(place));
    }
  }
  if (columns.channels.empty()) {
    std::vector<std::string> found, scene;
    for (const SensorRecord& sensor : real.sensors) found.push_back(fmt::format("{} ({})", sensor.name, sensor.type));
    for (const SensorRecord& sensor : simulated) scene.push_back(fmt::format("{} ({})", sensor.name, sensor.type));
    reject("{}: contains {}, but the scene has {}; they need a sensor in common", real.name, fmt::join(found, ", "),
           fmt::join(scene, ", "));
  }
  return columns;
}

void check_same_columns(const std::string& name, const Columns& columns, const std::string& first_name, const Columns& first) {
  // Equal names imply equal shapes, because both are the scene's.
  const auto names = [](const Columns& columns) {
    std::vector<std::string> found;
    for (const ChannelPlace& place : columns.channels) found.push_back(place.sensor + "/" + place.channel);
    return found;
  };
  if (names(columns) == names(first)) return;
  reject("{}: contains {}, but {} contains {}; all recordings must have the same sensors", name, fmt::join(names(columns), ", "),
         first_name, fmt::join(names(first), ", "));
}

void check_same_sampling(const RawRecording& real, const std::vector<SensorRecord>& simulated, const Columns& columns,
                         double most_longer, double lag) {
  const auto readable = [](double value, Quantity quantity) { return format_quantity(rounded_to_digits(value, 4), quantity); };
  const auto duration = [](const SensorRecord& sensor) {
    return sensor.time.empty() ? 0.0 : sensor.time.back() - sensor.time.front();
  };
  for (const ChannelPlace& place : columns.channels) {
    const SensorRecord &recorded = sensor_of(real.sensors, Side::real, place), &scene = sensor_of(simulated, Side::scene, place);
    const double recorded_step = mean_step(recorded.times_of(*find_channel(recorded, place.channel))),
                 scene_step = mean_step(scene.times_of(*find_channel(scene, place.channel)));
    if (recorded_step > 0.0 && scene_step > 0.0 && !same_rate(1.0 / recorded_step, 1.0 / scene_step)) {
      reject("{}: {}/{} has a sample every {}, but the scene's sensor every {}; the rates must agree within 1 % ({} and {})",
             real.name, place.sensor, place.channel, readable(recorded_step, Quantity::time),
             readable(scene_step, Quantity::time), readable(1.0 / recorded_step, Quantity::frequency),
             readable(1.0 / scene_step, Quantity::frequency));
    }
    const double recorded_duration = duration(recorded), scene_duration = duration(scene);
    const double longer = std::max(recorded_duration, scene_duration), shorter = std::min(recorded_duration, scene_duration);
    if (shorter > 0.0 && longer - lag > most_longer * shorter) {
      reject("{}: sensor {} lasts {}, but the scene's trial {}; they may differ by up to {:.0f} %", real.name, place.sensor,
             readable(recorded_duration, Quantity::time), readable(scene_duration, Quantity::time), 100.0 * (most_longer - 1.0));
    }
  }
}

Samples samples_of(const std::vector<SensorRecord>& sensors, Side side, const ChannelPlace& place) {
  const SensorRecord& sensor = sensor_of(sensors, side, place);
  const SensorColumn& column = *find_channel(sensor, place.channel);
  const std::vector<double>& time = sensor.times_of(column);
  using Rows = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const Rows rows(column.values.data(), static_cast<Eigen::Index>(time.size()),
                  static_cast<Eigen::Index>(place.units * place.components));
  return {rows.cast<double>(), mean_step(time)};
}

std::vector<double> bin_edges(const RawRecording& real, const std::vector<SensorRecord>& simulated) {
  const std::vector<double>& recorded = real.sensors.front().time;
  const std::vector<double>& scene = simulated.front().time;
  const double span = std::min(recorded.back() - recorded.front(), scene.back() - scene.front());
  const std::size_t bins = std::min({most_bins, recorded.size() - 1, scene.size() - 1});
  if (bins == 0 || !(span > 0.0)) reject("{}: has a single sample; at least two are needed", real.name);
  std::vector<double> edges(bins + 1);
  for (std::size_t k = 0; k <= bins; ++k) edges[k] = scene.front() + span * static_cast<double>(k) / static_cast<double>(bins);
  return edges;
}

Eigen::MatrixXd bin_means(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                          const std::vector<double>& edges, double shift) {
  const auto bins = static_cast<Eigen::Index>(edges.size() - 1);
  Eigen::MatrixXd means(bins, static_cast<Eigen::Index>(columns.count));
  using Rows = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  for (const ChannelPlace& place : columns.channels) {
    const SensorRecord& sensor = sensor_of(sensors, side, place);
    const SensorColumn& column = *find_channel(sensor, place.channel);
    const std::vector<double>& time = sensor.times_of(column);
    const auto width = static_cast<Eigen::Index>(place.units * place.components);
    const Rows rows(column.values.data(), static_cast<Eigen::Index>(time.size()), width);
    Eigen::RowVectorXd sum(width);
    std::size_t at = 0;  // the sample before which a stretch begins
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
      const double begin = edges[static_cast<std::size_t>(bin)] - shift, end = edges[static_cast<std::size_t>(bin) + 1] - shift;
      sum.setZero();
      while (at < time.size() && time[at] <= begin) ++at;
      double from = begin;
      for (std::size_t next = at; from < end; ++next) {
        const double to = next < time.size() ? std::min(end, time[next]) : end;
        if (next == 0 || next == time.size()) {
          sum += (to - from) * rows.row(static_cast<Eigen::Index>(next == 0 ? 0 : next - 1)).cast<double>();
        } else {
          const double share = (0.5 * (from + to) - time[next - 1]) / (time[next] - time[next - 1]);
          const auto row = static_cast<Eigen::Index>(next);
          sum += (to - from) * ((1.0 - share) * rows.row(row - 1).cast<double>() + share * rows.row(row).cast<double>());
        }
        from = to;
      }
      means.row(bin).segment(static_cast<Eigen::Index>(place.first), width) = sum / (end - begin);
    }
  }
  return means;
}

Eigen::VectorXd roughness(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns) {
  Eigen::VectorXd rough(static_cast<Eigen::Index>(columns.count));
  for (const ChannelPlace& place : columns.channels) {
    const SensorColumn& column = *find_channel(sensor_of(sensors, side, place), place.channel);
    const std::size_t width = place.units * place.components, rows = column.values.size() / width;
    for (std::size_t c = 0; c < width; ++c) {
      double sum = 0.0;
      for (std::size_t row = 1; row < rows; ++row) {
        const double step = double{column.values[row * width + c]} - double{column.values[(row - 1) * width + c]};
        sum += step * step;
      }
      rough(static_cast<Eigen::Index>(place.first + c)) =
          std::sqrt(0.5 * sum / static_cast<double>(std::max<std::size_t>(1, rows - 1)));
    }
  }
  return rough;
}

Eigen::VectorXd rms_over(const std::vector<Eigen::VectorXd>& values) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(values.front().size());
  for (const Eigen::VectorXd& value : values) squares += value.cwiseAbs2();
  return (squares / static_cast<double>(values.size())).cwiseSqrt();
}

}  // namespace slipbench::calibrate
