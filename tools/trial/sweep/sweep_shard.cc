#include "tools/trial/sweep/sweep_shard.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/core/random.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/reject.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

constexpr std::size_t most_estimated = 10'000;  // cells

// True if a swept value can change the cost of a trial.
bool costs(std::string_view path) {
  const std::string_view section = path.substr(0, path.find('.'));
  return section == "duration" || section == "time_step" || section == "fidelity" || section == "sensors";
}

// Ticks times elements, after the kind of fidelity: an articulated element takes some hundred times
// as long as one of a field.
std::pair<bool, double> cost_of(const Scene& scene, std::size_t trial) {
  constexpr double usual_step = 1e-3;  // s, assumed if the scene sets no step
  std::size_t elements = 0;
  for (const SensorScene& sensor : scene.sensors) elements += make_sensor(sensor, scene.seed, trial)->layout().elements.size();
  return {scene.fidelity != "field", scene.duration / scene.time_step.value_or(usual_step) * static_cast<double>(elements)};
}

void add_paths(const std::vector<Entry>& entries, const std::string& name, const Parameters& parameters,
               std::set<std::string>& paths) {
  const auto entry = std::ranges::find(entries, name, &Entry::name);
  if (entry == entries.end()) return;
  for (const ParameterSpec& spec : entry->parameters) {
    if (spec.type == ParameterType::table && !parameters.table(spec.name).path.empty())
      paths.insert(parameters.table(spec.name).path);
    if (spec.type != ParameterType::path) continue;
    const std::string& path = parameters.path(spec.name);
    if (path != spec.default_text && std::ranges::find(spec.choices, path) == spec.choices.end()) paths.insert(path);
  }
}

}  // namespace

std::vector<std::size_t> trials_of_shard(const TrialPlan& plan, std::size_t trials, std::uint64_t seed, std::size_t number,
                                         std::size_t count) {
  if (count > trials) {
    reject("--shard is {}/{}, but the sweep has only {} trial{}", number, count, trials, trials == 1 ? "" : "s");
  }
  std::vector<std::size_t> order = shuffled(trials, RandomStream(seed, 0, "shard"));
  const auto drawn = plan.trial(0).drawn;
  const std::size_t cells = (trials + plan.draws() - 1) / plan.draws();
  if (cells <= most_estimated && std::ranges::any_of(drawn, [](const auto& swept) { return costs(swept.first); })) {
    std::vector<std::pair<bool, double>> cost;
    for (std::size_t cell = 0; cell < cells; ++cell)
      cost.push_back(cost_of(plan.trial(cell * plan.draws()).scene, cell * plan.draws()));
    std::ranges::stable_sort(order,
                             [&](std::size_t a, std::size_t b) { return cost[a / plan.draws()] > cost[b / plan.draws()]; });
  }
  std::vector<std::size_t> mine;
  for (std::size_t i = number - 1; i < order.size(); i += count) mine.push_back(order[i]);
  std::ranges::sort(mine);
  return mine;
}

void add_named_files(const Scene& scene, const Catalogues& catalogues, std::set<std::string>& paths) {
  if (!scene.model.empty()) paths.insert(scene.model);
  for (const SensorScene& sensor : scene.sensors) add_paths(catalogues.sensors, sensor.type, sensor.parameters, paths);
  if (scene.detector) add_paths(catalogues.detectors, scene.detector->type, scene.detector->parameters, paths);
  if (scene.controller) add_paths(catalogues.controllers, scene.controller->name, scene.controller->parameters, paths);
}

HeldFiles::Stamp HeldFiles::stamp_of(const std::string& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return {};
  const auto time = [](const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; };
  return {static_cast<std::int64_t>(found.st_dev), static_cast<std::int64_t>(found.st_ino), std::int64_t{found.st_size},
          time(found.st_mtim), time(found.st_ctim)};
}

HeldFiles::HeldFiles(const std::set<std::string>& paths) {
  const auto hold = [this](const std::string& path) {
    stamps_[path] = stamp_of(path);  // before reading: later changes are detected
    digests_[path] = file_sha256(path);
  };
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      hold(path);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.is_regular_file()) hold(entry.path().string());
    }
  }
}

void HeldFiles::check() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& [path, stamp] : stamps_) {
    const Stamp now = stamp_of(path);  // before reading
    if (now == stamp) continue;
    std::error_code gone;
    if (std::filesystem::exists(path, gone) && file_sha256(path) == digests_.at(path)) {
      stamp = now;
      continue;
    }
    throw InputError(path + " has changed during the run; do not change the files of a scene until the run ends");
  }
}

}  // namespace slipbench
