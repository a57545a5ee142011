#include "tools/program/sweep/named_files.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "tools/base/record/encoder.h"

namespace slipbench {
namespace {

void add_paths(const std::vector<Entry>& entries, const std::string& name, const Parameters& parameters,
               std::set<std::string>& paths) {
  const auto entry = std::ranges::find(entries, name, &Entry::name);
  if (entry == entries.end()) return;
  for (const ParameterSpec& spec : entry->parameters) {
    if (spec.type != ParameterType::path) continue;
    if (const std::string& path = parameters.path(spec.name); path != spec.default_text) paths.insert(path);
  }
}

}  // namespace

void add_named_files(const Scene& scene, const Catalogues& catalogues, std::set<std::string>& paths) {
  if (!scene.model.empty()) paths.insert(scene.model);
  for (const SensorScene& sensor : scene.sensors) add_paths(catalogues.sensors, sensor.type, sensor.parameters, paths);
  if (scene.detector) add_paths(catalogues.detectors, scene.detector->type, scene.detector->parameters, paths);
  if (scene.controller) add_paths(catalogues.controllers, scene.controller->name, scene.controller->parameters, paths);
}

std::map<std::string, std::string> digests_of(const std::set<std::string>& paths) {
  std::map<std::string, std::string> digests;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      digests[path] = file_sha256(path);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.is_regular_file()) digests[entry.path().string()] = file_sha256(entry.path().string());
    }
  }
  return digests;
}

}  // namespace slipbench
