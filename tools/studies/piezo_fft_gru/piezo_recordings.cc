#include "tools/studies/piezo_fft_gru/piezo_recordings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "tools/program/train/recipes/recipe.h"
#include "tools/studies/grid.h"

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

}  // namespace slipbench::reproduce
