#include "sim/mujoco/pads/pad_config.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/releases/mujoco_library.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene_reader.h"
#include "sim/scene/scene_values.h"

namespace slipbench {
namespace {

// A pad given element by element.

constexpr const char* allowed_row = "[x, y, z, k_n, k_t], or [x, y, z, k_n, k_t, ax, ay, az] with the element's axis";

double number_of(const YamlNode& node, const std::string& subject, Quantity quantity) {
  if (node.kind != YamlNode::Kind::scalar) fail(node.origin, subject + " is " + described(node) + "; allowed: a number");
  try {
    const double value = parse_quantity(node.text, quantity);
    if (!std::isfinite(value)) throw std::invalid_argument("'" + node.text + "' is infinite; allowed: a finite number");
    return value;
  } catch (const std::invalid_argument& error) {
    fail(node.origin, subject + ": " + error.what());
  }
}

Element read_row(const YamlNode& row, const std::string& subject) {
  const std::size_t columns = row.kind == YamlNode::Kind::sequence ? row.children.size() : 0;
  if (columns != 5 && columns != 8) fail(row.origin, subject + " is not a row; allowed: " + allowed_row);
  const auto entry = [&](std::size_t k, Quantity quantity) {
    return number_of(row.children[k], subject + ", entry " + std::to_string(k), quantity);
  };
  Element element;
  for (std::size_t k = 0; k < 3; ++k) element.tip[static_cast<Eigen::Index>(k)] = entry(k, Quantity::length);
  element.k_normal = entry(3, Quantity::stiffness);
  element.k_tangential = entry(4, Quantity::stiffness);
  if (!(element.k_normal > 0.0) || !(element.k_tangential > 0.0)) {
    fail(row.origin, subject + ": a stiffness is not positive; allowed: > 0 N/m");
  }
  if (columns == 8) {
    for (std::size_t k = 0; k < 3; ++k) element.axis[static_cast<Eigen::Index>(k)] = entry(5 + k, Quantity::none);
    if (!(element.axis.norm() > 0.0)) fail(row.origin, subject + ": the axis has length 0");
    element.axis.normalize();
  }
  return element;
}

std::size_t count_of(const YamlNode& node, const std::string& subject) {
  const double count = number_of(node, subject, Quantity::none);
  if (!(count >= 1.0) || !(count <= static_cast<double>(Field::max_elements)) || count != std::floor(count)) {
    fail(node.origin,
         subject + " is '" + node.text + "'; allowed: a whole number from 1 to " + std::to_string(Field::max_elements));
  }
  return static_cast<std::size_t>(count);
}

class TableSensor final : public Sensor {
 public:
  TableSensor(const PadLayout& layout, double rate, bool of_elements)
      : layout_(layout),
        rate_(rate),
        of_elements_(of_elements),
        channels_{channel("force", "N", 'F'), channel("displacement", "m", 'D')} {
    const std::size_t elements = of_elements ? layout.elements.size() : 0;
    if (of_elements) {
      channels_.push_back({"depth", "m", {elements}, {}});
      channels_.push_back({"shear", "m", {3, elements}, {}});
    }
    values_.resize(6 * layout.units.size() + 4 * elements);
    frame_.values = values_;
  }

  TableSensor(const TableSensor&) = delete;  // the frame points into the object
  TableSensor& operator=(const TableSensor&) = delete;

  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const auto units = static_cast<Eigen::Index>(layout_.units.size());
    using Values = Eigen::Map<Eigen::Array3Xf>;
    Values(values_.data(), 3, units) = truth.force.cast<float>();
    Values(values_.data() + 3 * units, 3, units) = truth.displacement.cast<float>();
    if (of_elements_) {
      Eigen::Map<Eigen::ArrayXXf> each(values_.data() + 6 * units, truth.element_depth.size(), 4);
      each.col(0) = truth.element_depth.cast<float>();
      each.rightCols<3>() = truth.element_shear.cast<float>();
    }
    frame_.time = truth.time;
    return frame_;
  }

  // Returns the truth by the micro rule, as an ideal camera would see it; no paper labels such a
  // pad.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override { return truth.state_micro; }

 private:
  [[nodiscard]] Channel channel(const std::string& name, const std::string& unit, char symbol) const {
    Channel result{name, unit, {layout_.units.size(), 3}, {}};
    for (std::size_t u = 0; u < layout_.units.size(); ++u) {
      for (const char axis : {'X', 'Y', 'Z'}) result.channel_names.push_back("U" + std::to_string(u) + '_' + symbol + axis);
    }
    return result;
  }

  PadLayout layout_;
  double rate_;
  bool of_elements_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  SensorFrame frame_;
};

// Reads rows of x, y, z, k_n, k_t and, with three more values, the axis; numbers in SI or with
// units. `units`: a sequence with the number of elements of each unit, or null for one each. Throws
// InputError for an invalid row or if the units do not add up.
PadLayout read_element_table(const YamlNode& rows, const YamlNode* units) {
  if (rows.kind != YamlNode::Kind::sequence) {
    fail(rows.origin, "elements is " + described(rows) + "; allowed: a sequence of " + allowed_row);
  }
  PadLayout layout;
  for (const YamlNode& row : rows.children) {
    layout.elements.push_back(read_row(row, "element " + std::to_string(layout.elements.size())));
  }
  if (layout.elements.empty() || layout.elements.size() > Field::max_elements) {
    fail(rows.origin, counted(layout.elements.size(), "element") + "; allowed: 1 to " + std::to_string(Field::max_elements));
  }
  std::size_t first = 0;
  if (units == nullptr) {
    for (; first < layout.elements.size(); ++first) layout.units.push_back({first, 1});
    return layout;
  }
  if (units->kind != YamlNode::Kind::sequence)
    fail(units->origin, "units is " + described(*units) + "; allowed: a sequence of counts");
  for (const YamlNode& node : units->children) {
    layout.units.push_back({first, count_of(node, "unit " + std::to_string(layout.units.size()))});
    first += layout.units.back().count;
  }
  if (first != layout.elements.size()) {
    fail(units->origin,
         "the units have " + counted(first, "element") + ", but the pad has " + std::to_string(layout.elements.size()));
  }
  return layout;
}

// Makes a sensor without electronics that reports every unit's force [N] and displacement [m] in
// the pad frame, one sample per step. `of_elements`: also depth and shear [m] of each element
// (contact_frame.h), for a layout with element_truth.
std::unique_ptr<Sensor> make_table_sensor(const PadLayout& layout, double rate, bool of_elements) {
  return std::make_unique<TableSensor>(layout, rate, of_elements);
}

// Sensor type under which the scene reader knows the pad of an element table.
constexpr const char* table_type = "elements";

const ParameterSpec trial_spec = integer_spec("trial", "0", non_negative, "Key of the random draws.", "set for each scene");
const ParameterSpec truth_spec =
    flag_spec("truth", "false", "True: the truth follows the sensor's values.", "set for each scene");
const ParameterSpec element_truth_spec = choice_spec("element_truth", "false", {"false", "true", "read"},
                                                     "True: the truth lists each element too.", "set for each scene");
const ParameterSpec solver_spec =
    choice_spec("solver", "explicit", {"explicit", "implicit"}, "How the time step treats the springs: explicitly or implicitly.",
                "set for each scene");
const ParameterSpec check_spec = choice_spec("check", "error", {"error", "warn", "off"},
                                             "Whether a mistake in the model is an error or a warning.", "set for each scene");
const ParameterSpec unloaded_spec =
    choice_spec("unloaded", "1", {"1", "nan"}, "Margin reported for units without contact.", "set for each scene");

// The attributes of one instance.
class Attributes {
 public:
  Attributes(ModelView model, int instance)
      : model_(model), instance_(instance), name_(model.names() + model.name_pluginadr()[instance]) {
    if (name_.empty()) name_ = std::to_string(instance);
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string text(const char* attribute) const {
    const char* text = model_.mujoco().mj_getPluginConfig(model_.get(), instance_, attribute);
    return text == nullptr ? "" : text;
  }
  [[nodiscard]] bool has(const char* attribute) const { return !text(attribute).empty(); }
  [[noreturn]] void refuse(const std::string& what) const { throw InputError("plugin '" + name_ + "': " + what); }

  [[nodiscard]] YamlNode yaml(const char* attribute) const {
    // MuJoCo keeps about 1000 characters of a message; a table would fill them.
    constexpr std::size_t longest_shown = 80;
    std::string shown = text(attribute);
    if (shown.size() > longest_shown) shown = shown.substr(0, longest_shown) + "...";
    return parse_yaml(text(attribute), "plugin '" + name_ + "' " + attribute + "=" + quote(shown), false);
  }
  [[nodiscard]] Parameters::Value value(const ParameterSpec& spec) const {
    if (!has(spec.name.c_str())) return default_of(spec);
    try {
      return parse_scalar(spec, text(spec.name.c_str()));
    } catch (const std::invalid_argument& error) {
      refuse(spec.name + ": " + error.what());
    }
  }

  // Returns the id of the object called `object_name`, or -1. After MjSpec.attach it may have the
  // prefix or suffix of the instance.
  [[nodiscard]] int find(int type, const std::string& object_name) const {
    const std::string declared = text("name");
    for (std::size_t at = declared.empty() ? std::string::npos : name_.find(declared); at != std::string::npos;
         at = name_.find(declared, at + 1)) {
      const std::string attached = name_.substr(0, at) + object_name + name_.substr(at + declared.size());
      if (const int id = model_.mujoco().mj_name2id(model_.get(), type, attached.c_str()); id >= 0) return id;
    }
    if (const int id = model_.mujoco().mj_name2id(model_.get(), type, object_name.c_str()); id >= 0) return id;
    for (std::size_t size = declared.empty() ? name_.size() : 0; size > 0; --size) {
      if (const int id = model_.mujoco().mj_name2id(model_.get(), type, (name_.substr(0, size) + object_name).c_str()); id >= 0)
        return id;
    }
    return -1;
  }
  // The same; `noun`: "site". Throws InputError if it does not exist.
  [[nodiscard]] int object(int type, const char* noun, const std::string& object_name, int count) const {
    if (const int id = find(type, object_name); id >= 0) return id;
    std::vector<std::string> known;
    for (int id = 0; id < count; ++id) {
      if (const char* other = model_.name_of(type, id)) known.emplace_back(other);
    }
    refuse("no " + std::string(noun) + " " + quote(object_name) + " in the model" + allowed_names(object_name, known));
  }

  [[nodiscard]] ModelView model() const { return model_; }

 private:
  ModelView model_;
  int instance_;
  std::string name_;
};

YamlNode scalar(std::string text) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.text = std::move(text);
  return node;
}

void add(YamlNode& map, const char* key, YamlNode child) {
  child.key = key;
  child.key_origin = child.origin;
  map.children.push_back(std::move(child));
}

// Converts the instance's name to a valid sensor name of a scene: MjSpec.attach adds prefixes such
// as "left/".
std::string sensor_name(std::string name) {
  for (char& c : name) {
    if (!(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9')) c = '_';
  }
  return name.front() >= '0' && name.front() <= '9' ? "_" + name : name;
}

// Combines the attributes that correspond to a scene's keys into a scene.
YamlNode scene_tree(const Attributes& attributes) {
  YamlNode root, sensors, surface;
  root.kind = sensors.kind = surface.kind = YamlNode::Kind::map;
  root.origin.source = std::make_shared<const std::string>("plugin '" + attributes.name() + "'");
  add(root, "slipbench", scalar("1"));
  if (attributes.has("seed")) add(root, "seed", attributes.yaml("seed"));
  if (attributes.has("material")) {
    add(surface, "material", attributes.yaml("material"));
    add(root, "surface", std::move(surface));
  }
  if (attributes.has("friction")) add(root, "friction", attributes.yaml("friction"));
  if (attributes.has("effects")) add(root, "effects", attributes.yaml("effects"));
  YamlNode sensor;
  if (attributes.has("sensor")) {
    sensor = attributes.yaml("sensor");
  } else {
    sensor.kind = YamlNode::Kind::map;
    add(sensor, "type", scalar(table_type));
  }
  add(sensors, sensor_name(attributes.name()).c_str(), std::move(sensor));
  add(root, "sensors", std::move(sensors));
  return root;
}

// MuJoCo reads the same attributes three times per pad and model, and the trials of a sweep share a
// few sets of them. So a thread keeps the results of the last texts read.
template <class Value>
class LastRead {
 public:
  template <class Read>
  const Value& find(std::vector<std::string> texts, Read&& read) {
    constexpr std::size_t most = 8;
    const auto found = std::ranges::find(cached_, texts, &std::pair<std::vector<std::string>, Value>::first);
    if (found != cached_.end()) {
      std::rotate(cached_.begin(), found, found + 1);
    } else {
      cached_.emplace_front(std::move(texts), read());
      if (cached_.size() > most) cached_.pop_back();
    }
    return cached_.front().second;
  }

 private:
  std::deque<std::pair<std::vector<std::string>, Value>> cached_;  // most recently used first
};

// Reads the scene that the attributes describe. `known`: the same at every call.
const Scene& read_contact(const Attributes& attributes, const Catalogues& known) {
  thread_local LastRead<Scene> scenes;
  std::vector<std::string> texts{attributes.name()};
  for (const char* attribute : {"seed", "material", "friction", "effects", "sensor"}) texts.push_back(attributes.text(attribute));
  return scenes.find(std::move(texts), [&] {
    // Made once, because a copy of all catalogues costs more than reading a pad.
    static const Catalogues of_tables = [&] {
      Catalogues catalogues = known;
      catalogues.sensors = {{table_type, "", "", "", {}}};
      return catalogues;
    }();
    return read_scene(scene_tree(attributes), attributes.has("sensor") ? known : of_tables, nullptr);
  });
}

bool below(ModelView model, int body, int root) {
  while (body > root) body = model.body_parentid()[body];
  return body == root;
}

// When MuJoCo asks for sizes it has not yet determined which bodies are welded.
bool welded(ModelView model, int a, int b) {
  const auto top = [model](int body) {
    while (body > 0 && model.body_jntnum()[body] == 0) body = model.body_parentid()[body];
    return body;
  };
  return top(a) == top(b);
}

// Returns the geoms that a word of `touch` names.
std::vector<int> geoms_of(const Attributes& attributes, const std::string& word, int site) {
  ModelView model = attributes.model();
  const std::size_t colon = word.find(':');
  const std::string kind = word.substr(0, colon), rest = colon == std::string::npos ? "" : word.substr(colon + 1);
  if (attributes.find(mj::geom, word) >= 0 || (kind != "body" && kind != "subtree" && kind != "group")) {
    return {attributes.object(mj::geom, "geom", word, static_cast<int>(model.ngeom()))};
  }
  std::vector<int> all, colliding;
  const auto take = [&](int geom) {
    all.push_back(geom);
    if (model.geom_contype()[geom] != 0 || model.geom_conaffinity()[geom] != 0) colliding.push_back(geom);
  };
  if (kind == "group") {
    for (int geom = 0; geom < static_cast<int>(model.ngeom()); ++geom) {
      if (std::to_string(model.geom_group()[geom]) != rest) continue;
      if (!welded(model, model.geom_bodyid()[geom], model.site_bodyid()[site])) all.push_back(geom);
    }
    if (all.empty()) attributes.refuse("touch: no geom in group " + quote(rest) + " except geoms that move with the pad");
    return all;
  }
  const int body = attributes.object(mj::body, "body", rest, static_cast<int>(model.nbody()));
  for (int geom = 0; geom < static_cast<int>(model.ngeom()); ++geom) {
    if (kind == "body" ? model.geom_bodyid()[geom] == body : below(model, model.geom_bodyid()[geom], body)) take(geom);
  }
  if (all.empty()) attributes.refuse("touch: the " + kind + " " + quote(rest) + " has no geom");
  return colliding.empty() ? all : colliding;
}

std::vector<int> touched_geoms(const Attributes& attributes, int site) {
  std::istringstream words(attributes.text("touch"));
  std::vector<int> geoms;
  for (std::string word; words >> word;) {
    for (const int geom : geoms_of(attributes, word, site)) {
      if (std::ranges::find(geoms, geom) != geoms.end()) {
        const char* name = attributes.model().name_of(mj::geom, geom);
        attributes.refuse("touch names the geom " + quote(name == nullptr ? std::to_string(geom) : name) + " twice");
      }
      geoms.push_back(geom);
    }
  }
  if (geoms.empty())
    attributes.refuse("no attribute touch; expected names of geoms, body:NAME, subtree:NAME or group:N, separated by spaces");
  return geoms;
}

// Layouts passed in memory, by name.
struct LayoutTable {
  std::mutex mutex;
  std::map<std::string, PadLayout> layouts;
  std::size_t count = 0;
};
LayoutTable& table_in_memory() {
  static LayoutTable all;
  return all;
}

// Returns the pad of the attributes elements and units.
PadLayout table_of(const Attributes& attributes) {
  if (const std::string name = attributes.text("elements"); name.starts_with('@')) {
    const std::lock_guard lock(table_in_memory().mutex);
    const auto known = table_in_memory().layouts.find(name);
    if (known == table_in_memory().layouts.end())
      attributes.refuse("elements " + quote(name) + " belongs to a model that has been deleted");
    if (attributes.has("units")) attributes.refuse("units cannot be combined with elements " + quote(name));
    return known->second;
  }
  thread_local LastRead<PadLayout> tables;
  return tables.find({attributes.text("elements"), attributes.text("units")}, [&] {
    const YamlNode table = attributes.yaml("elements");
    if (!attributes.has("units")) return read_element_table(table, nullptr);
    const YamlNode counts = attributes.yaml("units");
    return read_element_table(table, &counts);
  });
}

}  // namespace

std::string LayoutsInMemory::add(PadLayout layout) {
  for (Element& element : layout.elements) {
    if (element.axis != Element{}.axis) element.axis.normalize();
  }
  const std::lock_guard lock(table_in_memory().mutex);
  names_.push_back("@" + std::to_string(table_in_memory().count++));
  table_in_memory().layouts.emplace(names_.back(), std::move(layout));
  return names_.back();
}

LayoutsInMemory::~LayoutsInMemory() {
  const std::lock_guard lock(table_in_memory().mutex);
  for (const std::string& name : names_) table_in_memory().layouts.erase(name);
}

std::unique_ptr<Sensor> PadConfig::make_sensor(const PadCatalogue& catalogue) const {
  // A table's pad is read at every step: no electronics sets a rate.
  if (!table.empty()) return make_table_sensor(table.front(), 0.0, reads_elements);
  try {
    return catalogue.make_sensor(sensor, seed, trial);
  } catch (const InputError& error) {
    throw InputError("plugin '" + name + "': " + error.what());
  }
}

PadConfig read_pad_config(ModelView model, int instance, const PadCatalogue& catalogue) {
  const Attributes attributes(model, instance);
  PadConfig config;
  config.mujoco = &model.mujoco();
  config.name = attributes.name();
  if (!attributes.has("pad")) attributes.refuse("no attribute pad; expected the name of a site");
  config.site = attributes.object(mj::site, "site", attributes.text("pad"), static_cast<int>(model.nsite()));
  config.geoms = touched_geoms(attributes, config.site);
  if (attributes.has("sensor") == attributes.has("elements")) {
    attributes.refuse("expected one of the attributes sensor and elements; found: " +
                      std::string(attributes.has("sensor") ? "both" : "neither"));
  }
  if (attributes.has("units") && !attributes.has("elements")) attributes.refuse("units needs the attribute elements");
  if (attributes.has("element_truth") && !attributes.has("elements"))
    attributes.refuse("element_truth needs the attribute elements");
  if (attributes.has("material") && attributes.has("friction"))
    attributes.refuse("material and friction are both given, but friction would replace that of the material; give one of them");
  if (attributes.has("elements")) {
    config.table = {table_of(attributes)};
    const auto element_truth = std::get<std::string>(attributes.value(element_truth_spec));
    config.table.front().element_truth |= element_truth != "false";
    config.reads_elements = element_truth == "read";
  }
  const Scene& scene = read_contact(attributes, catalogue.catalogues);
  config.sensor = scene.sensors.front();
  config.friction = {scene.friction.static_coefficient, scene.friction.kinetic_coefficient};
  config.effects = scene.effects;
  config.seed = scene.seed;
  config.trial = static_cast<std::uint64_t>(std::get<std::int64_t>(attributes.value(trial_spec)));
  config.damping = std::get<double>(attributes.value(damping_spec));
  config.truth = std::get<bool>(attributes.value(truth_spec));
  config.implicit = std::get<std::string>(attributes.value(solver_spec)) == "implicit";
  if (std::get<std::string>(attributes.value(unloaded_spec)) == "nan") config.unloaded = std::numeric_limits<double>::quiet_NaN();
  const auto check = std::get<std::string>(attributes.value(check_spec));
  config.warn = check == "warn";
  config.unchecked = check == "off";
  return config;
}

void PadConfig::report(const std::string& mistake) const {
  if (unchecked) return;
  const std::string text = "plugin '" + name + "': " + mistake;
  if (!warn) throw InputError(text + "; check='warn' makes this error a warning");
  mujoco->mju_warning("slipbench: %s", text.c_str());
}

}  // namespace slipbench
