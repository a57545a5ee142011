#include "tools/program/samples/commanded_motion.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/motion/motion.h"
#include "sim/scene/parser.h"
#include "tools/base/record/json.h"

namespace slipbench {
namespace {

Json object_of(const std::string& text, const std::string& subject) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw InputError(subject + " is not a JSON object");
  return json;
}

// The scene as it was run, but for what was swept.
SceneFile scene_of(const DatasetReader& reader) {
  const std::string file = reader.files().front();
  SceneFile scene = SceneFile::from_text(reader.header().scene, file + ": scene");
  if (scene.root().kind != YamlNode::Kind::map) throw InputError(file + ": attribute scene is not a scene");
  const Json overrides = object_of(reader.header().overrides, file + ": attribute overrides");
  for (const auto& [path, value] : overrides.items()) {
    if (!value.is_string()) throw InputError(file + ": attribute overrides holds no text for " + path);
    scene.apply({path, value.get<std::string>()});
  }
  return scene;
}

const Entry& motion_of(const YamlNode& root, const std::string& file) {
  const YamlNode* kind = node_at(root, std::vector<std::string>{"motion", "kind"});
  const std::string name = kind != nullptr ? kind->text : "stage";
  for (const MotionKind& candidate : motion_catalogue()) {
    if (candidate.about.name == name) return candidate.about;
  }
  throw InputError(fmt::format("{}: attribute scene has the motion '{}', which this program does not know", file, name));
}

// What one trial was told: swept values before written ones.
class Commanded {
 public:
  Commanded(const DatasetReader& reader, std::size_t trial)
      : file_(reader.files()[reader.file_of(trial)]),
        swept_(object_of(reader.info(trial).params, fmt::format("{}: trial {}: attribute params", file_, trial))),
        scene_(scene_of(reader)) {}

  // Empty where the motion has no such number.
  [[nodiscard]] std::optional<double> number(const std::string& name) const {
    const Entry& motion = motion_of(scene_.root(), file_);
    const auto spec = std::ranges::find(motion.parameters, name, &ParameterSpec::name);
    if (spec == motion.parameters.end() || spec->type != ParameterType::number) return std::nullopt;
    if (const auto found = swept_.find("motion." + name); found != swept_.end() && found->is_number())
      return found->get<double>();
    const YamlNode* written = node_at(scene_.root(), std::vector<std::string>{"motion", name});
    if (written == nullptr) return std::get<double>(default_of(*spec));
    try {
      return std::get<double>(parse_scalar(*spec, written->text));
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: motion.{}: {}", written->origin.text(), name, error.what()));
    }
  }

  [[nodiscard]] double needed(const std::string& name) const {
    if (const auto found = number(name)) return *found;
    throw InputError(
        fmt::format("{}: its motion '{}' has no {}; allowed: a dataset whose pad is pressed and slides, such as that of a stage",
                    file_, motion_of(scene_.root(), file_).name, name));
  }

  [[nodiscard]] std::string word(const std::string& path) const {
    if (const auto found = swept_.find(path); found != swept_.end() && found->is_string()) return found->get<std::string>();
    const YamlNode* written = node_at(scene_.root(), split_path(path, scene_.root().origin));
    return written != nullptr && written->kind == YamlNode::Kind::scalar ? written->text : "";
  }

 private:
  std::string file_;
  Json swept_;
  SceneFile scene_;
};

}  // namespace

CommandedMotion commanded_motion(const DatasetReader& reader, std::size_t trial) {
  const Commanded told(reader, trial);
  return {told.needed("speed"), told.needed("rotation"), told.needed("compression")};
}

std::optional<double> commanded_number(const DatasetReader& reader, std::size_t trial, const std::string& name) {
  return Commanded(reader, trial).number(name);
}

std::string commanded_word(const DatasetReader& reader, std::size_t trial, const std::string& path) {
  return Commanded(reader, trial).word(path);
}

}  // namespace slipbench
