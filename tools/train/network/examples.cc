#include "tools/train/network/examples.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/network/frames.h"
#include "detectors/resampling.h"
#include "sim/api/contact_frame.h"
#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/core/random.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/slip_path.h"
#include "tools/files/reject.h"
#include "tools/learning_data/myrmex_images.h"
#include "tools/learning_data/samples.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/slip_score.h"

namespace slipbench::train {

namespace {

// Rigid motion in the pad plane that best fits the slip of the units: velocity of their middle, and
// rotation about it.
struct SlipMotion {
  double x = 0.0, y = 0.0;  // m/s
  double turn = 0.0;        // rad/s
  double spread = 0.0;      // m^2, mean square distance from the middle
  bool any = false;

  [[nodiscard]] bool rotates() const { return turn * turn * spread > x * x + y * y; }
};

SlipMotion slip_motion(const LabelRecord& labels, std::size_t row) {
  const std::size_t units = labels.units();
  SlipMotion motion;
  double count = 0.0, middle_x = 0.0, middle_y = 0.0;
  const auto for_each = [&](auto&& use) {
    for (std::size_t u = 0; u < units; ++u) {
      const std::size_t at = row * units + u;
      const double vx = labels.slip_velocity[2 * at], vy = labels.slip_velocity[2 * at + 1];
      if (vx != 0.0 || vy != 0.0) use(labels.unit_positions[2 * u], labels.unit_positions[2 * u + 1], vx, vy);
    }
  };
  for_each([&](double px, double py, double vx, double vy) {
    count += 1.0;
    middle_x += px;
    middle_y += py;
    motion.x += vx;
    motion.y += vy;
  });
  if (count == 0.0) return motion;
  motion.any = true;
  middle_x /= count;
  middle_y /= count;
  motion.x /= count;
  motion.y /= count;
  double moment = 0.0;
  for_each([&](double px, double py, double vx, double vy) {
    const double rx = px - middle_x, ry = py - middle_y;
    moment += (rx * vy - ry * vx) / count;
    motion.spread += (rx * rx + ry * ry) / count;
  });
  if (motion.spread > 0.0) motion.turn = moment / motion.spread;
  return motion;
}

constexpr std::array directions{"t", "n", "e", "s", "w", "cw", "aw"};

// Class of a trial: the one that an imported trial names, else from its commanded motion
// (scenes/biotac_sp/slip.yaml).
std::uint8_t direction_of(const std::string& params) {
  const Json swept = Json::parse(params);
  if (const auto named = swept.find("class"); named != swept.end() && named->is_string()) {
    const auto found = std::ranges::find(directions, named->get<std::string>());
    if (found == directions.end()) reject("its class is {}; allowed: {}", named->dump(), fmt::join(directions, ", "));
    return static_cast<std::uint8_t>(found - directions.begin());
  }
  const auto number = [&](const char* path) {
    const auto found = swept.find(path);
    if (found == swept.end() || !found->is_number())
      reject(
          "the sweep has no {}; expected trials that sweep motion.speed, motion.rotation and motion.direction, like "
          "scenes/biotac_sp/slip.yaml",
          path);
    return found->get<double>();
  };
  const double turn = number("motion.rotation"), speed = number("motion.speed"), direction = number("motion.direction");
  if (turn != 0.0) return turn > 0.0 ? 5 : 6;
  if (speed == 0.0) return 0;
  const auto quarter = std::lround(direction / (0.5 * std::numbers::pi));
  return static_cast<std::uint8_t>(1 + (quarter % 4 + 4) % 4);
}

// The class of a slipping sample.
std::uint8_t kind_of(const LabelRecord& labels, std::size_t row, ClassRule classes) {
  if (classes == ClassRule::slip) return 1;
  const SlipMotion motion = slip_motion(labels, row);
  if (!motion.any) return masked;  // the label lags: the slipping units have come to rest
  return motion.rotates() ? 2 : 1;
}

bool touches(PadState state) { return state != PadState::no_contact; }

// Declares the samples of a slip as stick if the object moves by less than least_slip_distance in this slip.
// `joined`: all slips of one contact are one slip. The elements of a skin may stick and slip in turns, so that
// a slide consists of many short slips.
void drop_small_slips(std::vector<PadState>& states, const std::vector<double>& path, bool joined) {
  for (std::size_t first = 0; first < states.size(); ++first) {
    if (!slips(states[first])) continue;
    std::size_t end = first;
    while (end < states.size() && (joined ? touches(states[end]) : slips(states[end]))) ++end;
    if (path[end - 1] - (first == 0 ? 0.0 : path[first - 1]) < least_slip_distance) {
      std::fill(states.begin() + static_cast<std::ptrdiff_t>(first), states.begin() + static_cast<std::ptrdiff_t>(end),
                PadState::non_slip);
    }
    first = end;
  }
}

// A slip may begin and end between two samples of a slow sensor: declares the first sample after it as
// slip if the object moved by least_slip_distance or more in between.
void add_slips_between(std::vector<PadState>& states, const std::vector<double>& path) {
  for (std::size_t row = 1; row < states.size(); ++row) {
    if (states[row] == PadState::non_slip && path[row] - path[row - 1] >= least_slip_distance) states[row] = PadState::gross;
  }
}

// Masks the samples of each slip before the object has moved by least_slip_distance. `joined`: as above.
// A slip stays masked throughout if the object reaches this distance in a sample of stick.
void mask_beginnings(std::vector<std::uint8_t>& labels, const std::vector<PadState>& states, const std::vector<double>& path,
                     bool joined) {
  double begin = 0.0;
  bool slipped = false;  // in this contact
  for (std::size_t row = 0; row < states.size(); ++row) {
    if (!touches(states[row])) slipped = false;
    if (!slips(states[row])) {
      if (!joined || !slipped) begin = path[row];
      continue;
    }
    slipped = true;
    if (path[row] - begin < least_slip_distance) labels[row] = masked;
  }
}

// The label of every sample by the states of the pad.
template <class KindOf>
std::vector<std::uint8_t> labels_by(const std::vector<PadState>& states, AfterSlip after_slip, bool grasp, KindOf&& kind_of_row) {
  const bool masks = after_slip == AfterSlip::masked || (after_slip == AfterSlip::masked_on_stage && !grasp);
  std::vector<std::uint8_t> labels;
  bool slipped = false;          // in this contact
  std::uint8_t latest = masked;  // class of its latest slip
  for (std::size_t row = 0; row < states.size(); ++row) {
    if (!touches(states[row])) slipped = false;
    if (slips(states[row])) {
      const std::uint8_t kind = kind_of_row(row);
      if (kind != masked || !slipped) latest = kind;
      slipped = true;
      labels.push_back(kind);
    } else if (slipped && after_slip == AfterSlip::slip) {
      labels.push_back(latest);
    } else {
      labels.push_back(slipped && masks ? masked : std::uint8_t{0});
    }
  }
  return labels;
}

// Example::scored of every sample.
std::vector<std::uint8_t> scored_labels(const TrialRecord& record, const SensorRecord& sensor, const std::vector<double>& path) {
  std::vector<PadState> states = states_by(sensor, LabelRule::micro, false, LabelUse::training);
  add_slips_between(states, path);
  drop_small_slips(states, path, !record.outcome.grasp);
  return labels_by(states, AfterSlip::masked_on_stage, record.outcome.grasp.has_value(),
                   [](std::size_t) { return std::uint8_t{1}; });
}

// Masks the samples whose state nobody knows.
void mask_unknown(std::vector<std::uint8_t>& labels, const std::vector<PadState>& states) {
  for (std::size_t row = 0; row < states.size(); ++row) {
    if (states[row] == unknown_state) labels[row] = masked;
  }
}

// The class of every sample.
std::vector<std::uint8_t> labels_of(const TrialRecord& record, const SensorRecord& sensor, LabelRule rule, ClassRule classes) {
  const LabelRuleInfo& about = about_rule(rule);
  // `turning` matters only to rules that networks do not take.
  std::vector<PadState> states = states_by(sensor, rule, false, LabelUse::training);
  std::vector<std::uint8_t> labels;
  if (classes == ClassRule::direction) {
    const std::uint8_t direction = direction_of(record.params);
    const bool truth = about.after_slip == AfterSlip::slip && sensor.labels.stuck_fraction.size() == states.size();
    bool slipped = !truth;  // more than half of the touching units, in this contact
    for (std::size_t row = 0; row < states.size(); ++row) {
      const bool contact = touches(states[row]);
      const bool slides = truth && contact && sensor.labels.stuck_fraction[row] < 0.5F;
      if (truth) slipped = contact && (slipped || slides);
      const bool neither = truth && (direction == 0 ? slides : !slipped && slips(sensor.labels.state[row]));
      labels.push_back(!contact || neither ? masked : slipped ? direction : std::uint8_t{0});
    }
    mask_unknown(labels, states);
    return labels;
  }
  const std::vector<double> path = about.least_distance ? slip_path(sensor.labels, states.size()) : std::vector<double>();
  if (about.least_distance) {
    if (path.empty()) reject("the labels have no slip distance; expected those of `slipbench sweep`");
    add_slips_between(states, path);
    drop_small_slips(states, path, !record.outcome.grasp);
  }
  labels = labels_by(states, about.after_slip, record.outcome.grasp.has_value(),
                     [&](std::size_t row) { return kind_of(sensor.labels, row, classes); });
  if (about.least_distance) mask_beginnings(labels, states, path, !record.outcome.grasp);
  mask_unknown(labels, states);
  return labels;
}

// Turns the innermost taxels of a myrmex, the first values of its sample.
void turn_taxels(std::span<float> sample, std::size_t rows, std::size_t columns, std::size_t turn) {
  std::array<float, cropped * cropped> turned{};
  turn_image(sample.first(rows * columns), rows, columns, turn, turned);
  for (std::size_t r = 0; r < cropped; ++r) {
    for (std::size_t c = 0; c < cropped; ++c)
      sample[(r + (rows - cropped) / 2) * columns + c + (columns - cropped) / 2] = turned[r * cropped + c];
  }
}

void check_turnable(const SensorRecord& sensor) {
  const std::vector<std::size_t>& shape = sensor.channels.front().shape;
  const bool image = sensor_kind(sensor.type).view.channel_view(sensor.channels.front().name).image;
  if (!image || shape.size() != 2 || shape[0] < cropped || shape[1] < cropped)
    reject("sensor {}: --turned needs an image of at least {} x {} taxels, such as that of a myrmex", sensor.name, cropped,
           cropped);
}

// Indices of the kept frames, in order: at most `at_most` of each class.
std::vector<std::size_t> kept_frames(const std::vector<std::uint8_t>& labels, std::size_t at_most, RandomStream& random) {
  std::map<std::uint8_t, std::vector<std::size_t>> of_class;
  for (std::size_t t = 0; t < labels.size(); ++t) {
    if (labels[t] != masked) of_class[labels[t]].push_back(t);
  }
  std::vector<std::size_t> kept;
  for (auto& [label, frames] : of_class) {
    for (std::size_t i = 0; i < std::min(at_most, frames.size()); ++i) {
      std::swap(frames[i], frames[i + random.integer(frames.size() - i)]);
      kept.push_back(frames[i]);
    }
  }
  std::ranges::sort(kept);
  return kept;
}

std::size_t count_of_values(const std::vector<std::size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

bool fits(const SensorRecord& sensor, const network::Input& input) {
  if (sensor.type != input.sensor || !network::rate_fits(input, sensor.rate)) return false;
  for (const network::ChannelPick& pick : input.channels) {
    const auto column = std::ranges::find(sensor.channels, pick.name, &SensorColumn::name);
    if (column == sensor.channels.end()) return false;
    const std::size_t size = count_of_values(column->shape);
    if (std::ranges::any_of(pick.values, [&](std::size_t value) { return value >= size; })) return false;
  }
  return true;
}

// Sets the unit of each channel of which `input` does not say it to that of the sensor, so that all
// later sensors must have the same. The units that unit_of_pick() knows remain.
void adopt_units(const SensorRecord& sensor, network::Input& input) {
  for (network::ChannelPick& pick : input.channels) {
    if (pick.unit.empty()) pick.unit = network::unit_of_pick(pick, usual_unit(input.sensor, pick.name));
    if (pick.unit.empty()) pick.unit = std::ranges::find(sensor.channels, pick.name, &SensorColumn::name)->unit;
  }
}

// Describes the required sensor, for errors.
std::string wanted(const network::Input& input) {
  if (input.transform == network::Transform::units)
    return "a sensor with " + input.channels.front().name + " with x, y, z of each unit, at 200 Hz or more";
  std::size_t values = 0;
  for (const network::ChannelPick& pick : input.channels) {
    for (const std::size_t value : pick.values) values = std::max(values, value + 1);
  }
  std::vector<std::string> names;
  for (const network::ChannelPick& pick : input.channels) names.push_back(pick.name);
  return fmt::format("a {} at {} Hz (within 1 %) with {}{}", input.sensor, input.rate, fmt::join(names, ", "),
                     values > 0 ? fmt::format(" of {} or more", counted(values, "value")) : std::string());
}

std::vector<const SensorRecord*> chosen_sensors(const TrialRecord& record, const ExampleOptions& options,
                                                const std::string& subject) {
  std::vector<const SensorRecord*> chosen;
  std::vector<std::string> there;
  for (const SensorRecord& sensor : record.sensors) {
    there.push_back(fmt::format("{} ({} at {} Hz)", sensor.name, sensor.type, sensor.rate));
    if ((options.sensor.empty() || sensor.name == options.sensor) && fits(sensor, options.input)) chosen.push_back(&sensor);
  }
  if (!chosen.empty()) return chosen;
  reject("{}: no sensor{} fits: found {}; expected {}", subject, options.sensor.empty() ? "" : " '" + options.sensor + "'",
         fmt::join(there, ", "), wanted(options.input));
}

// Throws InputError if a dataset has no labels by the rule, before any trial is read.
void check_labels(const std::string& dataset_path, LabelRule rule) {
  const DatasetReader reader = dataset_header_at(dataset_path);
  if (rule != LabelRule::recorded) {
    reader.check_truth(fmt::format("--labels {}", label_rule_name(rule)), "--labels recorded, the labels of the recordings");
  } else if (reader.header().truth.empty()) {
    reject("{}: is simulated, so it has no recorded labels; allowed: --labels {}", dataset_path,
           rules_of_truth(LabelUse::training));
  }
}

}  // namespace

std::vector<network::Class> classes_of(ClassRule classes, LabelRule labels) {
  const PadState slip = about_rule(labels).stored == &LabelRecord::state_micro ? PadState::incipient : PadState::gross;
  switch (classes) {
    case ClassRule::slip: return {{"hold", PadState::non_slip}, {"slip", slip}};
    case ClassRule::kind: return {{"stable", PadState::non_slip}, {"translation", slip}, {"rotation", slip}};
    case ClassRule::direction: {
      std::vector<network::Class> all;
      for (const char* direction : directions) all.push_back({direction, all.empty() ? PadState::non_slip : slip});
      return all;
    }
  }
  return {};
}

namespace {

// Keeps the frames of a network.
class FrameKeeper final : public Detector {
 public:
  FrameKeeper(network::Frames& frames, std::vector<float>& features) : frames_(&frames), features_(&features) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    if (frames_->push(frame.values)) features_->insert(features_->end(), frames_->latest().begin(), frames_->latest().end());
    return estimate_;
  }

 private:
  network::Frames* frames_;
  std::vector<float>* features_;
  SlipEstimate estimate_;
};

// How the samples of a trial become those that a network reads: directly, or, for a range of rates,
// first at a rate drawn from the range, as if the sensor had it, and then as the detector does.
struct TrialRate {
  TrialRate(const network::Input& input, const FrameSource& sensor, std::uint64_t seed, std::size_t trial)
      : source(sensor), slower(sensor), read(input) {
    drawn.rate = kept.rate = sensor.rate;
    if (input.fastest == 0.0) return;
    if (sensor.rate < input.slowest)
      reject("sensor {}: has {} Hz, but the range of rates begins at {} Hz", sensor.sensor, sensor.rate, input.slowest);
    RandomStream random(seed, trial, "rate");
    const double span = math::log(std::min(input.fastest, sensor.rate) / input.slowest);
    drawn = resampling_of(source, input.slowest * math::exp(span * random.uniform()), "the training");
    slower.rate = drawn.rate;
    kept = resampling_of(slower, network::rate_read(input), "the network", input.slowest);
    read = network::at_rate_read(input);
  }

  [[nodiscard]] std::unique_ptr<Detector> wrapped(std::unique_ptr<Detector> reader) const {
    return resampled(resampled(std::move(reader), kept, slower, ""), drawn, source, "");
  }

  FrameSource source, slower;  // the sensor; the same at the drawn rate
  network::Input read;
  Resampling drawn, kept;
};

}  // namespace

Example example_of(const TrialRecord& record, const SensorRecord& sensor, const ExampleOptions& options, std::size_t turn) {
  Example example;
  const SweptFacts facts = swept_facts(record.params);
  example.trial = record.trial;
  example.twin = truth_sha256(sensor.labels);
  example.sensor = sensor.name;
  example.material = facts.material;
  example.object = facts.object;
  example.speed = facts.speed;
  example.mass = facts.mass;
  example.turn = static_cast<std::uint8_t>(turn);
  if (turn != 0) check_turnable(sensor);
  check_evenly_spaced(sensor);
  RecordedSamples samples(sensor);
  const TrialRate rate(options.input, {sensor.name, sensor.type, sensor.rate, samples.channels()}, options.seed, record.trial);
  network::Frames frames(rate.read, sensor.type, rate.kept.rate, samples.channels());
  const std::vector<std::uint8_t> labels = labels_of(record, sensor, options.labels, options.classes);
  const bool whole_unit = about_rule(options.labels).whole_unit;
  const std::vector<std::uint8_t>& truth = whole_unit ? sensor.labels.state : sensor.labels.state_micro;
  const std::vector<double>& onsets = whole_unit ? sensor.labels.onset_time : sensor.labels.micro_onset_time;
  for (const double onset : onsets) example.onset = std::fmin(example.onset, onset);
  example.touches = truth.empty() || std::ranges::any_of(truth, [](std::uint8_t state) { return state != 0; });
  example.holds = !sensor.labels.state_micro.empty() &&
                  std::ranges::all_of(sensor.labels.micro_onset_time, [](double onset) { return std::isnan(onset); }) &&
                  std::ranges::none_of(sensor.labels.state_micro, [](std::uint8_t state) { return slips(state); });
  const std::vector<double> path = slip_path(sensor.labels, sensor.time.size());
  const std::vector<std::uint8_t> scored = path.empty() ? std::vector<std::uint8_t>() : scored_labels(record, sensor, path);
  std::vector<float> sample;
  std::vector<std::size_t> ends;
  std::vector<float> features;
  const std::unique_ptr<Detector> reader = rate.wrapped(std::make_unique<FrameKeeper>(frames, features));
  for (std::size_t row = 0; row < sensor.time.size(); ++row) {
    const SensorFrame taken = samples.take();
    sample.assign(taken.values.begin(), taken.values.end());
    if (turn != 0) turn_taxels(sample, sensor.channels.front().shape[0], sensor.channels.front().shape[1], turn);
    reader->update({taken.time, sample});
    ends.resize(features.size() / frames.size(), row);  // interpolated frames share their last sample
  }
  if (ends.empty()) {
    reject("sensor {}: {}, fewer than a frame of {}", sensor.name, counted(sensor.time.size(), "sample"), options.input.window);
  }
  std::vector<std::uint8_t> all;
  for (const std::size_t row : ends) all.push_back(labels[row]);
  std::vector<std::size_t> kept(ends.size());
  for (std::size_t t = 0; t < kept.size(); ++t) kept[t] = t;
  if (options.at_most > 0) {
    RandomStream random(options.seed, record.trial, "frames");
    kept = kept_frames(all, options.at_most, random);
  }
  for (const std::size_t t : kept) {
    const auto first = features.begin() + static_cast<std::ptrdiff_t>(t * frames.size());
    example.frames.features.insert(example.frames.features.end(), first, first + static_cast<std::ptrdiff_t>(frames.size()));
    example.frames.label.push_back(all[t]);
    example.time.push_back(sensor.time[ends[t]]);
    if (!path.empty()) {
      example.path.push_back(path[ends[t]]);
      example.scored.push_back(scored[ends[t]]);
    }
    if (!truth.empty()) example.truth.push_back(static_cast<PadState>(truth[ends[t]]));
  }
  return example;
}

namespace {

// The first channel of three axes; null if the sensor has none.
const SensorColumn* three_axes(const SensorRecord& sensor) {
  const auto column =
      std::ranges::find_if(sensor.channels, [](const SensorColumn& one) { return !one.shape.empty() && one.shape.back() == 3; });
  return column == sensor.channels.end() ? nullptr : &*column;
}

}  // namespace

UnitsInput units_input(const std::string& dataset_path, const std::string& sensor, const network::Input& input) {
  constexpr double slowest = 200.0;        // Hz, at which a frame spans several samples
  constexpr double floor_of_range = 1e-3;  // such as 1 mN for forces of some N
  const DatasetReader reader = whole_dataset(dataset_path);
  reader.check_recorded(reader.trials().front());
  const TrialRecord record = reader.read_trial(reader.trials().front());
  UnitsInput there{input};
  const auto asked = [&](const SensorRecord& one) {
    return (sensor.empty() || one.name == sensor) && three_axes(one) != nullptr;
  };
  const auto as_recipe = [&](const SensorRecord& one) {
    return asked(one) && three_axes(one)->name == input.channels.front().name && one.rate >= slowest;
  };
  auto found = std::ranges::find_if(record.sensors, as_recipe);
  if (found == record.sensors.end()) found = std::ranges::find_if(record.sensors, asked);
  if (found == record.sensors.end()) return there;
  const SensorColumn& column = *three_axes(*found);
  there.input.sensor = found->type;
  there.input.rate = found->rate;
  there.units = count_of_values(column.shape) / 3;
  network::ChannelPick& pick = there.input.channels.front();
  const std::string unit = network::unit_of_pick(pick, usual_unit(input.sensor, pick.name));
  if (column.name != pick.name || column.unit != unit) {
    pick.name = column.name;
    pick.unit = column.unit;
    double largest = 0.0;
    for (const float value : column.values) largest = std::max(largest, std::abs(static_cast<double>(value)));
    if (largest == 0.0)
      reject("{}: trial {}: channel {} of sensor {} is 0 throughout, so it cannot be scaled; the first trial needs contact",
             dataset_path, record.trial, column.name, found->name);
    there.input.floor = floor_of_range * largest;
  }
  const auto rated = [&](std::size_t& samples, std::size_t least) {
    samples =
        std::max(least, static_cast<std::size_t>(std::lround(static_cast<double>(samples) * there.input.rate / input.rate)));
  };
  rated(there.input.window, 2);  // a change needs two samples
  rated(there.input.stride, 1);
  // Each span must be longer than the one before.
  for (std::size_t k = 0; k < there.input.spans.size(); ++k) rated(there.input.spans[k], k + 2);
  return there;
}

Examples read_examples(std::span<const std::string> dataset_paths, const ExampleOptions& options) {
  for (const std::string& path : dataset_paths) check_labels(path, options.labels);
  Examples all = read_examples(dataset_paths.front(), options);
  ExampleOptions same_units = options;
  same_units.input = all.input;
  // A trial in several datasets could be in both training and evaluation.
  std::map<std::string, std::string> dataset_of;
  for (const Example& example : all.all) dataset_of.emplace(example.sha256, dataset_paths.front());
  std::size_t dataset = 0;
  for (const std::string& path : dataset_paths.subspan(1)) {
    ++dataset;
    Examples more = read_examples(path, same_units);
    if (more.inputs != all.inputs)
      reject("{}: {} per frame, but {} has {}", path, counted(more.inputs, "value"), dataset_paths.front(), all.inputs);
    for (const Example& example : more.all) {
      const auto earlier = dataset_of.find(example.sha256);
      if (earlier != dataset_of.end())
        reject("{}: trial {} is also in {}; give each trial once", path, example.trial, earlier->second);
    }
    for (const Example& example : more.all) dataset_of.emplace(example.sha256, path);
    const std::size_t first = all.all.back().trial + 1;
    for (Example& example : more.all) {
      example.trial += first;
      example.dataset = dataset;
    }
    all.command += "\n" + more.command;
    std::ranges::move(more.sha256, std::back_inserter(all.sha256));
    std::ranges::move(more.all, std::back_inserter(all.all));
  }
  return all;
}

Examples read_examples(const std::string& dataset_path, const ExampleOptions& options) {
  network::Input bare = options.input;
  bare.offset.clear();
  bare.scale.clear();
  ExampleOptions unscaled = options;
  unscaled.input = bare;
  const DatasetReader reader = whole_dataset(dataset_path);
  Examples examples;
  examples.command = reader.header().command;
  examples.sha256 = reader.content_sha256();
  std::map<std::size_t, std::string> part_of = reader.split();
  const ReadingProgress progress = options.read;  // a copy, destroyed on return, even if reading fails
  if (progress) progress(0, reader.trials().size());
  std::size_t read = 0;
  for_each_trial(reader, [&](const TrialRecord& record) {
    const std::string subject = fmt::format("{}: trial {}", reader.files()[reader.file_of(record.trial)], record.trial);
    RandomStream turns(options.seed, record.trial, "turns");
    for (const SensorRecord* sensor : chosen_sensors(record, unscaled, subject)) {
      adopt_units(*sensor, unscaled.input);
      for (std::size_t copy = 0; copy <= options.turned; ++copy) {
        try {
          Example& example =
              examples.all.emplace_back(example_of(record, *sensor, unscaled, copy == 0 ? 0 : 1 + turns.integer(rotations - 1)));
          example.sha256 = trial_identity(reader, record.trial);
          if (!part_of.empty()) example.part = part_of[record.trial];
        } catch (const InputError& error) {
          reject("{}: {}", subject, error.what());
        }
      }
    }
    if (progress) progress(++read, reader.trials().size());
  });
  examples.input = unscaled.input;
  for (const Example& example : examples.all) {
    if (example.frames.label.empty()) continue;
    const std::size_t inputs = example.frames.features.size() / example.frames.label.size();
    if (examples.inputs != 0 && inputs != examples.inputs)
      reject("{}: trial {}: sensor {} gives {} per frame, but the sensors before {}; all need the same number of units",
             dataset_path, example.trial, example.sensor, counted(inputs, "value"), examples.inputs);
    examples.inputs = inputs;
  }
  return examples;
}

SweptFacts swept_facts(const std::string& params) {
  static const std::set<std::string, std::less<>> shape_words{"shape", "size", "radius", "length", "bore"};
  SweptFacts facts;
  const auto add = [](std::string& fact, const std::string& path, const Json& value) {
    fact += fmt::format("{}{}={}", fact.empty() ? "" : " ", path, value.dump());
  };
  const Json swept = Json::parse(params);
  for (const auto& [path, value] : swept.items()) {
    const std::string leaf = path.substr(path.rfind('.') + 1);
    const bool body = path.starts_with("bodies."),
               rubbed = path.starts_with("surface.") || path == "friction.static" || path == "friction.kinetic";
    if (path == "surface.material" || path == "friction.static" || path == "friction.kinetic") add(facts.material, path, value);
    if ((body && shape_words.contains(leaf)) || rubbed || path == "object" || path == "effects" || path == "effects.append" ||
        leaf == "k_tangential" || leaf == "tip_radius")
      add(facts.object, path, value);
    if (path == "motion.speed" && value.is_number()) facts.speed = value.get<double>();
    if ((path == "box.mass" || (body && leaf == "mass")) && value.is_number()) facts.mass = value.get<double>();
  }
  return facts;
}

}  // namespace slipbench::train
