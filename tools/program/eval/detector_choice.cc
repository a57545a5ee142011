#include "tools/program/eval/detector_choice.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "detectors/detector_kinds.h"
#include "detectors/hd/memory_files.h"
#include "sim/core/detector.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::eval {
namespace {

// The smallest scene that has a detector. Its sensor is not that of the dataset, with which make_detector() deals.
constexpr const char* scene_around = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

// A text as YAML, whatever stands in it.
std::string yaml_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("''") : std::string(1, c);
  return word + "'";
}

// The detector's type, and the parameter that `text` stands for, where it is no name.
std::pair<std::string, std::vector<Override>> type_of(const std::string& text) {
  std::vector<std::string> names;
  for (const Entry& entry : detector_entries()) {
    if (entry.name != oracle_type) names.push_back(entry.name);
  }
  const std::string allowed = allowed_names(text, names) + ", FILE.onnx, or a folder of memories";
  if (text == oracle_type)
    throw InputError("eval: " + quote(text) + " is the oracle, which reads the simulation and no recording" + allowed);
  if (std::ranges::find(names, text) != names.end()) return {text, {}};
  if (text.ends_with(".onnx")) return {"network", {{"detector.model", yaml_word(text)}}};
  std::error_code error;
  if (text == hd::default_memories) return {"gst_hd", {}};
  if (std::filesystem::is_directory(text, error)) return {"gst_hd", {{"detector.memories", yaml_word(text)}}};
  throw InputError("eval: no detector " + quote(text) + allowed);
}

}  // namespace

DetectorScene chosen_detector(const std::string& text, const std::vector<Override>& parameters) {
  const auto [type, own] = type_of(text);
  SceneFile scene = SceneFile::from_text(scene_around, "eval");
  scene.apply({"detector.type", type});
  for (const Override& change : own) scene.apply(change);
  for (const Override& change : parameters) scene.apply({"detector." + change.path, change.value});
  return parse_scene(scene, program_catalogues()).detector.value();
}

std::unique_ptr<network::Engine> network_of(const DetectorScene& detector) {
  if (detector.type != "network") return nullptr;
  const std::string& model = detector.parameters.path("model");
  if (model == no_network)
    throw InputError("eval: no network is named; allowed: FILE.onnx in place of 'network', or the parameter model=FILE.onnx");
  return network::load_engine(model);
}

}  // namespace slipbench::eval
