#include "tools/eval/replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "detectors/detector_kinds.h"
#include "detectors/hd/memory_files.h"
#include "detectors/resampling.h"
#include "tools/files/reject.h"
#include "tools/learning_data/samples.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/trial_run.h"

namespace slipbench::eval {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// The same instant may differ in the last digits between sensors with different steps.
bool is_later(double time, double now) { return time > now + 4.0 * std::numeric_limits<double>::epsilon() * std::abs(now); }

// Index of a feature of a detector.
std::optional<std::size_t> place_of(const std::vector<Feature>& features, const char* name) {
  const auto found = std::ranges::find(features, name, &Feature::name);
  if (found == features.end()) return std::nullopt;
  return static_cast<std::size_t>(found - features.begin());
}

double checked_probability(double value, double time) {
  if (std::isnan(value) || (value >= 0.0 && value <= 1.0)) return value;
  reject("at {:.6g} s the detector's {} is {}; allowed: 0 to 1", time, probability_feature, value);
}

// Records the answers at each sample.
class Rows {
 public:
  Rows(DelayedDetector& detector, std::size_t samples)
      : detector_(&detector),
        place_(place_of(detector.features(), probability_feature)),
        class_place_(place_of(detector.features(), class_feature)) {
    rows_.seen.reserve(samples);
    for (std::vector<double>* column : {&rows_.seen_since, &rows_.stuck_fraction, &rows_.probability, &rows_.named})
      column->reserve(samples);
  }

  void add(const SensorFrame& frame) {
    detector_->update(frame);
    const SlipEstimate& now = detector_->seen_at(frame.time);
    // Fresh: the first sample that sees this estimate. The loop's initial estimate, no_contact, has
    // no features.
    const bool fresh = now.time != last_;
    last_ = now.time;
    rows_.seen.push_back(now.state);
    rows_.seen_since.push_back(now.time + now.latency);
    rows_.stuck_fraction.push_back(now.stuck_fraction);
    const bool says = fresh && place_ && *place_ < now.features.size();
    rows_.named.push_back(fresh && class_place_ && *class_place_ < now.features.size() ? now.features[*class_place_] : unknown);
    rows_.probability.push_back(says ? checked_probability(now.features[*place_], now.time) : unknown);
  }
  Replayed take() { return std::move(rows_); }

 private:
  DelayedDetector* detector_;
  std::optional<std::size_t> place_, class_place_;
  double last_ = unknown;
  Replayed rows_;
};

// Name of a channel's value: the title of its column, if the recording has one.
std::string value_name(const SensorRecord& sensor, const SensorColumn& channel, std::size_t value) {
  std::size_t before = 0;
  for (const SensorColumn& one : sensor.channels) {
    if (&one == &channel) break;
    before += one.row_size();
  }
  const std::string number = fmt::format("value {} of channel {}", value + 1, channel.name);
  return before + value < sensor.channel_names.size() ? fmt::format("{} ({})", number, sensor.channel_names[before + value])
                                                      : number;
}

// A missing value of a recording (`missing: nan` of its map) would count as no contact or as no
// slip.
void check_no_missing_value(const SensorRecord& sensor) {
  for (const SensorColumn& channel : sensor.channels) {
    const auto missing = std::ranges::find_if_not(channel.values, [](float value) { return std::isfinite(value); });
    if (missing == channel.values.end()) continue;
    const std::size_t width = channel.row_size();
    const auto place = static_cast<std::size_t>(missing - channel.values.begin());
    const std::string name = value_name(sensor, channel, place % width);
    bool always = true;
    for (std::size_t at = place % width; at < channel.values.size(); at += width)
      always = always && !std::isfinite(channel.values[at]);
    if (always)
      reject(
          "sensor {}: {} is missing in all samples; in the map, leave out the column of a defective element, or name the column of a "
          "neighbour if the detector needs all elements",
          sensor.name, name);
    reject(
        "sensor {}: {} is missing at {:.6g} s; import the recording with missing: gap in the map, which leaves "
        "out incomplete samples",
        sensor.name, name, sensor.times_of(channel)[place / width]);
  }
}

// The smallest scene with a detector. Its sensor is irrelevant: make_detector() uses that of the
// dataset.
constexpr const char* scene_around = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

// Quotes any text as YAML.
std::string yaml_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("''") : std::string(1, c);
  return word + "'";
}

// The first detector of the catalogue with such a file, and the override that names it.
std::pair<std::string, std::vector<Override>> detector_with(DetectorFile::Content content, const std::string& path) {
  for (const Entry& entry : detector_entries()) {
    const DetectorKind* const kind = detector_kind(entry.name);
    if (kind != nullptr && kind->file && kind->file->content == content)
      return {entry.name, {{std::string("detector.") + kind->file->parameter, yaml_word(path)}}};
  }
  throw std::logic_error("no detector with such a file");
}

// The detector's type, and the parameter that `text` implies if it is not a name.
std::pair<std::string, std::vector<Override>> type_of(const std::string& text) {
  std::vector<std::string> names;
  for (const Entry& entry : detector_entries()) {
    if (entry.name != oracle_type) names.push_back(entry.name);
  }
  const std::string allowed = allowed_names(text, names) + ", FILE.onnx, or a folder of memories";
  if (text == oracle_type)
    throw InputError(quote(text) + " is the oracle, which needs a simulation and cannot read a recording" + allowed);
  if (std::ranges::find(names, text) != names.end()) return {text, {}};
  if (text.ends_with(".onnx")) return detector_with(DetectorFile::Content::network, text);
  std::error_code error;
  if (std::filesystem::is_directory(hd::memories_folder(text), error))
    return detector_with(DetectorFile::Content::memories, text);
  throw InputError("unknown detector " + quote(text) + allowed);
}

}  // namespace

Replayed replay(const DetectorScene& detector, std::span<const SensorRecord> sensors, std::size_t sensor, std::uint64_t seed,
                std::uint64_t trial, bool interpolate) {
  std::vector<SensorSource> sources;
  double duration = 0.0;
  for (const SensorRecord& record : sensors) {
    if (record.time.empty()) reject("sensor {}: has no samples", record.name);
    sources.push_back(RecordedSamples(record).source());
    duration = std::max(duration, record.time.back());
  }
  const SensorSource& own = sources[sensor];
  FrameSource source{own.name, own.type, own.rate, own.channels, trial, duration, seed, sources};
  if (!sensors[sensor].labels.truth) {
    check_no_missing_value(sensors[sensor]);
    source.rate_rounding = rate_tolerance;
  }
  source.interpolate = interpolate;
  const FrameSpacing spacing = frame_spacing(detector.type);
  if (spacing == FrameSpacing::any || evenly_spaced(sensors[sensor]))
    return replay(make_detector(detector, source), sensors, sensor);
  if (spacing == FrameSpacing::even) check_evenly_spaced(sensors[sensor]);
  source.uneven_times = sensors[sensor].time;
  if (spacing == FrameSpacing::own) return replay(make_detector(detector, source), sensors, sensor);
  const Resampling evened = even_resampling_of(source, detector.type);
  FrameSource even = source;
  even.rate = evened.rate;
  even.uneven_times = {};
  return replay(resampled(make_detector(detector, even), evened, source, resampling_text(evened, source, detector.type)), sensors,
                sensor);
}

Replayed replay(std::unique_ptr<Detector> detector, std::span<const SensorRecord> sensors, std::size_t sensor) {
  std::vector<RecordedSamples> samples(sensors.begin(), sensors.end());
  DelayedDetector delayed(std::move(detector));
  Rows rows(delayed, sensors[sensor].time.size());
  SampleListener* const listener = delayed.listener();
  if (listener == nullptr) {
    while (!samples[sensor].ended()) rows.add(samples[sensor].take());
  }
  while (listener != nullptr && std::ranges::any_of(samples, [](const RecordedSamples& one) { return !one.ended(); })) {
    double now = std::numeric_limits<double>::infinity();
    for (const RecordedSamples& one : samples) now = one.ended() ? now : std::min(now, one.time());
    std::optional<SensorFrame> frame;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (samples[k].ended() || is_later(samples[k].time(), now)) continue;
      const SensorFrame taken = samples[k].take();
      listener->hear(k, taken);
      if (k == sensor) frame = taken;
    }
    if (frame) rows.add(*frame);
  }
  delayed.finish();
  Replayed replayed = rows.take();
  replayed.notice = delayed.notice();
  return replayed;
}

DetectorScene chosen_detector(const std::string& text, const std::vector<Override>& parameters) {
  const auto [type, own] = type_of(text);
  SceneFile scene = SceneFile::from_text(scene_around, "eval");
  scene.apply({"detector.type", type});
  for (const Override& change : own) scene.apply(change);
  for (const Override& change : parameters) scene.apply({"detector." + change.path, change.value});
  return parse_scene(scene, program_catalogues()).detector.value();
}

std::unique_ptr<network::Engine> network_of(const DetectorScene& detector) {
  const DetectorKind* const kind = detector_kind(detector.type);
  if (kind == nullptr || !kind->file || kind->file->content != DetectorFile::Content::network) return nullptr;
  const std::string& model = detector.parameters.path(kind->file->parameter);
  if (model == no_network)
    throw InputError("no network is given; use FILE.onnx instead of 'network', or the parameter model=FILE.onnx");
  return network::load_engine(model);
}

}  // namespace slipbench::eval
