#include "tools/program/report/report_parts.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/grasp/grasp.h"
#include "sim/motion/motion.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene_values.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::report {
namespace {

// As a scene writes it, on one line.
std::string text_of(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::sequence) return node.text;
  std::string text;
  for (const YamlNode& item : node.children) text += (text.empty() ? "" : ", ") + text_of(item);
  return "[" + text + "]";
}

bool is_assumed(const std::string& source) { return source.find("assumed") != std::string::npos; }

class ParameterRows {
 public:
  ParameterRows(const YamlNode& root, const Json& swept) : root_(root), swept_(swept) {
    const YamlNode* named = at({"grip", "protocol"});
    const std::string name = named == nullptr ? "as_recorded" : named->text;
    const auto found = std::ranges::find(protocol_catalogue(), name, &Protocol::name);
    if (found != protocol_catalogue().end() && !swept.contains("grip.protocol")) protocol_ = &*found;
  }

  // `path`: of the map that holds the entry's parameters.
  void add(const std::vector<std::string>& path, const Entry& entry) {
    for (const ParameterSpec& spec : entry.parameters) add(path, spec);
  }
  void add(std::vector<std::string> path, const ParameterSpec& spec) {
    path.push_back(spec.name);
    add(fmt::format("{}", fmt::join(path, ".")), at(path), spec.default_text, spec.doc, spec.source);
  }

  // The entry that `path`.type names, unless that is swept, or names none.
  void add_typed(const std::vector<std::string>& path, const std::vector<Entry>& entries) {
    std::vector<std::string> type = path;
    type.emplace_back("type");
    const YamlNode* node = at(type);
    if (node == nullptr || swept_.contains(fmt::format("{}", fmt::join(type, ".")))) return;
    add_named(path, entries, node->text);
  }

  void add_effects(const std::vector<Entry>& entries) {
    const YamlNode* list = at({"effects"});
    if (list == nullptr) return;
    for (std::size_t i = 0; i < list->children.size(); ++i) {
      const YamlNode& item = list->children[i];
      const std::string& name =
          item.kind == YamlNode::Kind::map && !item.children.empty() ? item.children.front().key : item.text;
      add_named({"effects", std::to_string(i), name}, entries, name);
    }
  }

  void add_friction(const char* key, const char* doc) {
    if (const YamlNode* written = at({"friction", key})) {
      add(std::string("friction.") + key, written, "", doc, "assumed: the scene's own, in the material's place");
    }
  }

  void add_material() {
    const YamlNode* material = at({"surface", "material"});
    if (material == nullptr && !swept_.contains("surface.material")) return;
    const std::vector<Material> table = material_table();
    const auto found = material == nullptr ? table.end() : std::ranges::find(table, material->text, &Material::name);
    add("surface.material", material, "", "friction of the pads on the box",
        found == table.end() ? "assumed: see slipbench list materials" : found->source);
  }

  void add_contact() {
    const YamlNode* fidelity = at({"fidelity"});
    if (fidelity != nullptr && fidelity->text == "mujoco_contact" && !swept_.contains("fidelity")) {
      add({contact_entry.name}, contact_entry);
    }
  }

  [[nodiscard]] const YamlNode* at(const std::vector<std::string>& path) const { return node_at(root_, path); }
  [[nodiscard]] Json rows() && { return std::move(rows_); }

 private:
  void add_named(const std::vector<std::string>& path, const std::vector<Entry>& entries, const std::string& name) {
    const auto found = std::ranges::find(entries, name, &Entry::name);
    if (found != entries.end()) add(path, *found);
  }

  void add(const std::string& path, const YamlNode* written, const std::string& default_text, const std::string& doc,
           const std::string& source) {
    std::string value = default_text;
    const char* by = "default";
    if (protocol_ != nullptr && protocol_->defaults.contains(path)) {
      value = protocol_->defaults.at(path);
      by = "protocol";
    }
    if (written != nullptr) {
      value = text_of(*written);
      by = "scene";
    }
    // A swept vector may be named entry by entry: "box.size.0".
    const bool swept = std::ranges::any_of(swept_.items(), [&](const auto& item) {
      const std::string& name = item.key();
      return name == path || name.starts_with(path + ".");
    });
    if (swept) {
      value.clear();
      by = "sweep";
    }
    rows_.push_back(
        {{"path", path}, {"value", value}, {"by", by}, {"doc", doc}, {"source", source}, {"assumed", is_assumed(source)}});
  }

  const YamlNode& root_;
  const Json& swept_;
  const Protocol* protocol_ = nullptr;
  Json rows_ = Json::array();
};

}  // namespace

Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place) {
  SceneFile file = SceneFile::from_text(scene, place);
  for (const auto& [path, value] : overrides.items()) {
    if (!value.is_string()) throw InputError(place + ": attribute overrides holds no text for " + path);
    file.apply({path, value.get<std::string>()});
  }
  ParameterRows rows(file.root(), swept);
  for (const Entry& entry : grasp_catalogue()) {
    if (entry.name != "scatter" || rows.at({"scatter"}) != nullptr) rows.add({entry.name}, entry);
  }
  const YamlNode* kind = rows.at({"motion", "kind"});
  const std::string arm = kind == nullptr ? "lift" : kind->text;
  const auto motion = std::ranges::find_if(motion_catalogue(), [&](const MotionKind& known) { return known.about.name == arm; });
  if (motion != motion_catalogue().end()) rows.add({"motion"}, motion->about);
  rows.add_material();
  rows.add_friction("static", "friction coefficient");
  rows.add_friction("kinetic", "friction coefficient of what slides");
  rows.add_friction("scale", "multiplies both coefficients");
  rows.add_contact();
  const Catalogues catalogues = program_catalogues();
  rows.add_effects(catalogues.effects);
  if (const YamlNode* sensors = rows.at({"sensors"})) {
    for (const YamlNode& sensor : sensors->children) {
      rows.add_typed({"sensors", sensor.key}, catalogues.sensors);
      rows.add({"sensors", sensor.key}, damping_spec);
    }
  }
  rows.add_typed({"detector"}, catalogues.detectors);
  rows.add_typed({"controller"}, catalogues.controllers);
  return std::move(rows).rows();
}

}  // namespace slipbench::report
