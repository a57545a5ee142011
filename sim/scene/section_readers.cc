#include "sim/scene/section_readers.h"

#include <array>

#include "sim/scene/scene_values.h"

namespace slipbench {

namespace {

ParameterSpec share(const char* name, const char* doc) {
  return number_spec(name, Quantity::none, "1 %", positive_up_to(1.0), doc, "free");
}

// Keys of a scene that say how it is computed. With a wish that is what is looked for.
constexpr std::array<std::string_view, 3> settings{"field_solver", "integrator", "time_step"};

}  // namespace

const std::vector<ParameterSpec>& accuracy_specs() {
  static const std::vector<ParameterSpec> specs{
      share("onset", "Largest error of the onset of a unit's slip, as a share of its loading time."),
      share("micro_onset", "Largest error of the onset of a unit's first micro-slip, as a share of its loading time."),
      share("slip_distance", "Largest error of a unit's slipped distance, as a share of the largest distance."),
      share("force", "Largest error of the units' forces, root mean square."),
      share("label", "Share of the units' states that may differ."),
      share("label_micro", "Share of the pad's states that may differ."),
      number_spec("creep", Quantity::speed, "1 um/s", positive, "Largest error of the drift of a held body over its pad.",
                  "free")};
  return specs;
}

std::optional<AccuracyScene> AccuracyReader::read(const YamlNode& root) {
  const YamlNode* node = root.find("accuracy");
  if (node == nullptr || (node->kind == YamlNode::Kind::scalar && node->text == "none")) return std::nullopt;
  require_map(*node, "accuracy", "what may be wrong by how much, such as 'onset: 1 %', or none");
  const std::vector<ParameterSpec>& specs = accuracy_specs();
  check_keys(*node, "accuracy", names_of(specs));
  if (node->children.empty())
    fail(node->origin, "accuracy is empty" + allowed_names("", names_of(specs)) + ", or accuracy: none");
  for (const std::string_view key : settings) {
    const YamlNode* setting = root.find(key);
    if (setting == nullptr || (setting->kind == YamlNode::Kind::scalar && setting->text == "auto")) continue;
    fail(setting->key_origin, quote(key) + " is found for a scene that says its accuracy; allowed: one of the two");
  }
  AccuracyScene accuracy;
  for (const ParameterSpec& spec : specs) {
    if (const YamlNode* wish = node->find(spec.name)) {
      accuracy.wishes.push_back({spec.name, number(wish, "accuracy." + spec.name, spec)});
    }
  }
  return accuracy;
}

ExpectScene ExpectationReader::read(const YamlNode& node, const Scene& scene, const std::vector<ExpectationEntry>& catalogue) {
  require_map(node, "expect", "what must come out, such as 'gross_slip_by: 1.0 s'");
  std::vector<std::string_view> keys = names_of(catalogue);
  keys.insert(keys.end(), {"confidence", "control"});
  std::ranges::sort(keys);
  check_keys(node, "expect", keys);
  ExpectScene expect;
  for (const YamlNode& child : node.children) {
    const auto entry = std::ranges::find(catalogue, child.key, &ExpectationEntry::name);
    if (entry != catalogue.end()) expect.expectations.push_back(read_expectation(child, scene, *entry));
  }
  expect.confidence = number(node.find("confidence"), "expect.confidence", confidence_spec);
  expect.control = read_control(node.find("control"), scene);
  return expect;
}

Named ExpectationReader::read_expectation(const YamlNode& node, const Scene& scene, const ExpectationEntry& entry) {
  const auto refuse = [&](const std::string& needs) { fail(node.key_origin, quote(entry.name) + " in expect needs " + needs); };
  if (entry.of_grasp && !scene.grasp) refuse("a gripper: a scene with 'grip' or 'box'");
  if (entry.of_detector && !scene.detector) refuse("a detector: a scene with 'detector'");
  const std::string path = "expect." + entry.name;
  const ParameterSpec& limit = entry.parameters.front();
  if (node.kind != YamlNode::Kind::map) {
    Named expectation{entry.name, defaults_of(entry.parameters)};
    expectation.parameters.set(limit.name, value(&node, path, limit));
    return expectation;
  }
  if (node.find(limit.name) == nullptr) {
    fail(node.origin, "no key 'limit' in " + path + "; it says what is allowed, such as 'limit: " + limit.default_text + "'");
  }
  return {entry.name, parameters(&node, path, path, entry, {})};
}

std::string ExpectationReader::read_control(const YamlNode* node, const Scene& scene) {
  if (node == nullptr) return scene.controller ? negative_control : "";
  if (std::get<std::string>(value(node, "expect.control", control_spec)) == "none") return "";
  if (!scene.controller) fail(node->origin, "expect.control stands in for a controller, and the scene has none; allowed: none");
  return negative_control;
}

}  // namespace slipbench
