#include "tools/learning_data/samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "detectors/channel.h"
#include "sim/api/motion.h"
#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/scene/parser.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/recorded_scene.h"

namespace slipbench {
namespace {

// For each of `instants`, the latest row of a column with rows at `times`.
template <class T>
std::vector<T> rows_at(const std::vector<T>& values, const std::vector<double>& times, const std::vector<double>& instants) {
  const std::size_t width = times.empty() ? 0 : values.size() / times.size();
  std::vector<T> taken;
  taken.reserve(instants.size() * width);
  for (const double instant : instants) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(*latest_row(times, instant) * width);
    taken.insert(taken.end(), row, row + static_cast<std::ptrdiff_t>(width));
  }
  return taken;
}

// Number of samples per row of a channel.
std::size_t samples_a_row(const SensorColumn& column, const SensorRecord& sensor) {
  if (!column.time || column.time->size() == sensor.time.size()) return 1;
  if (column.time->size() < 2) return sensor.time.size();
  const double every = std::round(((*column.time)[1] - (*column.time)[0]) * sensor.rate);
  return static_cast<std::size_t>(std::clamp(every, 1.0, static_cast<double>(sensor.time.size())));
}

// The scene that was run, without the swept values.
SceneFile scene_of(const DatasetReader& reader) {
  const std::string file = reader.files().front();
  SceneFile scene = recorded_file(reader.header().scene, json_object(reader.header().overrides, file + ": attribute overrides"),
                                  file + ": scene");
  if (scene.root().kind != YamlNode::Kind::map) throw InputError(file + ": attribute scene is not a scene");
  return scene;
}

const Entry& motion_of(const YamlNode& root, const std::string& file) {
  const YamlNode* kind = node_at(root, std::vector<std::string>{"motion", "kind"});
  if (kind == nullptr) return default_motion(false).about;
  if (const MotionKind* const found = find_motion(kind->text)) return found->about;
  reject("{}: attribute scene has the unknown motion '{}'", file, kind->text);
}

// Commanded values of one trial: swept values take precedence over written ones.
class Commanded {
 public:
  Commanded(const DatasetReader& reader, std::size_t trial)
      : file_(reader.files()[reader.file_of(trial)]),
        swept_(json_object(reader.info(trial).params, fmt::format("{}: trial {}: attribute params", file_, trial))),
        scene_(scene_of(reader)) {}

  // Empty if the motion has no such number.
  [[nodiscard]] std::optional<double> number(const std::string& name) const {
    const Entry& motion = motion_of(scene_.root(), file_);
    const auto spec = std::ranges::find(motion.parameters, name, &ParameterSpec::name);
    if (spec == motion.parameters.end() || spec->type != ParameterType::number) return std::nullopt;
    if (const auto found = swept_.find("motion." + name); found != swept_.end() && found->is_number())
      return found->get<double>();
    const YamlNode* written = node_at(scene_.root(), std::vector<std::string>{"motion", name});
    if (written == nullptr) return std::get<double>(default_of(*spec));
    try {
      return std::get<double>(parse_scalar(*spec, written->text));
    } catch (const std::invalid_argument& error) {
      reject("{}: motion.{}: {}", written->origin.text(), name, error.what());
    }
  }

  [[nodiscard]] double needed(const std::string& name) const {
    if (const auto found = number(name)) return *found;
    reject("{}: its motion '{}' has no {}; expected a dataset whose pad is pressed and slides, such as on a stage", file_,
           motion_of(scene_.root(), file_).name, name);
  }

  [[nodiscard]] std::string word(const std::string& path) const {
    if (const auto found = swept_.find(path); found != swept_.end() && found->is_string()) return found->get<std::string>();
    const YamlNode* written = node_at(scene_.root(), split_path(path, scene_.root().origin));
    return written != nullptr && written->kind == YamlNode::Kind::scalar ? written->text : "";
  }

 private:
  std::string file_;
  Json swept_;
  SceneFile scene_;
};

const std::vector<float>& channel_of(const SensorRecord& record, const std::string& name, const std::string& unit) {
  for (const SensorColumn& channel : record.channels) {
    if (channel.name != name || channel.shape != std::vector<std::size_t>{pillars, 3}) continue;
    if (channel.unit != unit)
      reject("sensor {}: channel {} is in {}, but it is read in {}{}", record.name, name, quote(channel.unit), unit,
             other_unit_remedy(channel.unit, unit));
    return channel.values;
  }
  reject("sensor {}: has no channel '{}' of {} pillars", record.name, name, pillars);
}

const LabelRecord& checked_pillars(const SensorRecord& record) {
  if (record.type != "papillarray") reject("sensor {}: is a {}, but this format needs a papillarray", record.name, record.type);
  if (record.labels.units() != pillars) {
    reject("sensor {}: labels of {}, expected {}", record.name, counted(record.labels.units(), "unit"), pillars);
  }
  return record.labels;
}

}  // namespace

std::vector<std::string> chosen_sensors(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked) {
  reader.check_recorded(trial);
  std::vector<std::string> names = reader.sensors(trial);
  if (asked.empty()) return names;
  for (const std::string& name : asked) {
    if (std::ranges::find(names, name) == names.end()) {
      reject("trial {}: unknown sensor {}{}", trial, quote(name), allowed_names(name, names));
    }
  }
  std::erase_if(names, [&](const std::string& name) { return std::ranges::find(asked, name) == asked.end(); });
  return names;
}

std::optional<std::size_t> latest_row(std::span<const double> times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time + time_rounding);
  if (after == times.begin()) return std::nullopt;
  return static_cast<std::size_t>(after - times.begin()) - 1;
}

SensorRecord at_rate(SensorRecord sensor, double rate, std::size_t trial) {
  if (rate > sensor.rate * (1.0 + time_rounding)) {
    reject("trial {}: a rate of {} Hz would repeat samples of '{}'; allowed: up to {} Hz, the rate of the sensor", trial, rate,
           sensor.name, sensor.rate);
  }
  const std::vector<double> times = sensor.time;
  double start = times.empty() ? std::numeric_limits<double>::infinity() : times.front();
  for (const SensorColumn& channel : sensor.channels) {
    if (channel.time)
      start = channel.time->empty() ? std::numeric_limits<double>::infinity() : std::max(start, channel.time->front());
  }
  std::vector<double> instants;
  if (!times.empty() && times.back() + time_rounding >= start) {
    const auto rows = static_cast<std::size_t>(std::floor((times.back() - start + time_rounding) * rate)) + 1;
    for (std::size_t row = 0; row < rows; ++row) instants.push_back(start + static_cast<double>(row) / rate);
  }
  if (instants.size() < 2) {
    reject("trial {}: has fewer than two rows of '{}' at {} Hz; use a higher --rate", trial, sensor.name, rate);
  }
  for (SensorColumn& channel : sensor.channels) {
    channel.values = rows_at(channel.values, channel.time ? *channel.time : times, instants);
    channel.time.reset();
  }
  for_each_label(sensor.labels, sensor.labels.units(),
                 [&](const char*, const char*, const Extents&, auto& column) { column = rows_at(column, times, instants); });
  sensor.time = std::move(instants);
  sensor.rate = rate;
  return sensor;
}

RecordedSamples::RecordedSamples(const SensorRecord& sensor) : sensor_(&sensor) {
  std::size_t name = 0;
  const SensorView view = sensor_kind(sensor.type).view;
  for (const SensorColumn& column : sensor.channels) {
    Channel& channel = channels_.emplace_back(Channel{column.name, column.unit, column.shape, {}});
    channel.usual_unit = view.channel_view(column.name).unit;
    const std::size_t rows = sensor.times_of(column).size(), size = channel.size();
    if (column.values.size() != rows * size) {
      reject("sensor {}: channel {} has {} values for {} samples of {}", sensor.name, column.name, column.values.size(), rows,
             size);
    }
    channel.every = samples_a_row(column, sensor);
    if (column.time && !column.time->empty() && channel.every <= sensor.time.size()) {
      channel.age = sensor.time[channel.every - 1] - column.time->front();
    }
    for (std::size_t v = 0; v < size && name < sensor.channel_names.size(); ++v) {
      channel.channel_names.push_back(sensor.channel_names[name++]);
    }
    if (rows == 0)
      values_.resize(values_.size() + size);
    else
      values_.insert(values_.end(), column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

SensorFrame RecordedSamples::take() {
  float* values = values_.data();
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const std::size_t size = channels_[c].size(), row = next_ / channels_[c].every;
    const std::vector<float>& column = sensor_->channels[c].values;
    if ((next_ + 1) % channels_[c].every == 0 && (row + 1) * size <= column.size()) {
      std::copy_n(column.data() + row * size, size, values);
    }
    values += size;
  }
  return {sensor_->time[next_++], values_};
}

CommandedMotion commanded_motion(const DatasetReader& reader, std::size_t trial) {
  const Commanded commanded(reader, trial);
  return {commanded.needed("speed"), commanded.needed("rotation"), commanded.needed("compression")};
}

std::optional<double> commanded_number(const DatasetReader& reader, std::size_t trial, const std::string& name) {
  return Commanded(reader, trial).number(name);
}

std::string commanded_word(const DatasetReader& reader, std::size_t trial, const std::string& path) {
  return Commanded(reader, trial).word(path);
}

PillarLabels::PillarLabels(std::span<const std::uint8_t> unit_state, std::span<const float> slip_velocity,
                           std::span<const float> force, LabelRule rule, double label_speed)
    : unit_state_(unit_state), slip_velocity_(slip_velocity), force_(force), rule_(rule), label_speed_(label_speed) {
  if (unit_state.size() % pillars != 0 || slip_velocity.size() != 2 * unit_state.size() ||
      force.size() != 3 * unit_state.size()) {
    reject("labels of {} pillars: {} states, {} velocities and {} forces do not match", pillars, unit_state.size(),
           slip_velocity.size(), force.size());
  }
  if (rule != LabelRule::has_slipped) return;
  has_slipped_.resize(size() * pillars);
  for (std::size_t row = 0; row < size(); ++row) {
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      const std::size_t place = row * pillars + pillar;
      const bool before = row > 0 && has_slipped_[place - pillars] != 0;
      has_slipped_[place] = (before && touching(row, pillar)) || fast(row, pillar) ? 1 : 0;
    }
  }
}

bool PillarLabels::fast(std::size_t row, std::size_t pillar) const {
  const float* velocity = slip_velocity_.data() + (row * pillars + pillar) * 2;
  return touching(row, pillar) && math::hypot(velocity[0], velocity[1]) > label_speed_;
}

bool PillarLabels::slipping(std::size_t row, std::size_t pillar) const {
  const UnitState state = this->state(row, pillar);
  switch (rule_) {
    case LabelRule::strict: return state == UnitState::slip;
    case LabelRule::micro: return state == UnitState::slip || state == UnitState::partial;
    case LabelRule::paper: return fast(row, pillar);
    case LabelRule::has_slipped: return has_slipped_[row * pillars + pillar] != 0;
    default: throw std::logic_error("the label rule " + label_rule_name(rule_) + " does not decide for single pillars");
  }
}

PadState PillarLabels::pad_state(std::size_t row, bool turning) const {
  bool in_contact = false;
  UnitCounts judged;
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    if (!touching(row, pillar)) continue;
    in_contact = true;
    if (turning && pillar == middle_pillar) continue;
    ++judged.touching;
    if (slipping(row, pillar)) ++judged.slipping;
  }
  return in_contact && judged.touching == 0 ? PadState::non_slip : judged.state();
}

double PillarLabels::tangential_force(std::size_t row, std::size_t pillar) const {
  const float* force = force_.data() + (row * pillars + pillar) * 3;
  return math::hypot(force[0], force[1]);
}

PapillarraySamples::PapillarraySamples(const SensorRecord& record, LabelRule rule, double label_speed)
    : PillarLabels(checked_pillars(record).unit_state, record.labels.slip_velocity, record.labels.force, rule, label_speed),
      record_(&record),
      force_(&channel_of(record, "force", "N")),
      displacement_(&channel_of(record, "displacement", "m")) {}

std::array<double, 3> PapillarraySamples::tip(std::size_t pillar) const {
  const LabelRecord& labels = record_->labels;
  return {labels.unit_positions[2 * pillar], labels.unit_positions[2 * pillar + 1], labels.unit_heights[pillar]};
}

std::vector<std::string> papillarrays_of(const DatasetReader& reader, std::size_t trial) {
  reader.check_recorded(trial);
  std::vector<std::string> names;
  for (const std::string& name : reader.sensors(trial)) {
    if (reader.sensor_type(trial, name) == "papillarray") names.push_back(name);
  }
  if (names.empty()) reject("trial {}: has no papillarray, which this format needs", trial);
  return names;
}

std::vector<std::string> vendor_log_columns(std::size_t sensors) {
  std::vector<std::string> names{"T_us"};
  for (std::size_t s = 0; s < sensors; ++s) {
    for (std::size_t p = 0; p < pillars; ++p) {
      for (const char* column : {"DX", "DY", "DZ", "FX", "FY", "FZ"}) names.push_back(fmt::format("S{}_P{}_{}", s, p, column));
    }
    for (const char* column : {"FX", "FY", "FZ", "TX", "TY", "TZ"}) names.push_back(fmt::format("S{}_GG_{}", s, column));
    names.push_back(fmt::format("S{}_isSDActive", s));
    names.push_back(fmt::format("S{}_isRefLoad", s));
    for (std::size_t p = 0; p < pillars; ++p) {
      names.push_back(fmt::format("S{}_P{}_isInContact", s, p));
      names.push_back(fmt::format("S{}_P{}_slipState", s, p));
    }
    names.push_back(fmt::format("S{}_FrictionEst", s));
  }
  return names;
}

std::vector<std::string> grasp_columns() {
  std::vector<std::string> names{"object", "slipped"};
  for (const char* finger : grasp_fingers) {
    for (std::size_t e = 1; e <= finger_electrodes; ++e) names.push_back(fmt::format("{}_biotac_{}", finger, e));
  }
  return names;
}

}  // namespace slipbench
