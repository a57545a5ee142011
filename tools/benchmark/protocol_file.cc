#include "tools/benchmark/protocol_file.h"

#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "sim/core/parameters.h"
#include "sim/core/quantity.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench::benchmark {
namespace {

// A node with the words that name it in messages: "sensors.taxels".
struct Place {
  const YamlNode& node;
  std::string path;

  [[nodiscard]] Place at(const std::string& key) const {
    const YamlNode* child = node.find(key);
    if (child == nullptr) fail(node.origin, path + " has no key " + quote(key));
    return {*child, path == "the protocol" ? key : path + "." + key};
  }
  [[nodiscard]] std::vector<Place> children() const {
    std::vector<Place> all;
    for (const YamlNode& child : node.children) all.push_back({child, path + "." + child.key});
    return all;
  }
  void require_keys(const std::vector<std::string_view>& keys) const {
    require_map(node, path, "keys");
    check_keys(node, path, keys);
  }
  [[nodiscard]] std::string text(const char* what) const { return text_of(node, path, what); }
  [[nodiscard]] std::vector<std::string> names() const {
    if (node.kind != YamlNode::Kind::sequence || node.children.empty())
      fail(node.origin, path + " is " + described(node) + "; allowed: a sequence of names");
    std::vector<std::string> all;
    for (const YamlNode& child : node.children) all.push_back(text_of(child, path, "names"));
    return all;
  }
  [[nodiscard]] double number(const std::string& key, Quantity quantity, const std::string& example) const {
    const Place place = at(key);
    const ParameterSpec spec = number_spec(key, quantity, example, non_negative, "", "");
    return std::get<double>(scalar(place.node, place.path, spec));
  }
};

}  // namespace

Protocol read_protocol(const std::string& name, const SceneFile& file) {
  const Place root{file.root(), "the protocol"};
  root.require_keys({"sensors", "disturbances", "grasps"});
  const std::vector<Place> sensors = root.at("sensors").children();
  const std::string folder = "scenes/benchmark/" + name + "/";
  Protocol protocol{.name = name, .held_out = {}};
  for (const Place& sensor : sensors) {
    sensor.require_keys({"open", "disturbed", "loop", "mover", "real"});
    const std::string& type = sensor.node.key;
    TestSet open{.track = Track::open, .sensor = type, .readers = sensor.at("open").names()};
    if (sensor.node.find("mover") != nullptr) open.mover = sensor.at("mover").text("a name");
    protocol.real[type] = sensor.at("real").text("a sentence");
    for (const auto& [domain, scene] : {std::pair{"inside", "open_"}, {"outside", "outside_"}}) {
      open.domain = domain;
      open.scene = folder + scene + type + ".yaml";
      protocol.held_out.push_back(open);
    }
  }
  for (const std::string& disturbance : root.at("disturbances").names()) {
    for (const Place& sensor : sensors) {
      protocol.held_out.push_back({.track = Track::open,
                                   .sensor = sensor.node.key,
                                   .scene = folder + disturbance + ".yaml",
                                   .readers = sensor.at("disturbed").names(),
                                   .domain = "disturbed",
                                   .disturbance = disturbance});
    }
  }
  const Place grasps = root.at("grasps");
  grasps.require_keys({"time"});
  for (const Place& sensor : sensors) {
    protocol.held_out.push_back({.track = Track::loop,
                                 .sensor = sensor.node.key,
                                 .scene = folder + "loop_" + sensor.node.key + ".yaml",
                                 .readers = sensor.at("loop").names(),
                                 .time = grasps.number("time", Quantity::time, "0.04 s")});
  }
  return protocol;
}

}  // namespace slipbench::benchmark
