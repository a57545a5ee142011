#include "tools/studies/piezo_fft_gru/piezo_recordings.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "tools/base/dataset/content_check.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/reader.h"
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

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

// Takes values off the front of bytes that append() wrote.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : left_(bytes) {}
  [[nodiscard]] bool empty() const { return left_.empty(); }
  template <class T>
  std::vector<T> take() {
    std::uint64_t count = 0;
    std::memcpy(&count, left_.data(), sizeof count);
    left_.remove_prefix(sizeof count);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), left_.data(), count * sizeof(T));
    left_.remove_prefix(count * sizeof(T));
    return values;
  }

 private:
  std::string_view left_;
};

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

void pack(const PiezoRecording& recording, std::string& bytes) {
  append(bytes, std::vector<double>{recording.level, recording.motors_only ? 1.0 : 0.0, recording.slip_time, recording.label_time,
                                    static_cast<double>(recording.inputs.size())});
  append(bytes, std::vector<char>(recording.tip.begin(), recording.tip.end()));
  for (const PiezoFrames& frames : recording.inputs) {
    append(bytes, frames.features);
    append(bytes, frames.truth);
    append(bytes, frames.paper);
  }
  append(bytes, recording.time);
  append(bytes, recording.contact);
  append(bytes, recording.motors);
}

std::vector<PiezoRecording> unpack(const std::string& bytes) {
  std::vector<PiezoRecording> recordings;
  for (Unpacker unpacker(bytes); !unpacker.empty();) {
    PiezoRecording recording;
    const auto numbers = unpacker.take<double>();
    recording.level = numbers.at(0);
    recording.motors_only = numbers.at(1) != 0.0;
    recording.slip_time = numbers.at(2);
    recording.label_time = numbers.at(3);
    const auto tip = unpacker.take<char>();
    recording.tip.assign(tip.begin(), tip.end());
    recording.inputs.resize(static_cast<std::size_t>(numbers.at(4)));
    for (PiezoFrames& frames : recording.inputs) {
      frames.features = unpacker.take<float>();
      frames.truth = unpacker.take<std::uint8_t>();
      frames.paper = unpacker.take<std::uint8_t>();
    }
    recording.time = unpacker.take<double>();
    recording.contact = unpacker.take<std::uint8_t>();
    recording.motors = unpacker.take<float>();
    recordings.push_back(std::move(recording));
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
  return unpack(guarded(path, [&] {
    const DatasetReader reader(path);
    ContentCheck check(reader);
    std::string bytes;
    for (const std::size_t trial : reader.trials()) {
      reader.check_recorded(trial);
      const TrialRecord record = reader.read_trial(trial);
      check.add(record.trial);
      pack(make_recording(record, inputs), bytes);
    }
    check.finish();
    return bytes;
  }));
}

}  // namespace slipbench::reproduce
