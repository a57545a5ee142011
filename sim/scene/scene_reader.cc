#include "sim/scene/scene_reader.h"

#include <array>
#include <charconv>
#include <cmath>

#include "sim/scene/dynamics_reader.h"
#include "sim/scene/scene_values.h"

namespace slipbench {
namespace {

constexpr std::string_view schema_version = "1";
constexpr std::size_t max_sensors = 64;
constexpr double least_impedance = 1e-4, most_impedance = 0.9999;  // mjMINIMP and mjMAXIMP
constexpr double least_width = 1e-15;                              // m, mjMINVAL: lower bound only
constexpr std::string_view contact_fidelity = "mujoco_contact";

constexpr std::array<SceneKey, 27> keys{{
    {"bodies", "Bodies that forces move, by their names."},
    {"box", "The box that a grasp lifts."},
    {"contact", "MuJoCo's own contact, with fidelity: mujoco_contact."},
    {"controller", "The controller of the gripper."},
    {"controls", "Controls of the model's actuators: a number, or points of time and value."},
    {"description", "A text for the reader."},
    {"detector", "The slip detector and the sensor that it reads."},
    {"duration", "Length of a trial."},
    {"effects", "Effects of the contact beyond Coulomb friction: names, or one {name: {parameters}} each."},
    {"expect", "Expected results of the trials, for `slipbench check`."},
    {"fidelity", "Model of the pads."},
    {"field_solver", "How the time step treats the pads' springs."},
    {"friction", "Coefficients of friction that replace the material's, and a factor on both."},
    {"gravity", "Acceleration of gravity, downwards."},
    {"grip", "How a grasp's fingers close and hold."},
    {"hold", "Condition that a body does not move relative to the sensor or body that holds it."},
    {"integrator", "How MuJoCo steps the bodies."},
    {"model", "Path of an MJCF file with bodies and actuators, relative to the scene's folder."},
    {"motion", "How the pad or the arm moves."},
    {"scatter", "Random variation between the trials of a grasp."},
    {"seed", "Seed of all random numbers (default: 0)."},
    {"sensors", "The sensors by their names."},
    {"slipbench", "Version of the schema: 1."},
    {"split", "How a dataset of the trials is divided into train, valid and test."},
    {"surface", "Shape and material of what the sensors touch."},
    {"sweep", "Values that differ between trials, by their paths."},
    {"time_step", "Time step of the simulation; auto: chosen."},
}};

class SceneReader : EntryReader {
 public:
  SceneReader(const YamlNode& root, const Catalogues& catalogues, Trace* trace)
      : EntryReader(root.origin, trace), catalogues_(catalogues) {}

  Scene read(const YamlNode& root) {
    require_map(root, "the scene", "keys with values, 'slipbench: 1' first");
    check_keys(root, "the scene", names_of(keys));
    read_version(root);
    Scene scene;
    scene.grasp = read_grasp(root);  // first: its protocol sets defaults of other sections
    if (const YamlNode* node = root.find("description")) scene.description = text_of(*node, "description", "text");
    scene.duration = number(root.find("duration"), "duration", duration_spec);
    scene.time_step = read_time_step(root.find("time_step"), scene.duration);
    scene.fidelity = read_fidelity(root.find("fidelity"));
    scene.contact = read_contact(find_kept(root, "contact"), scene.fidelity);
    scene.seed = read_seed(root);
    scene.split = read_split(root.find("split"));
    const Material& material = read_surface(root.find("surface"), scene);
    scene.friction = read_friction(root.find("friction"), material);
    scene.motion = read_kind(root.find("motion"), "motion", "kind", default_motion(scene.grasp.has_value()), catalogues_.motions,
                             "motion", {});
    refuse_motion_of_other_bench(root, scene);
    refuse_unfinished_lift(root, scene);
    scene.sensors = read_sensors(root);
    read_dynamics(*this, root, catalogues_, scene);
    scene.effects = read_list(root.find("effects"), "effects", catalogues_.effects, "effect");
    scene.detector = read_detector(root.find("detector"), scene.sensors);
    scene.controller = read_controller(root.find("controller"), scene);
    if (const YamlNode* node = root.find("expect")) {
      scene.expect = ExpectationReader(*this).read(*node, scene, catalogues_.expectations);
    }
    return scene;
  }

 private:
  static void read_version(const YamlNode& root) {
    const YamlNode* node = root.find("slipbench");
    if (node == nullptr) fail(root.origin, "no key 'slipbench'; a scene begins with its schema version: 'slipbench: 1'");
    if (node->kind != YamlNode::Kind::scalar || node->text != schema_version) {
      fail(node->origin, "slipbench is " + described(*node) + "; allowed: 1, the schema version");
    }
  }

  std::optional<double> read_time_step(const YamlNode* node, double duration) {
    if (node == nullptr || (node->kind == YamlNode::Kind::scalar && node->text == "auto")) {
      record("time_step", std::string("auto"));
      return std::nullopt;
    }
    const double step = number(node, "time_step", time_step_spec);
    if (step > duration) {
      fail(node->origin, "time_step " + format_quantity(step, Quantity::time) + " exceeds the duration; allowed: at most " +
                             format_quantity(duration, Quantity::time) + ", or auto");
    }
    if (duration / step > max_steps) {
      fail(node->origin, "time_step " + format_quantity(step, Quantity::time) +
                             " would need more than 100,000,000 steps; allowed: at least " +
                             format_quantity(duration / max_steps, Quantity::time) + ", or auto");
    }
    return step;
  }

  std::string read_fidelity(const YamlNode* node) { return std::get<std::string>(value(node, "fidelity", fidelity_spec)); }

  std::optional<Parameters> read_contact(const YamlNode* node, const std::string& fidelity) {
    if (fidelity != contact_fidelity) {
      if (node != nullptr) {
        fail(node->key_origin, "'contact' sets MuJoCo's own contact friction, but the fidelity is " + quote(fidelity) +
                                   "; use 'fidelity: " + std::string(contact_fidelity) + "'");
      }
      return std::nullopt;
    }
    if (node != nullptr) require_map(*node, "contact", "parameters, or none");
    Parameters contact = parameters(node, "contact", "contact", contact_entry, {});
    refuse_mixed(node, contact, "solref", "two positive numbers, or two negative ones: -stiffness and -damping", false);
    refuse_mixed(node, contact, "solreffriction", "two positive numbers, two negative ones, or 0, 0: as solref", true);
    if (const std::vector<double>& own = contact.vector("solreffriction");
        contact.choice("cone") == "pyramidal" && (own[0] != 0.0 || own[1] != 0.0)) {
      fail(node->find("solreffriction")->origin,
           "contact.solreffriction: MuJoCo ignores it with pyramidal cones, the default; use cone: elliptic");
    }
    const std::vector<double>& impedance = contact.vector("solimp");
    for (std::size_t i = 0; i < 2; ++i) {
      if (impedance[i] >= least_impedance && impedance[i] <= most_impedance) continue;
      fail(node->find("solimp")->children[i].origin, "contact.solimp." + std::to_string(i) + ": " + format_number(impedance[i]) +
                                                         " would be clipped by MuJoCo; allowed: " +
                                                         format_number(least_impedance) + " to " + format_number(most_impedance));
    }
    if (!(impedance[2] > least_width)) {
      fail(node->find("solimp")->children[2].origin,
           "contact.solimp.2: with a depth of " + format_number(impedance[2]) +
               " MuJoCo would use a constant impedance, the mean of the two; allowed: > " + format_number(least_width) + " m");
    }
    return contact;
  }

  std::optional<Parameters> read_split(const YamlNode* node) {
    if (node == nullptr) return std::nullopt;
    require_map(*node, "split", "'by' and 'shares'");
    Parameters split = parameters(node, "split", "split", split_entry, {});
    const std::vector<double>& shares = split.vector("shares");
    constexpr double rounding = 1e-9;
    if (std::abs(shares[0] + shares[1] + shares[2] - 1.0) > rounding || shares[0] == 0.0) {
      fail(node->find("shares")->origin, "split.shares: " + format_number(shares[0]) + ", " + format_number(shares[1]) + ", " +
                                             format_number(shares[2]) +
                                             "; the shares of train, valid and test must sum to 1, with train above 0");
    }
    return split;
  }

  // MuJoCo silently uses its defaults for a reference of mixed signs.
  static void refuse_mixed(const YamlNode* node, const Parameters& contact, const std::string& name, const std::string& allowed,
                           bool or_none) {
    const std::vector<double>& reference = contact.vector(name);
    const bool none = reference[0] == 0.0 && reference[1] == 0.0;
    if (none ? or_none : reference[0] * reference[1] > 0.0) return;
    fail(node->find(name)->origin,
         "contact." + name + ": " + format_number(reference[0]) + ", " + format_number(reference[1]) + "; allowed: " + allowed);
  }

  const Material& read_surface(const YamlNode* node, Scene& scene) {
    scene.surface = read_kind(node, "surface", "shape", "plane", catalogues_.surfaces, "surface shape", {"material"});
    const YamlNode* choice = node == nullptr ? nullptr : node->find("material");
    scene.material = choice == nullptr ? "acrylic" : text_of(*choice, "surface.material", "a name such as acrylic");
    record("surface.material", scene.material);
    return named(catalogues_.materials, scene.material, choice == nullptr ? root_origin() : choice->origin, "material");
  }

  FrictionScene read_friction(const YamlNode* node, const Material& material) {
    FrictionScene friction{material.mu_static, material.mu_kinetic, 1.0};
    if (node != nullptr) {
      require_map(*node, "friction", "static, kinetic and scale");
      check_keys(*node, "friction", {"kinetic", "scale", "static"});
      const YamlNode* static_node = node->find("static");
      const YamlNode* kinetic_node = node->find("kinetic");
      if (static_node != nullptr) friction.static_coefficient = number(static_node, "friction.static", coefficient_spec);
      if (kinetic_node != nullptr) {
        friction.kinetic_coefficient = number(kinetic_node, "friction.kinetic", coefficient_spec);
        if (friction.kinetic_coefficient > friction.static_coefficient) {
          fail(kinetic_node->origin, "friction.kinetic " + format_number(friction.kinetic_coefficient) +
                                         " exceeds the static coefficient " + format_number(friction.static_coefficient) +
                                         (static_node == nullptr ? " of " + material.name : ""));
        }
      } else if (static_node != nullptr && material.mu_static > 0.0) {
        // Only the static coefficient is given: keep the material's ratio.
        friction.kinetic_coefficient = friction.static_coefficient * (material.mu_kinetic / material.mu_static);
      }
      friction.scale = number(node->find("scale"), "friction.scale", scale_spec);
    }
    const auto written = [node](std::string_view key) {
      const YamlNode* child = node == nullptr ? nullptr : node->find(key);
      return child == nullptr ? std::string() : child->text;
    };
    record("friction.static", friction.static_coefficient, Quantity::none, written("static"));
    record("friction.kinetic", friction.kinetic_coefficient, Quantity::none, written("kinetic"));
    record("friction.scale", friction.scale);
    friction.static_coefficient *= friction.scale;
    friction.kinetic_coefficient *= friction.scale;
    return friction;
  }

  std::vector<SensorScene> read_sensors(const YamlNode& root) {
    const YamlNode* node = root.find("sensors");
    const std::string example = "at least one sensor, such as 'pad: {type: papillarray}'";
    if (node == nullptr) fail(root.origin, "no key 'sensors'; expected a map of " + example);
    require_map(*node, "sensors", example);
    if (node->children.empty()) fail(node->origin, "sensors is empty; expected a map of " + example);
    if (node->children.size() > max_sensors) {
      fail(node->origin, std::to_string(node->children.size()) + " sensors; allowed: at most " + std::to_string(max_sensors));
    }
    std::vector<SensorScene> sensors;
    for (const YamlNode& child : node->children) sensors.push_back(read_sensor(child));
    return sensors;
  }

  SensorScene read_sensor(const YamlNode& node) {
    const std::string path =
        named_part(node, "sensors", "sensor", "'type', 'electronics' and parameters", "type", catalogues_.sensors);
    const YamlNode* type = node.find("type");
    SensorScene sensor;
    sensor.name = node.key;
    sensor.type = text_of(*type, path + ".type", "the name of a sensor");
    const Entry& entry = named(catalogues_.sensors, sensor.type, type->origin, "sensor");
    record(path + ".type", sensor.type);
    sensor.parameters =
        parameters(&node, path, path, entry, {"ahead", "damping", "electronics", "follows", "site", "touches", "type"});
    sensor.electronics = read_electronics(node.find("electronics"), sensor.type, path + ".electronics");
    return sensor;
  }

  std::optional<DetectorScene> read_detector(const YamlNode* node, const std::vector<SensorScene>& sensors) {
    const Entry* entry = read_loop_part(node, "detector", catalogues_.detectors);
    if (entry == nullptr) return std::nullopt;
    DetectorScene detector{entry->name, 0, parameters(node, "detector", "detector", *entry, {"sensor", "type"})};
    detector.sensor = read_detector_sensor(*node, sensors);
    return detector;
  }

  std::optional<Named> read_controller(const YamlNode* node, const Scene& scene) {
    const Entry* entry = read_loop_part(node, "controller", catalogues_.controllers);
    if (entry == nullptr) return std::nullopt;
    if (!scene.grasp) fail(node->key_origin, "'controller' needs a gripper, that is a scene with 'grip' or 'box'");
    return Named{entry->name, parameters(node, "controller", "controller", *entry, {"type"})};
  }

  // Returns the entry named by `type` in the map, or null for none.
  const Entry* read_loop_part(const YamlNode* node, const std::string& key, const std::vector<Entry>& entries) {
    if (node == nullptr) return nullptr;
    require_map(*node, key, "'type' and parameters");
    std::vector<std::string_view> types = names_of(entries);
    types.emplace_back(none_);
    std::ranges::sort(types);
    const YamlNode* type = node->find("type");
    if (type == nullptr) fail(node->origin, "no key 'type' in " + key + allowed_names("", types));
    const std::string& name = text_of(*type, key + ".type", "the name of a " + key);
    if (std::ranges::find(types, name) == types.end()) {
      fail(type->origin, "unknown " + key + " " + quote(name) + allowed_names(name, types));
    }
    record(key + ".type", name);
    if (name != none_) return &named(entries, name, type->origin, key);
    check_keys(*node, key, {"type"});
    return nullptr;
  }

  std::size_t read_detector_sensor(const YamlNode& detector, const std::vector<SensorScene>& sensors) {
    const YamlNode* node = detector.find("sensor");
    if (node == nullptr && sensors.size() > 1) {
      fail(detector.origin,
           "no key 'sensor' in detector, but the scene has several sensors" + allowed_names("", names_of(sensors)));
    }
    const std::string& name =
        node == nullptr ? sensors.front().name : text_of(*node, "detector.sensor", "the scene's name of a sensor");
    record("detector.sensor", name);
    const auto found = std::ranges::find(sensors, name, &SensorScene::name);
    if (found == sensors.end()) {
      fail(node->origin, "detector.sensor: unknown sensor " + quote(name) + allowed_names(name, names_of(sensors)));
    }
    return static_cast<std::size_t>(found - sensors.begin());
  }

  // A scene with `grip` or `box` is a grasp; the missing one takes its defaults.
  std::optional<GraspScene> read_grasp(const YamlNode& root) {
    const YamlNode *grip = root.find("grip"), *box = root.find("box"), *scatter = root.find("scatter");
    if (grip == nullptr && box == nullptr) {
      if (scatter != nullptr) fail(scatter->key_origin, "'scatter' applies only to a grasp, a scene with 'grip' or 'box'");
      return std::nullopt;
    }
    for (const std::string_view key : {"bodies", "controls", "model"}) {
      if (const YamlNode* node = find_kept(root, key)) {
        fail(node->key_origin,
             quote(key) + " cannot be used in a grasp (a scene with 'grip' or 'box'), which has its own bodies");
      }
    }
    const YamlNode* protocol = grip == nullptr ? nullptr : grip->find("protocol");
    const std::string& name =
        protocol == nullptr ? default_protocol_ : text_of(*protocol, "grip.protocol", "the name of a protocol");
    use(named(catalogues_.protocols, name, protocol == nullptr ? root_origin() : protocol->origin, "protocol"));
    const auto part = [this](const YamlNode* node, const std::string& key) {
      if (node != nullptr) require_map(*node, key, "parameters");
      return parameters(node, key, key, named(catalogues_.grasp, key, root_origin(), "key of a grasp"), {});
    };
    GraspScene grasp{part(grip, "grip"), part(box, "box"), std::nullopt};
    if (scatter != nullptr) grasp.scatter = part(scatter, "scatter");
    return grasp;
  }

  // Motions of a grasp's arm are invalid for a stage, and the reverse.
  [[nodiscard]] bool is_of_arm(const std::string& motion) const {
    return std::ranges::find(catalogues_.arm_motions, motion) != catalogues_.arm_motions.end();
  }

  [[nodiscard]] std::string default_motion(bool of_arm) const {
    if (of_arm) return catalogues_.arm_motions.front();
    return std::ranges::find_if(catalogues_.motions, [&](const Entry& one) { return !is_of_arm(one.name); })->name;
  }

  void refuse_motion_of_other_bench(const YamlNode& root, const Scene& scene) const {
    if (is_of_arm(scene.motion.name) == scene.grasp.has_value()) return;
    const YamlNode& node = *root.find("motion");
    const YamlNode* kind = node.find("kind");
    fail(kind == nullptr ? node.origin : kind->origin,
         scene.grasp ? "motion " + quote(scene.motion.name) + " cannot move the arm of a grasp (a scene with 'grip' or 'box')" +
                           allowed_names(scene.motion.name, catalogues_.arm_motions)
                     : "motion " + quote(scene.motion.name) + " needs a grasp, that is a scene with 'grip' or 'box'");
  }

  // A box that the arm is still raising at the end of the trial has been neither held nor dropped.
  void refuse_unfinished_lift(const YamlNode& root, const Scene& scene) const {
    if (!scene.grasp || scene.guided() || catalogues_.lift_end == nullptr) return;
    const double end = catalogues_.lift_end(scene.motion.parameters);
    if (scene.duration >= end - 1e-9) return;  // as exact as a sum of decimal fractions
    const YamlNode* node = root.find("motion");
    // A drawn lift may outlast its trial, as some trials of the published benchmark do: a box that
    // has not left the table by the end counts as not lifted.
    const auto is_drawn = [](const YamlNode* value) { return value != nullptr && value->origin.drawn; };
    const auto of_motion = [&](const char* key) { return node == nullptr ? nullptr : node->find(key); };
    if (is_drawn(root.find("duration")) || is_drawn(of_motion("settle")) || is_drawn(of_motion("distance")) ||
        is_drawn(of_motion("speed")) || is_drawn(of_motion("acceleration"))) {
      return;
    }
    const auto seconds = [](double time) { return format_number(time) + " s"; };
    // rounded up, so that the duration in the message suffices
    const std::string needed = seconds(std::ceil(1e3 * end) / 1e3);
    fail(node == nullptr ? root.origin : node->key_origin, "motion: the lift ends at " + needed + ", after the trial's end at " +
                                                               seconds(scene.duration) + "; allowed: a duration of at least " +
                                                               needed + ", or a lift that ends earlier");
  }

  std::vector<Named> read_electronics(const YamlNode* node, const std::string& sensor, const std::string& path) {
    static const std::vector<Entry> none;
    const auto found = catalogues_.electronics.find(sensor);
    const std::vector<Entry>& parts = found == catalogues_.electronics.end() ? none : found->second;
    if (node != nullptr && node->kind == YamlNode::Kind::sequence) return read_list(node, path, parts, "part of the electronics");
    const std::string& choice = node == nullptr ? ideal_ : text_of(*node, path, "ideal, typical, or a sequence of parts");
    record(path, choice);
    if (choice == ideal_) return {};
    if (choice != "typical") {
      const std::array<std::string_view, 2> allowed{"ideal", "typical"};
      fail(node->origin, path + ": unknown value " + quote(choice) + allowed_names(choice, allowed) + ", or a sequence of parts");
    }
    std::vector<Named> electronics;
    for (const Entry& entry : parts) {
      electronics.push_back({entry.name, parameters(nullptr, path + "." + entry.name, path, entry, {})});
    }
    return electronics;
  }

  const Catalogues& catalogues_;
  const std::string default_protocol_ = "as_recorded";
  const std::string ideal_ = "ideal";
  const std::string none_ = "none";
};

}  // namespace

std::span<const SceneKey> scene_keys() { return keys; }

Scene read_scene(const YamlNode& root, const Catalogues& catalogues, Trace* trace) {
  return SceneReader(root, catalogues, trace).read(root);
}

std::uint64_t read_seed(const YamlNode& root) {
  const YamlNode* node = root.find("seed");
  if (node == nullptr) return 0;
  const std::string& text = text_of(*node, "seed", "a whole number such as 7");
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size()) {
    fail(node->origin, "seed: " + quote(text) + " is not a seed; allowed: 0 to 18446744073709551615");
  }
  return seed;
}

}  // namespace slipbench
