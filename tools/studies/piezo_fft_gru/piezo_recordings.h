// Recordings of the piezoelectric skin's bench as networks learn from them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/scene/parser.h"
#include "tools/base/project/project_file.h"
#include "tools/base/workers/interrupt.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/learn/frames.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

inline constexpr const char* piezo_bench_scene = "scenes/piezo_skin/dataset.yaml";

// Refuses a number of recordings a level that is odd or below `least`, in words that end with why it has to be that.
void check_recordings(std::size_t recordings, std::size_t least, const std::string& why);

// Runs the published bench, scenes/piezo_skin/dataset.yaml with `overrides`, each trial's scene changed by `change` (may be empty): of each cell
// of its sweep half of `recordings`, an even number, so that half of them slip and half are of motors alone. What `reduce` makes of the scene, the full
// record and what was swept (a JSON object), in order. Throws InputError, Interrupted.
template <class Outcome, class Reduce>
std::vector<Outcome> run_piezo_bench(const std::vector<Override>& overrides, const std::function<void(Scene&)>& change,
                                     std::size_t recordings, const ReproduceOptions& options, const std::string& what,
                                     Reduce&& reduce) {
  const InterruptGuard guard("ending after the recordings at hand");
  const Catalogues catalogues = program_catalogues();
  SceneFile file = SceneFile::load(project_file(piezo_bench_scene));
  for (const Override& override : overrides) file.apply(override);
  const std::uint64_t seed = options.seed.value_or(1);
  const TrialPlan plan(file, catalogues, std::max<std::size_t>(1, recordings / 2), seed);
  const auto one = [&](std::size_t index) {
    TrialPlan::Trial trial = plan.trial(index);
    trial.scene.seed = seed;
    if (change) change(trial.scene);
    Json params = Json::object();
    for (const auto& [path, value] : trial.drawn) params[path] = Json::parse(value);
    return reduce(trial.scene, run_trial(trial.scene, index, Recording::full).record, params);
  };
  const std::size_t threads = options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
  OrderedWorkers<Outcome> workers(
      plan.size(), std::min(threads, plan.size()), [&] { return one; }, &InterruptGuard::flag());
  std::vector<Outcome> all;
  while (all.size() < plan.size()) {
    if (options.say && all.size() % 100 == 0) options.say(fmt::format("{} ({} of {} done)", what, all.size(), plan.size()));
    std::optional<Outcome> outcome = workers.next();
    if (!outcome) throw Interrupted();
    all.push_back(std::move(*outcome));
  }
  return all;
}

// A recording, its signal already turned into frames.
struct PiezoRecording {
  double level = 0.0;                      // of the motors' vibration; NaN: the dataset does not say
  std::string tip;                         // what was swept but the motion; equal texts are equal tips
  bool motors_only = true;                 // nothing ever touches
  std::vector<float> features;             // [T,12] log_spectrogram
  std::vector<std::uint8_t> truth, paper;  // [T] 1: slip, by either label

  [[nodiscard]] learn::FrameSequence frames(learn::LabelRule rule) const {
    return {features, rule == learn::LabelRule::truth ? truth : paper};
  }
};

// Runs the published bench, scenes/piezo_skin/dataset.yaml, at each level: `recordings` of them, half with a slip and half of motors alone.
// Throws InputError, Interrupted.
std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const ReproduceOptions& options);

// The same from a dataset, whose levels are those that it swept. Throws InputError.
std::vector<PiezoRecording> read_recordings(const std::string& path);

// What a recording is for those above. `params`: JSON object of what was swept. Throws InputError when no sensor is a piezo_skin.
PiezoRecording make_recording(const TrialRecord& record, const std::string& params);

// A recording as bytes, and back, for a child process to hand over.
void pack(const PiezoRecording& recording, std::string& bytes);
std::vector<PiezoRecording> unpack(const std::string& bytes);

}  // namespace slipbench::reproduce
