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

PiezoRecording make_recording(const TrialRecord& record) {
  const auto sensor = std::ranges::find(record.sensors, "piezo_skin", &SensorRecord::type);
  if (sensor == record.sensors.end())
    throw InputError(fmt::format("trial {}: has no piezo_skin; allowed: a recording of one", record.trial));
  const Json swept = Json::parse(record.params);
  PiezoRecording recording;
  const auto level = swept.find(level_path);
  recording.level = level != swept.end() && level->is_number() ? level->get<double>() : std::numeric_limits<double>::quiet_NaN();
  recording.tip = tip_of(swept);
  recording.motors_only = std::ranges::all_of(sensor->labels.state, [](std::uint8_t state) { return state == 0; });
  learn::FrameSequence truth = learn::spectral_sequence(*sensor, learn::LabelRule::truth);
  recording.features = std::move(truth.features);
  recording.truth = std::move(truth.slip);
  recording.paper = learn::spectral_sequence(*sensor, learn::LabelRule::paper).slip;
  return recording;
}

void pack(const PiezoRecording& recording, std::string& bytes) {
  append(bytes, std::vector<double>{recording.level, recording.motors_only ? 1.0 : 0.0});
  append(bytes, std::vector<char>(recording.tip.begin(), recording.tip.end()));
  append(bytes, recording.features);
  append(bytes, recording.truth);
  append(bytes, recording.paper);
}

std::vector<PiezoRecording> unpack(const std::string& bytes) {
  std::vector<PiezoRecording> recordings;
  for (Unpacker unpacker(bytes); !unpacker.empty();) {
    PiezoRecording recording;
    const auto numbers = unpacker.take<double>();
    recording.level = numbers.at(0);
    recording.motors_only = numbers.at(1) != 0.0;
    const auto tip = unpacker.take<char>();
    recording.tip.assign(tip.begin(), tip.end());
    recording.features = unpacker.take<float>();
    recording.truth = unpacker.take<std::uint8_t>();
    recording.paper = unpacker.take<std::uint8_t>();
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const ReproduceOptions& options) {
  const std::string swept = fmt::format("[{}]", fmt::join(levels, ", "));
  const GridCell cell{.name = "recordings",
                      .scene = piezo_bench_scene,
                      .overrides = {{std::string("sweep.") + level_path, swept}},
                      .draws = recordings / 2};
  return run_grid<PiezoRecording>({cell}, options, [](const GridTrial& trial) { return make_recording(trial.record()); }).front();
}

std::vector<PiezoRecording> read_recordings(const std::string& path) {
  return unpack(guarded(path, [&] {
    const DatasetReader reader(path);
    ContentCheck check(reader);
    std::string bytes;
    for (const std::size_t trial : reader.trials()) {
      reader.check_recorded(trial);
      const TrialRecord record = reader.read_trial(trial);
      check.add(record.trial);
      pack(make_recording(record), bytes);
    }
    check.finish();
    return bytes;
  }));
}

}  // namespace slipbench::reproduce
