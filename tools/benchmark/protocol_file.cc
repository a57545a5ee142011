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
  [[nodiscard]] std::string text() const { return text_of(node, path, "a name"); }
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

// Reads what the controls know of open recordings.
void read_controls(const Place& place, TestSet& test_set) {
  require_map(place.node, place.path, "times and distances");
  // A pull has a force where a motion has a travel.
  const bool pulls = place.node.find("force") != nullptr || place.node.find("force_rate") != nullptr;
  if (pulls)
    place.require_keys({"clock", "time", "force_rate", "speed_time", "force"});
  else
    place.require_keys({"clock", "time", "speed", "speed_time", "travel"});
  test_set.clock = place.number("clock", Quantity::time, "1.2 s");
  test_set.time = place.number("time", Quantity::time, "0.1 s");
  test_set.speed = pulls ? place.number("force_rate", Quantity::none, "11") : place.number("speed", Quantity::speed, "4 mm/s");
  test_set.speed_time = place.number("speed_time", Quantity::time, "0.1 s");
  test_set.travel = pulls ? place.number("force", Quantity::force, "1 N") : place.number("travel", Quantity::length, "0.2 mm");
}

}  // namespace

Protocol read_protocol(const std::string& name, const SceneFile& file) {
  const Place root{file.root(), "the protocol"};
  root.require_keys({"sensors", "disturbances", "grasps"});
  const std::vector<Place> sensors = root.at("sensors").children();
  const std::string folder = "scenes/benchmark/" + name + "/";
  Protocol protocol{.name = name, .held_out = {}};
  for (const Place& sensor : sensors) {
    sensor.require_keys({"open", "disturbed", "loop", "mover", "inside", "outside"});
    const std::string& type = sensor.node.key;
    TestSet open{.track = Track::open, .sensor = type, .readers = sensor.at("open").names()};
    if (sensor.node.find("mover") != nullptr) open.mover = sensor.at("mover").text();
    for (const auto& [domain, scene] : {std::pair{"inside", "open_"}, {"outside", "outside_"}}) {
      open.domain = domain;
      open.scene = folder + scene + type + ".yaml";
      read_controls(sensor.at(domain), open);
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
