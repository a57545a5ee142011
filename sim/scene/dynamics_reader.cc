#include "sim/scene/dynamics_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/scene/scene_values.h"

namespace slipbench {
namespace {

// Keys that only a scene with bodies that move by forces may have: of the scene, and of its
// sensors.
constexpr std::array<std::string_view, 5> dynamic_keys{"controls", "field_solver", "gravity", "hold", "integrator"};
constexpr std::array<std::string_view, 5> dynamic_sensor_keys{"ahead", "damping", "follows", "site", "touches"};
// Keys of both lists that are invalid in a grasp.
constexpr std::array<std::string_view, 4> keys_of_models{"controls", "hold", "site", "touches"};

// An override by which a key counts as absent.
struct AbsenceWord {
  std::string_view key;
  std::string_view word;
};
constexpr std::array<AbsenceWord, 3> absence_words{{{"contact", "none"}, {"field_solver", "auto"}, {"integrator", "auto"}}};

class DynamicsReader : EntryReader {
 public:
  DynamicsReader(const EntryReader& reader, const Catalogues& catalogues) : EntryReader(reader), catalogues_(catalogues) {}

  void read(const YamlNode& root, Scene& scene) {
    if (const YamlNode* node = root.find("model")) {
      const std::string& file = text_of(*node, "model", "the path of an MJCF file relative to the scene's folder");
      if (file.empty()) fail(node->origin, "model is empty; expected the path of an MJCF file relative to the scene's folder");
      scene.model = resolved_path(*node, "model", FileUse::part);
      record("model", file);
    }
    if (const YamlNode* node = root.find("bodies")) scene.bodies = read_bodies(*node);
    if (!scene.dynamic()) {
      refuse_dynamic_keys(root);
      return;
    }
    if (scene.grasp && scene.fidelity == "articulated") {
      fail(root.find("fidelity")->origin, "fidelity: " + quote(scene.fidelity) +
                                              " cannot simulate the table of a grasp; allowed in a grasp: field, mujoco_contact");
    }
    if (const YamlNode* node = root.find("surface")) check_keys(*node, "surface of a scene with bodies", {"material"});
    if (const YamlNode* node = root.find("gravity")) scene.gravity = number(node, "gravity", gravity_spec);
    const std::string solver = std::get<std::string>(value(find_kept(root, "field_solver"), "field_solver", field_solver_spec));
    scene.field_solver = solver == "implicit"   ? FieldSolver::implicit_springs
                         : solver == "explicit" ? FieldSolver::explicit_springs
                                                : FieldSolver::automatic;
    if (solver == "implicit" && scene.fidelity != "field") {
      fail(root.find("field_solver")->origin,
           "field_solver: 'implicit' needs 'fidelity: field'; with 'fidelity: " + scene.fidelity + "' leave it out");
    }
    scene.integrator = read_integrator(find_kept(root, "integrator"), scene);
    if (const YamlNode* node = root.find("controls")) scene.controls = read_controls(*node);
    if (const YamlNode* node = root.find("hold")) scene.hold = read_hold(*node, scene);
    read_followers(*root.find("sensors"), scene);
    if (scene.grasp) {
      read_pad_of_grasp(*root.find("sensors"), scene);
      return;
    }
    bool any_on_stage = false;
    for (SensorScene& sensor : scene.sensors) {
      if (!sensor.follows.empty()) continue;
      read_mounting(*root.find("sensors")->find(sensor.name), sensor);
      any_on_stage = any_on_stage || sensor.site.empty();
    }
    if (const YamlNode* node = root.find("motion"); node != nullptr && !any_on_stage) {
      fail(node->key_origin,
           "motion moves the sensors without a 'site', but every sensor of this scene has one; leave motion out");
    }
  }

 private:
  HoldScene read_hold(const YamlNode& node, const Scene& scene) {
    if (scene.grasp)
      fail(node.key_origin,
           "'hold' cannot be used in a grasp (a scene with 'grip' or 'box'), whose outcome already says 'dropped'");
    require_map(node, "hold", "'body', 'against', 'from' and 'within'");
    check_keys(node, "hold", {"against", "body", "from", "within"});
    const auto name = [&](const char* key, const std::string& allowed) {
      const YamlNode* child = node.find(key);
      if (child == nullptr) fail(node.key_origin, std::string("no key '") + key + "' in hold; allowed: " + allowed);
      return text_of(*child, std::string("hold.") + key, allowed);
    };
    HoldScene hold{name("body", "the name of a body"), name("against", "the name of a sensor or of a body"), 0.0, 0.0};
    if (hold.against == hold.body) {
      fail(node.find("against")->origin,
           "hold.against: " + quote(hold.against) + " is the body itself; expected what holds it: a sensor or another body");
    }
    hold.from = number(node.find("from"), "hold.from", hold_from_spec);
    hold.within = number(node.find("within"), "hold.within", hold_within_spec);
    if (hold.from >= scene.duration) {
      fail(node.find("from")->origin, "hold.from: " + format_quantity(hold.from, Quantity::time) +
                                          " is not before the end of the trial; allowed: less than " +
                                          format_quantity(scene.duration, Quantity::time));
    }
    return hold;
  }

  // For a scene with pads as fields: articulated pads have one integrator, and `contact` has its
  // own.
  std::string read_integrator(const YamlNode* node, const Scene& scene) {
    if (node == nullptr) return {};
    const std::string name = std::get<std::string>(value(node, "integrator", integrator_spec));
    const auto refuse = [&](const std::string& why) { fail(node->origin, "integrator: " + quote(name) + " " + why); };
    if (scene.contact) refuse("needs 'fidelity: field'; with 'fidelity: " + scene.fidelity + "' use contact.integrator");
    if (scene.fidelity != "field") refuse("needs 'fidelity: field'; 'fidelity: " + scene.fidelity + "' always uses discrete");
    if (scene.grasp && name == "RK4") {
      refuse(
          "has four stages in a step, but the fingers' springs of a grasp are constant within a step; allowed in a grasp: Euler, implicit, implicitfast, discrete");
    }
    if (scene.grasp && scene.field_solver == FieldSolver::implicit_springs) {
      refuse("cannot be combined with 'field_solver: implicit' in a grasp, which has its own integrator");
    }
    if (scene.implicit_fields() && name != "discrete") refuse("cannot be combined with 'field_solver: implicit'; use discrete");
    return name;
  }

  // Reads sensors that use the contact of another sensor's pad, or of the second pad of a grasp.
  void read_followers(const YamlNode& sensors, Scene& scene) {
    std::vector<std::string_view> pads;
    for (const SensorScene& sensor : scene.sensors) {
      if (sensors.find(sensor.name)->find("follows") == nullptr) pads.push_back(sensor.name);
    }
    if (scene.grasp) pads.push_back(second_pad_name);
    for (SensorScene& sensor : scene.sensors) {
      const YamlNode& node = *sensors.find(sensor.name);
      const YamlNode* follows = node.find("follows");
      const YamlNode* ahead = node.find("ahead");
      const std::string path = "sensors." + sensor.name;
      if (follows == nullptr && ahead != nullptr)
        fail(ahead->key_origin, "'ahead' in " + path + " applies only to a sensor with 'follows'; leave it out");
      if (follows == nullptr) continue;
      const std::string& name = text_of(*follows, path + ".follows", "the name of a sensor with its own pad");
      if (std::ranges::find(pads, name) == pads.end()) {
        fail(follows->origin, path + ".follows: unknown pad " + quote(name) + allowed_names(name, pads));
      }
      for (const std::string_view key : {"damping", "site", "touches"}) {
        if (const YamlNode* found = node.find(key)) {
          fail(found->key_origin, quote(key) + " in " + path + " is taken from the pad that it follows; leave it out");
        }
      }
      if (scene.fidelity != "field") {
        fail(
            follows->key_origin,
            "'follows' in " + path + " needs 'fidelity: field': an articulated pad has no field that a second sensor could read");
      }
      record(path + ".follows", name);
      sensor.follows = name;
      if (ahead != nullptr) sensor.ahead = number(ahead, path + ".ahead", ahead_spec);
    }
  }

  void read_pad_of_grasp(const YamlNode& sensors, Scene& scene) {
    const YamlNode& node = sensors.children.front();
    const std::string path = "sensors." + node.key;
    if (!scene.sensors.front().follows.empty()) {
      fail(node.find("follows")->key_origin,
           "'follows' in " + path + ": the first sensor of a grasp has its own pad on the finger, so it cannot follow another");
    }
    for (std::size_t i = 1; i < scene.sensors.size(); ++i) {
      if (!scene.sensors[i].follows.empty()) continue;
      fail(sensors.children[i].key_origin,
           "sensors." + scene.sensors[i].name +
               " would be a second pad on the finger, which carries only one; it must follow another pad: 'follows: " + node.key +
               "' or 'follows: " + std::string(second_pad_name) + "'");
    }
    for (const std::string_view key : {"site", "touches"}) {
      if (const YamlNode* found = node.find(key)) {
        fail(found->key_origin,
             quote(key) + " in " + path + " is fixed in a grasp: the sensor is on a finger and touches the box; leave it out");
      }
    }
    scene.sensors.front().damping = number(node.find("damping"), path + ".damping", damping_spec);
  }

  static void refuse_dynamic_keys(const YamlNode& root) {
    const auto refuse = [](const YamlNode& map, const std::string& where, const auto& keys) {
      for (const std::string_view key : keys) {
        if (const YamlNode* node = find_kept(map, key)) {
          const bool in_grasps = std::ranges::find(keys_of_models, key) == keys_of_models.end();
          fail(node->key_origin, quote(key) + where + " needs bodies moved by forces, that is a scene with " +
                                     (in_grasps ? "'box', 'model' or 'bodies'" : "'model' or 'bodies'"));
        }
      }
    };
    refuse(root, "", dynamic_keys);
    for (const YamlNode& sensor : root.find("sensors")->children)
      refuse(sensor, " in sensors." + sensor.key, dynamic_sensor_keys);
  }

  std::vector<BodyScene> read_bodies(const YamlNode& node) {
    const std::string example = "bodies, such as 'box: {shape: box}'";
    require_map(node, "bodies", example);
    if (node.children.empty()) fail(node.origin, "bodies is empty; expected a map of " + example);
    std::vector<BodyScene> bodies;
    for (const YamlNode& child : node.children) {
      const std::string path = named_part(child, "bodies", "body", "'shape' and parameters", "shape", catalogues_.bodies);
      bodies.push_back({child.key, read_kind(&child, path, "shape", "", catalogues_.bodies, "body shape", {})});
    }
    return bodies;
  }

  void read_mounting(const YamlNode& node, SensorScene& sensor) {
    const std::string path = "sensors." + sensor.name;
    if (const YamlNode* site = node.find("site")) {
      sensor.site = text_of(*site, path + ".site", "the name of a site of the model");
      record(path + ".site", sensor.site);
    }
    sensor.damping = number(node.find("damping"), path + ".damping", damping_spec);
    const YamlNode* touches = node.find("touches");
    const std::string allowed = "names of geoms or bodies, such as [box]";
    if (touches == nullptr) fail(node.key_origin, "no key 'touches' in " + path + "; allowed: " + allowed);
    if (touches->kind != YamlNode::Kind::sequence || touches->children.empty()) {
      const bool is_sequence = touches->kind == YamlNode::Kind::sequence;
      fail(touches->origin, path + ".touches is " + (is_sequence ? "empty" : described(*touches)) + "; allowed: " + allowed);
    }
    for (const YamlNode& item : touches->children) {
      const std::string item_path = path + ".touches." + std::to_string(sensor.touches.size());
      const std::string& name = text_of(item, item_path, "the name of a geom or body");
      if (std::ranges::find(sensor.touches, name) != sensor.touches.end()) {
        fail(item.origin, quote(name) + " is named twice in " + path + ".touches");
      }
      record(item_path, name);
      sensor.touches.push_back(name);
    }
  }

  std::vector<ControlScene> read_controls(const YamlNode& node) {
    require_map(node, "controls", "actuators of the model, such as 'grip: 4 N'");
    std::vector<ControlScene> controls;
    for (const YamlNode& child : node.children) {
      const std::string path = "controls." + child.key;
      ControlScene control{child.key, {}};
      if (child.kind == YamlNode::Kind::sequence && !child.children.empty()) {
        for (std::size_t i = 0; i < child.children.size(); ++i) {
          control.points.push_back(read_control_point(child.children[i], path + "." + std::to_string(i)));
          if (i > 0 && !(control.points[i].time > control.points[i - 1].time)) {
            fail(child.children[i].origin, path + "." + std::to_string(i) + ": the times must ascend; allowed: later than " +
                                               format_quantity(control.points[i - 1].time, Quantity::time));
          }
        }
      } else {
        control.points.push_back({0.0, control_value(child, path)});
      }
      controls.push_back(std::move(control));
    }
    return controls;
  }

  ControlScene::Point read_control_point(const YamlNode& node, const std::string& path) {
    if (node.kind != YamlNode::Kind::sequence || node.children.size() != 2) {
      fail(node.origin, path + " is " + described(node) + "; allowed: a time and a value, such as [1 s, 4 N]");
    }
    const double time = std::get<double>(scalar(node.children[0], path + ".0", control_time_spec));
    record(path + ".0", time);
    return {time, control_value(node.children[1], path + ".1")};
  }

  // The model defines the unit of an actuator, so every unit is accepted and converted to SI.
  double control_value(const YamlNode& node, const std::string& path) {
    if (node.kind != YamlNode::Kind::scalar) {
      fail(node.origin,
           path + " is " + described(node) + "; allowed: a number such as 4 N, or points such as [[0 s, 0 N], [1 s, 4 N]]");
    }
    double result = 0.0;
    try {
      result = parse_quantity(node.text, quantity_of(node.text));
    } catch (const std::invalid_argument& error) {
      fail(node.origin, path + ": " + error.what());
    }
    if (!std::isfinite(result)) fail(node.origin, path + ": " + quote(node.text) + " is infinite; allowed: a finite number");
    record(path, result);
    return result;
  }

  const Catalogues& catalogues_;
};

}  // namespace

const YamlNode* find_kept(const YamlNode& root, std::string_view key) {
  const YamlNode* node = root.find(key);
  if (node == nullptr || node->kind != YamlNode::Kind::scalar) return node;
  const auto taken_back = [&](const AbsenceWord& w) { return w.key == key && w.word == node->text; };
  return std::ranges::any_of(absence_words, taken_back) ? nullptr : node;
}

std::string named_part(const YamlNode& node, const std::string& list, const std::string& what, const std::string& allowed,
                       const std::string& selector, const std::vector<Entry>& entries) {
  if (!is_identifier(node.key))
    fail(node.key_origin,
         quote(node.key) + " is not a valid name of a " + what + "; allowed: letters, digits and '_', no digit first");
  const std::string path = list + "." + node.key;
  require_map(node, path, allowed);
  if (node.find(selector) == nullptr)
    fail(node.key_origin, "no key '" + selector + "' in " + path + allowed_names("", names_of(entries)));
  return path;
}

void read_dynamics(const EntryReader& reader, const YamlNode& root, const Catalogues& catalogues, Scene& scene) {
  DynamicsReader(reader, catalogues).read(root, scene);
}

}  // namespace slipbench
