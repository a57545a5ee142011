#include "tools/benchmark/entrants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "detectors/detector_kinds.h"
#include "detectors/hd/memory_files.h"
#include "detectors/network/engine.h"
#include "sim/core/math.h"
#include "tools/dataset/record/encoder.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/replay.h"
#include "tools/eval/shipped_networks.h"
#include "tools/eval/yardsticks.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::benchmark {
namespace {

namespace fs = std::filesystem;

constexpr const char* no_engine = "OpenVINO, which runs networks, is missing; see slipbench doctor";

std::string file_digest(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return file_sha256(path);
  std::vector<std::string> files;
  const fs::directory_iterator entries(path, error);
  if (error) reject("{}: cannot be read: {}", path, error.message());
  for (const fs::directory_entry& entry : entries) {
    if (entry.is_regular_file(error)) files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  std::string text;
  for (const std::string& file : files) text += fs::path(file).filename().string() + " " + file_sha256(file) + "\n";
  return text_sha256(text);
}

}  // namespace

std::string file_of(const DetectorScene& detector) {
  const DetectorKind* const kind = detector_kind(detector.type);
  if (kind == nullptr || !kind->file) return "";
  const std::string& path = detector.parameters.path(kind->file->parameter);
  return kind->file->content == DetectorFile::Content::memories ? hd::memories_folder(path) : path;
}

std::string kind_word(Kind kind) {
  constexpr std::array words{"shipped", "given", "yardstick", "control", "known signal", "oracle"};
  return words.at(static_cast<std::size_t>(kind));
}

Entrant given_entrant(const std::string& word, const std::vector<Override>& parameters) {
  Entrant entrant{.name = word, .kind = Kind::given, .detector = eval::chosen_detector(word, parameters)};
  std::string identity = entrant.detector.type;
  for (const Override& change : parameters) {
    entrant.parameters[change.path] = change.value;
    identity += "\n" + change.path + "=" + change.value;
  }
  entrant.sha256_seen = eval::seen_trials(entrant.detector, eval::training_of(entrant.detector));
  if (const std::string file = file_of(entrant.detector); !file.empty()) identity += "\n" + file_digest(file);
  entrant.sha256 = text_sha256(identity);
  return entrant;
}

std::vector<Entrant> shipped_entrants() {
  std::vector<Entrant> entrants;
  const auto add = [&entrants](const std::string& word, const std::string& name, const std::string& reads = "") {
    Entrant entrant = given_entrant(word, {});
    entrant.name = name;
    entrant.kind = Kind::shipped;
    entrant.reads = reads;
    entrants.push_back(std::move(entrant));
  };
  for (const Entry& entry : detector_entries()) {
    const DetectorKind* const kind = detector_kind(entry.name);
    const bool needs_file = kind != nullptr && kind->file && kind->file->is_required;
    const bool is_yardstick = kind != nullptr && kind->yardstick;
    if (!needs_file && !is_yardstick && entry.name != oracle_type) add(entry.name, entry.name);
  }
  add("learn_gst_hd", "gst_hd, learn_gst_hd");
  if (network::engine_available()) {
    for (const eval::ShippedNetwork& network : eval::shipped_networks)
      add(project_file(network.path), network.name, network.sensor);
  }
  return entrants;
}

std::vector<Entrant> yardstick_entrants() {
  std::vector<Entrant> entrants;
  for (const DetectorScene& detector : eval::yardsticks()) {
    entrants.push_back(given_entrant(detector.type, {}));
    entrants.back().kind = Kind::yardstick;
    entrants.back().chooses_threshold = true;
  }
  return entrants;
}

std::vector<double> threshold_factors() {
  constexpr int decades_above = 4, decades_below = 8, steps = 4;
  std::vector<double> factors;
  for (int k = steps * decades_above; k >= -steps * decades_below; --k)
    factors.push_back(math::exp(std::numbers::ln10 * k / steps));
  return factors;
}

Entrant with_threshold(const Entrant& yardstick, double threshold) {
  Entrant set = yardstick;
  set.detector = eval::with_yardstick_threshold(yardstick.detector, threshold);
  set.parameters[eval::yardstick_threshold] = fmt::format("{:.4g}", threshold);
  set.chooses_threshold = false;
  return set;
}

std::vector<Missing> missing_entrants() {
  std::vector<Missing> missing;
  if (network::engine_available()) return missing;
  for (const eval::ShippedNetwork& network : eval::shipped_networks) missing.push_back({network.name, network.sensor, no_engine});
  return missing;
}

std::vector<Entrant> control_entrants() {
  const auto control = [](const char* name, const Control& reports) {
    return Entrant{.name = name, .kind = Kind::control, .control = reports, .sha256 = text_sha256(name)};
  };
  Entrant informed = control("motion known", {});
  informed.knows_motion = true;
  return {control("always slip", {.from = 0.0}), control(never_slip, {}), std::move(informed)};
}

Entrant oracle_entrant() {
  Entrant oracle{.name = "oracle", .kind = Kind::oracle, .sha256 = text_sha256("oracle")};
  oracle.detector.type = oracle_type;
  for (const Entry& entry : detector_entries()) {
    if (entry.name == oracle_type) oracle.detector.parameters = defaults_of(entry.parameters);
  }
  return oracle;
}

Entrant known_signal_entrant() {
  return {.name = "signal known", .kind = Kind::known_signal, .sha256 = text_sha256("signal known")};
}

}  // namespace slipbench::benchmark
