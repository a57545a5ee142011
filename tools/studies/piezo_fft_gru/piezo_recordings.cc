#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/spectral/spectral_features.h"
#include "sim/core/error.h"
#include "sim/core/pad_state.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::reproduce {
namespace {

constexpr const char* level_path = "motion.vibration";

// A tip is its friction, stiffness, shape and effects: all that the sweep varies but the motion.
std::string tip_of(const Json& swept) {
  std::string tip;
  for (const auto& [path, value] : swept.items()) {
    if (!path.starts_with("motion.")) tip += fmt::format("{}{}={}", tip.empty() ? "" : " ", path, value.dump());
  }
  return tip;
}

// NaN: was not swept, or is no number.
double swept_number(const Json& swept, const char* path) {
  const auto found = swept.find(path);
  return found != swept.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

bool slips(std::uint8_t state) { return static_cast<PadState>(state) >= PadState::incipient; }

// Sum of the speeds along the axes of what moves at time t [m/s].
double bench_speed(const TrialRecord& record, double t) {
  const auto row = std::ranges::upper_bound(record.body_time, t) - record.body_time.begin() - 1;
  double speed = 0.0;
  if (row < 0) return speed;
  for (const BodyRecord& body : record.bodies) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      speed += std::abs(double{body.velocity[6 * static_cast<std::size_t>(row) + axis]});
  }
  return speed;
}

// The one list of what goes through the pipe.
template <class RecordingOrConst, class Do>
void with_members(RecordingOrConst& recording, Do&& use) {
  use(recording.level, recording.motors_only, recording.slip_time, recording.label_time, recording.tip, recording.time,
      recording.contact, recording.motors);
  for (auto& frames : recording.inputs) use(frames.features, frames.truth, frames.paper);
}

constexpr double still_speed = 1e-9;  // m/s, below which the bench stands

// The straight line of least squares through `values` taken off.
std::vector<float> without_trend(std::span<const float> values) {
  const double middle = 0.5 * static_cast<double>(values.size() - 1);
  double mean = 0.0, slope = 0.0, square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    mean += static_cast<double>(values[i]) / static_cast<double>(values.size());
    slope += t * static_cast<double>(values[i]);
    square += t * t;
  }
  slope /= square;
  std::vector<float> left;
  for (std::size_t i = 0; i < values.size(); ++i) {
    left.push_back(static_cast<float>(static_cast<double>(values[i]) - mean - slope * (static_cast<double>(i) - middle)));
  }
  return left;
}

// Power in the band of one frame at a time.
class BandPower {
 public:
  explicit BandPower(bool hann) : features_(layout(hann)) {}

  double operator()(std::span<const float> frame) {
    for (const float value : frame) features_.push(value);
    double power = 0.0;
    for (const double density : features_.density()) power += density * features_.bin_width();
    return power;
  }

 private:
  static SpectralLayout layout(bool hann) {
    SpectralLayout one;
    one.hop = one.window;  // no sample is in two frames
    one.hann = hann;
    return one;
  }
  SpectralFeatures features_;
};

// Speed of whatever moves at a sample: along the normal, and along the surface.
struct BenchSpeed {
  double normal = 0.0, sideways = 0.0;
};
BenchSpeed speed_at(const TrialRecord& record, std::size_t sample) {
  BenchSpeed speed;
  for (const BodyRecord& body : record.bodies) {
    const float* v = &body.velocity[6 * sample];
    speed.normal = std::max(speed.normal, std::abs(double{v[2]}));
    speed.sideways = std::max(speed.sideways, std::hypot(double{v[0]}, double{v[1]}));
  }
  return speed;
}

bool slip_state(std::uint8_t state) { return static_cast<PadState>(state) >= PadState::incipient; }

}  // namespace

void check_recordings(std::size_t recordings, std::size_t least, const std::string& why) {
  if (recordings >= least && recordings % 2 == 0) return;
  throw InputError(fmt::format(
      "reproduce: --trials {}: half of the recordings of a level have contact, and {}; allowed: even numbers, {} or more",
      recordings, why, least));
}

network::Input published_spectra() { return train::find_recipe("piezo_fft_gru").input; }

network::Input spectra_of(double low, double high) {
  network::Input input = published_spectra();
  input.low = low;
  input.high = high;
  return input;
}

network::Input signal_at_100_hz() { return train::find_recipe("piezo_raw_gru").input; }

PiezoRecording make_recording(const TrialRecord& record, const std::vector<network::Input>& inputs) {
  const auto sensor = std::ranges::find(record.sensors, "piezo_skin", &SensorRecord::type);
  if (sensor == record.sensors.end())
    throw InputError(fmt::format("trial {}: has no piezo_skin; allowed: a recording of one", record.trial));
  const Json swept = Json::parse(record.params);
  PiezoRecording recording;
  recording.level = swept_number(swept, level_path);
  recording.tip = tip_of(swept);
  recording.motors_only = std::ranges::all_of(sensor->labels.state, [](std::uint8_t state) { return state == 0; });
  const auto labelled = std::ranges::find_if(sensor->labels.state_paper, slips);
  if (labelled != sensor->labels.state_paper.end())
    recording.label_time = sensor->time[static_cast<std::size_t>(labelled - sensor->labels.state_paper.begin())];
  for (const network::Input& input : inputs) {
    const auto example_by = [&](train::LabelRule rule) {
      train::ExampleOptions how;
      how.input = input;
      how.labels = rule;
      return train::example_of(record, *sensor, how);
    };
    train::Example truth = example_by(train::LabelRule::micro);
    recording.inputs.push_back(
        {std::move(truth.frames.features), std::move(truth.frames.label), example_by(train::LabelRule::paper).frames.label});
    if (recording.inputs.size() > 1) continue;
    recording.slip_time = truth.onset;
    recording.time = truth.time;
    for (const PadState state : truth.truth) recording.contact.push_back(state != PadState::no_contact ? 1 : 0);
    const double idle_speed = swept_number(swept, "motion.idle_speed"), idle_start = swept_number(swept, "motion.idle_start");
    for (const double t : truth.time)
      recording.motors.push_back(static_cast<float>(bench_speed(record, t) + (t >= idle_start ? idle_speed : 0.0)));
  }
  return recording;
}

std::vector<float> told_features(const PiezoRecording& recording, const Told& told) {
  std::vector<float> features;
  for (std::size_t k = 0; k < recording.time.size(); ++k) {
    if (told.time) features.push_back(static_cast<float>(recording.time[k]));
    if (told.contact) features.push_back(recording.contact[k]);
    if (told.motors) features.push_back(recording.motors[k]);
    if (told.kind) features.push_back(recording.motors_only ? 1.0F : 0.0F);
  }
  return features;
}

void pack(const PiezoRecording& recording, Packed& bytes) {
  bytes.put(recording.inputs.size());
  with_members(recording, [&](const auto&... members) { bytes.put(members...); });
}

std::vector<PiezoRecording> unpack(Packed bytes) {
  std::vector<PiezoRecording> recordings;
  while (!bytes.at_end()) {
    PiezoRecording& recording = recordings.emplace_back();
    recording.inputs.resize(bytes.take<std::size_t>());
    with_members(recording, [&](auto&... members) { bytes.take(members...); });
  }
  return recordings;
}

std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const std::vector<network::Input>& inputs, const ReproduceOptions& options,
                                           Motors motors) {
  const std::string swept = fmt::format("[{}]", fmt::join(levels, ", "));
  GridCell cell{.name = "recordings",
                .scene = piezo_bench_scene,
                .overrides = {{std::string("sweep.") + level_path, swept}},
                .draws = recordings / 2};
  if (motors == Motors::of_the_tip) {
    cell.name += ", no motor but the tip's";
    cell.overrides.push_back({"sweep.motion.idle_speed", "[0 mm/s]"});
  }
  return run_grid<PiezoRecording>({cell}, options, [&](const GridTrial& trial) { return make_recording(trial.record(), inputs); })
      .front();
}

std::vector<PiezoRecording> read_recordings(const std::string& path, const std::vector<network::Input>& inputs) {
  return unpack(
      packed_trials(path, [&](const TrialRecord& record, Packed& bytes) { pack(make_recording(record, inputs), bytes); }));
}

SkinRecording skin_recording(const Scene& scene, const TrialRecord& record) {
  SkinRecording recording{scene.sensors.front().parameters.number("k_normal") * scene.motion.parameters.number("compression"),
                          scene.motion.parameters.number("speed"),
                          {}};
  const SensorRecord& sensor = record.sensors.front();
  const std::vector<std::uint8_t>& states = sensor.labels.state_micro;
  const std::vector<float>& signal = sensor.channels.front().values;
  std::vector<BenchSpeed> speeds;
  for (std::size_t i = 0; i < signal.size(); ++i) speeds.push_back(speed_at(record, i));

  const SpectralLayout layout;
  BandPower plain(false), hann(true);
  double moved = -std::numeric_limits<double>::infinity();
  std::size_t looked_at = 0;  // samples whose motion `moved` knows
  for (std::size_t end = layout.window; end <= signal.size(); end += layout.hop) {
    const std::size_t first = end - layout.window, last = end - 1;
    const std::span<const float> values = std::span(signal).subspan(first, layout.window);
    SkinFrame frame;
    frame.power = {plain(values), plain(without_trend(values)), hann(values)};
    frame.contact = static_cast<PadState>(states[last]) != PadState::no_contact;
    frame.slips = slip_state(states[last]);
    frame.slips_by_position = slip_state(sensor.labels.state_paper[last]);
    frame.at_speed = speeds[last].sideways >= 0.9 * recording.speed;
    frame.one_label = true;
    for (std::size_t i = first; i <= last; ++i) {
      const bool touches = static_cast<PadState>(states[i]) != PadState::no_contact;
      frame.one_label = frame.one_label && touches == frame.contact && slip_state(states[i]) == frame.slips;
      frame.slipped = frame.slipped || slip_state(states[i]);
      frame.pressed = frame.pressed || speeds[i].normal > still_speed;
      frame.slid = frame.slid || speeds[i].sideways > still_speed;
    }
    for (; looked_at < end; ++looked_at) {
      if (std::max(speeds[looked_at].normal, speeds[looked_at].sideways) > still_speed) moved = sensor.time[looked_at];
    }
    frame.still = sensor.time[last] - moved;
    recording.frames.push_back(frame);
  }
  return recording;
}

}  // namespace slipbench::reproduce
