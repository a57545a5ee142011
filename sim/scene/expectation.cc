#include "sim/scene/expectation.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <variant>

#include "sim/scene/scene_values.h"

namespace slipbench {

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
