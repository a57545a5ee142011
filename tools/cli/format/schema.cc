#include "tools/cli/format/schema.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/motion/motion_catalogue.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene_reader.h"
#include "sim/scene/scene_values.h"
#include "sim/scene/sweep.h"
#include "sim/scene/yaml_tree.h"
#include "tools/cli/format/describe.h"

namespace slipbench {
namespace {

constexpr std::size_t max_sensors = 64;
constexpr const char* identifier = "^[A-Za-z_][A-Za-z0-9_]*$";
constexpr const char* decimal = R"((\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)";

// Names of the definitions, in the order of enum Quantity.
constexpr std::array quantity_names{
    "number",    "length", "time", "speed",     "acceleration", "angle",   "angular_speed", "angular_acceleration",
    "frequency", "force",  "mass", "stiffness", "damping",      "pressure"};

// Pattern for the sign of a text such as "4 mm". A pattern cannot check other bounds in a text with
// a unit.
enum class Sign { any, non_negative, positive };

Sign sign_of(const Range& range) {
  if (range.min > 0.0 || (range.min == 0.0 && range.open_min)) return Sign::positive;
  return range.min == 0.0 ? Sign::non_negative : Sign::any;
}

Json reference(const std::string& definition) { return {{"$ref", "#/$defs/" + definition}}; }

// YAML reads the texts true and false as booleans, so both forms are allowed.
template <class Texts>
Json any_of_texts(const Texts& texts) {
  Json list = Json::array();
  for (const std::string_view text : texts) {
    list.push_back(text);
    if (text == "true" || text == "false") list.push_back(text == "true");
  }
  return {{"enum", std::move(list)}};
}

Json closed_object(Json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

Json has_any(std::initializer_list<const char*> keys) {
  Json list = Json::array();
  for (const char* key : keys) list.push_back({{"required", {key}}});
  return {{"anyOf", std::move(list)}};
}

Json negated(Json schema) { return {{"not", std::move(schema)}}; }

Json described(const Json& schema, const std::string& text) {
  Json result{{"description", text}};
  result.update(schema);
  return result;
}

// The spellings of a unit as a regular expression.
std::string unit_pattern(std::string_view symbol) {
  if (symbol == "N s/m") return "N ?s/m";
  std::string pattern(symbol);
  if (pattern.ends_with("s2")) pattern.insert(pattern.size() - 1, R"(\^?)");
  if (pattern.starts_with("um") || pattern.starts_with("us")) pattern.replace(0, 1, "[u\u00b5\u03bc]");
  return pattern;
}

std::string quantity_pattern(const std::vector<std::string>& units, Sign sign) {
  const char* const front = sign == Sign::any ? "[+-]?" : sign == Sign::non_negative ? R"(\+?)" : R"(\+?(?=[0.]*[1-9]))";
  return fmt::format("^{}{}[ \\t]*({})?$", front, decimal, fmt::join(units, "|"));
}

std::vector<std::string> unit_patterns(Quantity quantity) {
  std::vector<std::string> patterns;
  for (const Unit& unit : units_of(quantity)) {
    if (!unit.symbol.empty()) patterns.push_back(unit_pattern(unit.symbol));
  }
  return patterns;
}

// A default as JSON, as an editor inserts it into a scene.
Json default_json(const ParameterSpec& spec, const std::string& text) {
  if (spec.type == ParameterType::flag) return text == "true";
  if (spec.type != ParameterType::integer && (spec.type != ParameterType::number || spec.quantity != Quantity::none)) return text;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return text;
  return spec.type == ParameterType::integer ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

Json default_of_parameter(const ParameterSpec& spec) {
  if (spec.type == ParameterType::map) return Json::object();
  if (spec.type != ParameterType::vector) return default_json(spec, spec.default_text);
  ParameterSpec entry = spec;
  entry.type = ParameterType::number;
  Json values = Json::array();
  for (const YamlNode& child : parse_yaml(spec.default_text, spec.name, false).children)
    values.push_back(default_json(entry, child.text));
  return values;
}

class SceneSchema {
 public:
  explicit SceneSchema(const Catalogues& catalogues) : catalogues_(catalogues) {}

  Json build() {
    defs_["text"] = {{"type", {"string", "number", "boolean"}}};
    defs_["any_quantity"] = any_quantity();
    const std::map<std::string_view, Json> values = root_values();
    Json properties = Json::object();
    for (const SceneKey& key : scene_keys()) {
      const auto found = values.find(key.name);
      if (found == values.end()) throw std::logic_error("no schema of the scene's key " + std::string(key.name));
      properties[std::string(key.name)] = described(found->second, std::string(key.doc));
    }
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "slipbench scene"},
                {"description", "Schema of a scene file, written by `slipbench schema`."}};
    schema.update(closed_object(std::move(properties)));
    schema["required"] = {"slipbench"};
    schema["allOf"] = root_rules();
    schema["$defs"] = std::move(defs_);
    return schema;
  }

 private:
  // Defines a schema once and returns a reference to it.
  Json define(const std::string& name, Json schema) {
    defs_[name] = std::move(schema);
    return reference(name);
  }

  static Json any_quantity() {
    std::vector<std::string> units;
    for (std::size_t i = 0; i < quantity_names.size(); ++i)
      std::ranges::move(unit_patterns(static_cast<Quantity>(i)), std::back_inserter(units));
    return {{"anyOf", {{{"type", "number"}}, {{"type", "string"}, {"pattern", quantity_pattern(units, Sign::any)}}}}};
  }

  // Schema of texts for a quantity: with a unit, or a number that YAML 1.1 reads as text, such as
  // 1e-3.
  Json quantity_text(Quantity quantity, Sign sign) {
    const char* const prefix = sign == Sign::positive ? "positive_" : sign == Sign::non_negative ? "non_negative_" : "";
    const std::string name = prefix + std::string(quantity_names.at(static_cast<std::size_t>(quantity)));
    if (!defs_.contains(name)) defs_[name] = {{"type", "string"}, {"pattern", quantity_pattern(unit_patterns(quantity), sign)}};
    return reference(name);
  }

  Json number(const ParameterSpec& spec) {
    Json bare{{"type", "number"}};
    if (std::isfinite(spec.range.min)) bare[spec.range.open_min ? "exclusiveMinimum" : "minimum"] = spec.range.min;
    if (std::isfinite(spec.range.max)) bare["maximum"] = spec.range.max;
    Json kinds{std::move(bare), quantity_text(spec.quantity, sign_of(spec.range))};
    if (spec.range.infinite || spec.default_text == "inf") kinds.push_back({{"enum", {"inf", "+inf"}}});
    return {{"anyOf", std::move(kinds)}};
  }

  Json table(const ParameterSpec& spec) {
    Json row{{"type", "array"}, {"minItems", 1}};
    if (spec.columns.empty()) {
      row["items"] = number(number_spec("", Quantity::none, "1", any_value, "", ""));
    } else {
      row["minItems"] = spec.size;
      row["maxItems"] = spec.columns.size();
      row["prefixItems"] = Json::array();
      for (std::size_t i = 0; i < spec.columns.size(); ++i) {
        Json cell = number(number_spec("", spec.columns[i].quantity, "1", any_value, "", ""));
        if (i >= spec.size) cell["anyOf"].push_back({{"type", "null"}});
        row["prefixItems"].push_back(std::move(cell));
      }
    }
    return {{"anyOf", {reference("text"), {{"type", "array"}, {"minItems", 1}, {"items", std::move(row)}}}}};
  }

  Json value(const ParameterSpec& spec) {
    switch (spec.type) {
      case ParameterType::number: return number(spec);
      case ParameterType::integer: {
        Json whole{{"type", "integer"}};
        if (std::isfinite(spec.range.min)) whole["minimum"] = static_cast<std::int64_t>(spec.range.min);
        if (std::isfinite(spec.range.max)) whole["maximum"] = static_cast<std::int64_t>(spec.range.max);
        return whole;
      }
      case ParameterType::flag: return {{"type", "boolean"}};
      case ParameterType::choice: return any_of_texts(spec.choices);
      case ParameterType::path: return reference("text");
      case ParameterType::table: return table(spec);
      case ParameterType::vector:
        return {{"type", "array"}, {"minItems", spec.size}, {"maxItems", spec.size}, {"items", number(spec)}};
      case ParameterType::map:
        return {{"type", "object"},
                {"propertyNames", {{"pattern", identifier}}},
                {"additionalProperties", spec.choices.empty() ? reference("text") : any_of_texts(spec.choices)}};
    }
    throw std::logic_error("no such parameter type");
  }

  // A parameter with its description, allowed values and default.
  Json parameter(const ParameterSpec& spec) {
    Json schema =
        described(value(spec), fmt::format("{}{}Allowed: {}.", spec.doc, spec.doc.empty() ? "" : " ", allowed_text(spec)));
    schema["default"] = default_of_parameter(spec);
    return schema;
  }

  // A value of the scene itself, which the root describes.
  Json plain(const ParameterSpec& spec) {
    Json schema = value(spec);
    schema["default"] = default_of_parameter(spec);
    return schema;
  }

  Json parameters(const Entry& entry) {
    Json properties = Json::object();
    for (const ParameterSpec& spec : entry.parameters) properties[spec.name] = parameter(spec);
    return properties;
  }

  // The parameters of an entry and further keys.
  Json entry_object(const Entry& entry, const Json& other_keys) {
    Json properties = parameters(entry);
    properties.update(other_keys);
    return described(closed_object(std::move(properties)), entry.summary);
  }

  // A map in which `selector` names one of `entries`. Defines each as SECTION_NAME.
  Json chosen(const std::string& section, const std::string& selector, const std::vector<Entry>& entries, const Json& other_keys,
              const std::vector<std::string>& others = {}) {
    std::vector<std::string> names;
    Json rules = Json::array();
    const auto add = [&](const std::string& name, const Json& schema) {
      names.push_back(name);
      rules.push_back({{"if", {{"properties", {{selector, {{"const", name}}}}}, {"required", {selector}}}}, {"then", schema}});
    };
    for (const Entry& entry : entries) {
      Json keys{{selector, {{"const", entry.name}}}};
      keys.update(other_keys);
      add(entry.name, define(section + "_" + entry.name, entry_object(entry, keys)));
    }
    for (const std::string& other : others) add(other, closed_object({{selector, true}}));
    return {{"type", "object"}, {"properties", {{selector, any_of_texts(names)}}}, {"allOf", std::move(rules)}};
  }

  static Json without(const std::string& selector, const Json& then) {
    return {{"if", negated({{"required", {selector}}})}, {"then", then}};
  }

  // A sequence of names, or of {name: {parameters}}.
  Json list(const std::vector<Entry>& entries, const std::string& section) {
    std::vector<std::string> names;
    Json properties = Json::object();
    for (const Entry& entry : entries) {
      names.push_back(entry.name);
      properties[entry.name] = {{"anyOf", {{{"type", "null"}}, part(entry, section)}}};
    }
    Json map = closed_object(std::move(properties));
    map["minProperties"] = map["maxProperties"] = 1;
    return {{"type", "array"}, {"uniqueItems", true}, {"items", {{"anyOf", {any_of_texts(names), std::move(map)}}}}};
  }

  // The parameters of an entry of a list. Sensors with the same part share its definition.
  Json part(const Entry& entry, const std::string& section) {
    Json schema = entry_object(entry, Json::object());
    std::string name = section + "_" + entry.name;
    for (std::size_t number = 2; defs_.contains(name) && defs_[name] != schema; ++number)
      name = fmt::format("{}_{}_{}", section, entry.name, number);
    return define(name, std::move(schema));
  }

  Json sensors() {
    Json keys{{"electronics", true},
              {"follows", described(reference("text"), "Sensor whose pad this sensor reads too.")},
              {"ahead", parameter(ahead_spec)},
              {"damping", parameter(damping_spec)},
              {"site", described(reference("text"), "Site of the model that carries the pad.")},
              {"touches", described({{"type", "array"}, {"minItems", 1}, {"uniqueItems", true}, {"items", reference("text")}},
                                    "Geoms or bodies that the pad may touch.")}};
    Json sensor = chosen("sensor", "type", catalogues_.sensors, keys);
    sensor["required"] = {"type"};
    for (const Entry& entry : catalogues_.sensors) {
      const auto found = catalogues_.electronics.find(entry.name);
      Json electronics = any_of_texts(std::array{"ideal", "typical"});
      if (found != catalogues_.electronics.end() && !found->second.empty())
        electronics = {{"anyOf", {std::move(electronics), list(found->second, "electronics")}}};
      defs_["sensor_" + entry.name]["properties"]["electronics"] = described(
          electronics, "Errors of the electronics: ideal (none), typical (all parts with their defaults), or a list of parts.");
    }
    return {{"type", "object"},
            {"minProperties", 1},
            {"maxProperties", max_sensors},
            {"propertyNames", {{"pattern", identifier}}},
            {"additionalProperties", define("sensor", std::move(sensor))}};
  }

  Json bodies() {
    Json body = chosen("body", "shape", catalogues_.bodies, Json::object());
    body["required"] = {"shape"};
    return {{"type", "object"},
            {"minProperties", 1},
            {"propertyNames", {{"pattern", identifier}}},
            {"additionalProperties", std::move(body)}};
  }

  Json surface() {
    std::vector<std::string> names;
    for (const Material& material : catalogues_.materials) names.push_back(material.name);
    Json material = described(any_of_texts(names), "Sets the coefficients of friction.");
    material["default"] = "acrylic";
    Json schema = chosen("surface", "shape", catalogues_.surfaces, {{"material", material}});
    schema["properties"]["shape"]["default"] = "plane";
    schema["allOf"].push_back(without("shape", reference("surface_plane")));
    return schema;
  }

  Json loop_part(const std::string& key, const std::vector<Entry>& entries, const Json& other_keys) {
    Json schema = chosen(key, "type", entries, other_keys, {"none"});
    schema["required"] = {"type"};
    return schema;
  }

  Json friction() {
    return closed_object(
        {{"static", parameter(coefficient("static", "Coefficient of static friction."))},
         {"kinetic", parameter(coefficient("kinetic", "Coefficient of kinetic friction, at most the static one."))},
         {"scale", parameter(scale_spec)}});
  }

  // A coefficient of friction; the material's value is the default.
  static ParameterSpec coefficient(std::string name, std::string doc) {
    ParameterSpec spec = coefficient_spec;
    spec.name = std::move(name);
    spec.doc = std::move(doc);
    return spec;
  }

  Json expect() {
    Json keys = Json::object();
    for (const ExpectationEntry& entry : catalogues_.expectations) {
      const ParameterSpec& limit = entry.parameters.front();
      Json map = closed_object(parameters(entry));
      map["required"] = {limit.name};
      keys[entry.name] = described({{"anyOf", {value(limit), std::move(map)}}}, entry.summary);
    }
    keys["confidence"] = parameter(confidence_spec);
    keys["control"] = parameter(control_spec);
    return closed_object(std::move(keys));
  }

  Json hold() {
    Json schema = closed_object({{"body", described(reference("text"), "Name of a body.")},
                                 {"against", described(reference("text"), "Name of the sensor or body that holds it.")},
                                 {"from", parameter(hold_from_spec)},
                                 {"within", parameter(hold_within_spec)}});
    schema["required"] = {"body", "against"};
    return schema;
  }

  static Json controls() {
    const Json value = reference("any_quantity");
    Json points{
        {"type", "array"}, {"minItems", 1}, {"items", {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}, {"items", value}}}};
    return {{"type", "object"}, {"additionalProperties", {{"anyOf", {value, std::move(points)}}}}};
  }

  Json contact() { return {{"anyOf", {{{"const", "none"}}, define("contact", entry_object(contact_entry, Json::object()))}}}; }

  Json grasp_part(const std::string& name) {
    const auto found = std::ranges::find(catalogues_.grasp, name, &Entry::name);
    if (found == catalogues_.grasp.end()) return false;
    return define(name, entry_object(*found, Json::object()));
  }

  std::map<std::string_view, Json> root_values() {
    std::map<std::string_view, Json> values;
    values["bodies"] = bodies();
    values["box"] = grasp_part("box");
    values["contact"] = contact();
    values["controller"] = loop_part("controller", catalogues_.controllers, Json::object());
    values["controls"] = controls();
    values["description"] = reference("text");
    values["detector"] =
        loop_part("detector", catalogues_.detectors,
                  {{"sensor", described(reference("text"), "Name of the sensor that it reads; required if there are several.")}});
    values["duration"] = plain(duration_spec);
    values["effects"] = list(catalogues_.effects, "effect");
    values["expect"] = expect();
    values["fidelity"] = plain(fidelity_spec);
    values["field_solver"] = plain(field_solver_spec);
    values["friction"] = define("friction", friction());
    values["gravity"] = plain(gravity_spec);
    values["grip"] = grasp_part("grip");
    values["hold"] = hold();
    values["integrator"] = plain(integrator_spec);
    values["model"] = reference("text");
    values["motion"] = chosen("motion", "kind", catalogues_.motions, Json::object());
    values["scatter"] = grasp_part("scatter");
    values["seed"] = {{"type", "integer"}, {"minimum", 0}, {"maximum", UINT64_MAX}};
    values["sensors"] = sensors();
    values["slipbench"] = {{"enum", {1, "1"}}};
    values["split"] = entry_object(split_entry, Json::object());
    values["surface"] = surface();
    values["time_step"] = {{"anyOf", {{{"const", "auto"}}, value(time_step_spec)}}, {"default", "auto"}};
    values["sweep"] = sweep();  // last: it refers to the other definitions
    return values;
  }

  // Rules between keys. A sweep can add keys to the scene, so some rules do not apply to scenes
  // with a sweep.
  Json root_rules() {
    const Json motions = any_of_texts(catalogues_.arm_motions);
    const Json lift = reference("motion_" + default_motion(true).about.name);
    const Json press = reference("motion_" + default_motion(false).about.name);
    const Json arm{{"properties", {{"kind", motions}}}, {"allOf", {without("kind", lift)}}};
    const Json stage{{"properties", {{"kind", negated(motions)}}}, {"allOf", {without("kind", press)}}};
    const Json either = without("kind", {{"anyOf", {press, lift}}});
    const Json none{{"properties", {{"type", {{"const", "none"}}}}}};
    const Json material_alone{{"properties", {{"material", true}}}, {"additionalProperties", false}};
    const Json grasp = has_any({"grip", "box"}), forces = has_any({"bodies", "box", "grip", "model"}), swept = has_any({"sweep"});
    Json rules = Json::array();
    rules.push_back(has_any({"sensors", "sweep"}));
    rules.push_back(
        {{"if", grasp},
         {"then", {{"properties", {{"motion", arm}, {"bodies", false}, {"controls", false}, {"model", false}, {"hold", false}}}}},
         {"else",
          {{"if", swept},
           {"then", {{"properties", {{"motion", either}}}}},
           {"else", {{"properties", {{"motion", stage}, {"controller", none}, {"scatter", false}}}}}}}});
    rules.push_back(
        {{"if", forces},
         {"then", {{"properties", {{"surface", material_alone}}}}},
         {"else",
          {{"if", negated(swept)}, {"then", {{"properties", {{"controls", false}, {"gravity", false}, {"hold", false}}}}}}}});
    rules.push_back(
        {{"if",
          negated(
              {{"anyOf", {swept, {{"properties", {{"fidelity", {{"const", "mujoco_contact"}}}}}, {"required", {"fidelity"}}}}}})},
         {"then", {{"properties", {{"contact", {{"const", "none"}}}}}}}});
    return rules;
  }

  // The draws of a sweep.
  static Json draw() {
    std::vector<std::string_view> names;
    Json rules = Json::array();
    for (const DrawKind& kind : draw_kinds()) {
      names.push_back(kind.name);
      Json keys{{"draw", true}};
      Json required = Json::array();
      for (const auto& list : {kind.required, kind.optional}) {
        for (const std::string_view key : list) {
          keys[std::string(key)] = key == "values" ? Json{{"type", "array"}, {"minItems", 1}} : reference("any_quantity");
        }
      }
      for (const std::string_view key : kind.required) required.push_back(std::string(key));
      Json then = closed_object(std::move(keys));
      then["required"] = std::move(required);
      rules.push_back({{"if", {{"properties", {{"draw", {{"const", std::string(kind.name)}}}}}}}, {"then", std::move(then)}});
    }
    return {
        {"type", "object"}, {"properties", {{"draw", any_of_texts(names)}}}, {"required", {"draw"}}, {"allOf", std::move(rules)}};
  }

  // A list of values that fit `item`, or a draw.
  static Json swept_value(const Json& item) {
    const Json values{{"type", "array"}, {"minItems", 1}, {"items", item}};
    return {{"anyOf", {values, {{"allOf", {reference("draw"), {{"properties", {{"values", {{"items", item}}}}}}}}}}}};
  }

  Json sweep() {
    defs_["draw"] = draw();
    defs_["axis"] = {{"anyOf", {{{"type", "array"}, {"minItems", 1}}, reference("draw")}}};
    std::vector<std::string> keys;
    for (const SceneKey& key : scene_keys()) {
      if (!is_fixed(key.name)) keys.emplace_back(key.name);
    }
    Json properties{{"trials", {{"type", "integer"}, {"minimum", 1}, {"maximum", max_cells}}},
                    {"scene", swept_value({{"type", "object"}, {"propertyNames", any_of_texts(keys)}})}};
    for (const std::string& key : keys) properties[key] = reference("axis");
    for (const auto& spec : {duration_spec, fidelity_spec, field_solver_spec, gravity_spec, integrator_spec})
      properties[spec.name] = swept_value(value(spec));
    // The parameters of sections with closed maps; the values fit one of the entries with that
    // parameter.
    std::map<std::string, Json> schemas;
    const auto add = [&](const std::string& section, const std::string& key, const std::string& definition) {
      Json& any = schemas[section + "." + key];
      any.push_back(reference(definition + "/properties/" + key));
    };
    const auto add_entries = [&](const std::string& section, const std::vector<Entry>& entries) {
      for (const Entry& entry : entries) {
        for (const ParameterSpec& spec : entry.parameters) add(section, spec.name, section + "_" + entry.name);
      }
    };
    add_entries("motion", catalogues_.motions);
    add_entries("surface", catalogues_.surfaces);
    add_entries("detector", catalogues_.detectors);
    add_entries("controller", catalogues_.controllers);
    for (const Entry& entry : catalogues_.grasp) {
      for (const ParameterSpec& spec : entry.parameters) add(entry.name, spec.name, entry.name);
    }
    for (const ParameterSpec& spec : contact_entry.parameters) add("contact", spec.name, "contact");
    for (const char* key : {"static", "kinetic", "scale"}) add("friction", key, "friction");
    add("surface", "material", "surface_plane");
    std::set<std::string> sections;
    for (const auto& [path, any] : schemas) {
      sections.insert(path.substr(0, path.find('.')));
      properties[path] = swept_value({{"anyOf", any}});
    }
    for (const char* path : {"motion.kind", "surface.shape", "detector.type", "controller.type", "detector.sensor"})
      properties[path] = swept_value(reference("text"));
    Json schema = closed_object(std::move(properties));
    schema["patternProperties"] = {{R"(^(sensors|bodies|effects|controls|hold)\.)", reference("axis")},
                                   {fmt::format(R"(^({})\.[a-z_A-Z0-9]+\.)", fmt::join(sections, "|")), reference("axis")}};
    return schema;
  }

  const Catalogues& catalogues_;
  Json defs_ = Json::object();
};

}  // namespace

Json scene_schema(const Catalogues& catalogues) { return SceneSchema(catalogues).build(); }

}  // namespace slipbench
