#include "tools/cli/format/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/api/detector.h"
#include "sim/api/pad_state_names.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/scene/scene.h"
#include "sim/scene/scene_values.h"
#include "tools/files/reject.h"
#include "tools/statistics/confusion.h"
#include "tools/statistics/descriptive.h"
#include "tools/train/recipe_list.h"

namespace slipbench {
namespace {

constexpr CatalogueKind effects{"effects", "effect", "effects"};
constexpr CatalogueKind sensors{"sensors", "sensor", "sensors.<name>.type"};
constexpr CatalogueKind surfaces{"surfaces", "surface", "surface.shape"};
constexpr CatalogueKind bodies{"bodies", "body", "bodies.<name>.shape"};
constexpr CatalogueKind materials{"materials", "material", "surface.material"};
constexpr CatalogueKind motions{"motions", "motion", "motion.kind"};
constexpr CatalogueKind electronics{"electronics", "electronics part", "sensors.<name>.electronics"};
constexpr CatalogueKind grasp{"grasp", "part of a grasp", "box, grip, scatter"};
constexpr CatalogueKind contact{"contact", "part of fidelity mujoco_contact", "contact"};
constexpr CatalogueKind detectors{"detectors", "detector", "detector.type"};
constexpr CatalogueKind oracle{detectors.plural, "oracle", detectors.use};
constexpr CatalogueKind controllers{"controllers", "controller", "controller.type"};
constexpr CatalogueKind expectations{"expectations", "expectation", "expect"};
constexpr std::array kinds{effects,     sensors, surfaces, bodies,    materials,   motions,
                           electronics, grasp,   contact,  detectors, controllers, expectations};

std::string type_text(const ParameterSpec& spec) {
  constexpr std::array names{"number", "integer", "true or false", "choice", "", "path", "map", "table"};
  return spec.type == ParameterType::vector ? fmt::format("{} numbers", spec.size)
                                            : names.at(static_cast<std::size_t>(spec.type));
}

bool has_unit(const ParameterSpec& spec) { return spec.type == ParameterType::number || spec.type == ParameterType::vector; }

// "m/s (also mm/s, cm/s)"
std::string unit_text(const ParameterSpec& spec) {
  if (!has_unit(spec)) return "none";
  std::string others;
  for (const Unit& unit : units_of(spec.quantity)) {
    if (unit.symbol == si_symbol(spec.quantity) || unit.symbol.empty()) continue;
    others += (others.empty() ? "" : ", ") + std::string(unit.symbol);
  }
  const std::string unit = spec.quantity == Quantity::none ? "none" : std::string(si_symbol(spec.quantity));
  return others.empty() ? unit : fmt::format("{} (also {})", unit, others);
}

std::string bound_text(const ParameterSpec& spec, double value, Bound side) {
  return spec.type == ParameterType::integer ? fmt::format("{}", value)
                                             : bound_in_unit_of(spec.default_text, value, spec.quantity, side);
}

// The parameters at their defaults as YAML lines.
std::string parameter_lines(const Entry& entry, std::size_t indent) {
  std::string text;
  for (const ParameterSpec& spec : entry.parameters) {
    text += fmt::format("{}{}: {}\n", std::string(indent, ' '), spec.name, spec.default_text);
  }
  return text;
}

std::string list_item(const Entry& entry, std::size_t indent) {
  const std::string margin(indent, ' ');
  if (entry.parameters.empty()) return fmt::format("{}- {}\n", margin, entry.name);
  return fmt::format("{}- {}:\n", margin, entry.name) + parameter_lines(entry, indent + 4);
}

std::string parameter_text(const ParameterSpec& spec, const Style& style, std::size_t width) {
  constexpr std::size_t indent = 6;
  std::string text = fmt::format("  {}  {}\n", style.bold(spec.name), style.dim(type_text(spec)));
  if (!spec.doc.empty()) text += wrap_text(spec.doc, width, indent);
  if (has_unit(spec)) text += wrap_text("unit:    " + unit_text(spec), width, indent);
  text += wrap_text("default: " + spec.default_text, width, indent);
  text += wrap_text("allowed: " + allowed_text(spec), width, indent);
  if (!spec.source.empty()) text += wrap_text("source:  " + spec.source, width, indent);
  return text;
}

Json parameter_json(const ParameterSpec& spec) {
  Json json{{"name", spec.name}, {"type", type_text(spec)}};
  json["unit"] = has_unit(spec) ? std::string(si_symbol(spec.quantity)) : "";
  json["units"] = Json::array();
  if (has_unit(spec)) {
    for (const Unit& unit : units_of(spec.quantity)) json["units"].push_back(std::string(unit.symbol));
  }
  json["default"] = spec.default_text;
  json["allowed"] = allowed_text(spec);
  json["choices"] = spec.choices;
  json["doc"] = spec.doc;
  json["source"] = spec.source;
  return json;
}

CatalogueItem material_item(const Material& material) {
  Entry entry;
  entry.name = material.name;
  entry.summary = fmt::format("mu_static {}, mu_kinetic {}", material.mu_static, material.mu_kinetic);
  entry.source = material.source;
  return {materials, std::move(entry), material};
}

// The items of `kind`, each name once.
std::vector<CatalogueItem> items_of(const std::vector<CatalogueItem>& items, const CatalogueKind& kind) {
  std::vector<CatalogueItem> found;
  for (const CatalogueItem& item : items) {
    const auto same = [&](const CatalogueItem& other) { return other.entry.name == item.entry.name; };
    if (item.kind.plural == kind.plural && std::ranges::none_of(found, same)) found.push_back(item);
  }
  return found;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const CatalogueKind& kind : kinds) names.emplace_back(kind.plural);
  names.emplace_back("recipes");  // recipes are not a catalogue of scenes
  return names;
}

// A name with its summary, wrapped from column `column` + 4 on.
std::string named_line(const std::string& name, const std::string& summary, std::size_t column, std::size_t width) {
  std::string lines = wrap_text(summary, width, column + 4);
  // The name replaces the margin of the first line.
  return lines.replace(0, column + 4, fmt::format("  {}{}  ", name, std::string(column - name.size(), ' ')));
}

std::string percent(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", 100.0 * value); }
std::string percent(const MeanSd& value) { return fmt::format("{} +- {}", percent(value.mean), percent(value.sd)); }
std::string milliseconds(double value) { return std::isnan(value) ? "-" : fmt::format("{:.1f}", 1e3 * value); }

// Accuracy comes last: frequent classes dominate it.
struct Figure {
  const char* name;
  double (*measure)(const Confusion&);
  Confusion Evaluation::*frames;
};
constexpr std::array figures{Figure{"recall of slip", recall_of_slip, &Evaluation::all},
                             Figure{"balanced accuracy", balanced_accuracy, &Evaluation::all},
                             Figure{"balanced accuracy of a constant detector", constant_balanced_accuracy, &Evaluation::all},
                             Figure{"moving frames: recall of slip", recall_of_slip, &Evaluation::moving},
                             Figure{"moving frames: balanced accuracy", balanced_accuracy, &Evaluation::moving},
                             Figure{"accuracy", accuracy, &Evaluation::all},
                             Figure{"accuracy of the best constant detector", constant_accuracy, &Evaluation::all}};

}  // namespace

std::string allowed_text(const ParameterSpec& spec) {
  if (spec.type == ParameterType::choice) return fmt::format("{}", fmt::join(spec.choices, ", "));
  if (spec.type == ParameterType::flag) return "true, false";
  if (spec.type == ParameterType::path) {
    const char* const separator = spec.choices.empty() ? "" : ", ";
    return fmt::format("{}{}{}, or a path relative to the scene's folder", spec.default_text, separator,
                       fmt::join(spec.choices, ", "));
  }
  if (spec.type == ParameterType::map) {
    return spec.choices.empty() ? "numbers, texts and booleans by name, as the library declares them"
                                : fmt::format("names of your choice, each with one of {}", fmt::join(spec.choices, ", "));
  }
  if (spec.type == ParameterType::table) {
    std::string columns;
    for (const TableColumn& column : spec.columns) {
      columns += " " + column.name;
      if (column.quantity != Quantity::none) columns += fmt::format(" [{}]", si_symbol(column.quantity));
    }
    return fmt::format("{}, rows of{}, or the path of a CSV file{}", spec.default_text, columns.empty() ? " numbers" : columns,
                       columns.empty() ? "" : " with a header of these names");
  }
  const bool below = std::isfinite(spec.range.min);
  const bool above = std::isfinite(spec.range.max);
  const std::string lower =
      below ? fmt::format("{} {}", spec.range.open_min ? ">" : ">=", bound_text(spec, spec.range.min, Bound::lower)) : "";
  const std::string upper = above ? "<= " + bound_text(spec, spec.range.max, Bound::upper) : "";
  if (below && above) return lower + " and " + upper;
  return below || above ? lower + upper : "any value";
}

std::span<const CatalogueKind> catalogue_kinds() { return kinds; }

std::vector<CatalogueItem> catalogue_items(const Catalogues& catalogues) {
  std::vector<CatalogueItem> items;
  const auto add_all = [&items](const CatalogueKind& kind, const std::vector<Entry>& entries) {
    for (const Entry& entry : entries) {
      const bool is_oracle = kind.plural == detectors.plural && entry.name == oracle_type;
      items.push_back({is_oracle ? oracle : kind, entry});
    }
  };
  add_all(effects, catalogues.effects);
  add_all(sensors, catalogues.sensors);
  add_all(surfaces, catalogues.surfaces);
  add_all(bodies, catalogues.bodies);
  for (const Material& material : catalogues.materials) items.push_back(material_item(material));
  add_all(motions, catalogues.motions);
  for (const Entry& sensor : catalogues.sensors) {
    if (!catalogues.electronics.contains(sensor.name)) continue;
    for (const Entry& part : catalogues.electronics.at(sensor.name)) items.push_back({electronics, part, {}, sensor.name});
  }
  add_all(grasp, catalogues.grasp);
  items.push_back({contact, contact_entry});
  add_all(detectors, catalogues.detectors);
  add_all(controllers, catalogues.controllers);
  for (const ExpectationEntry& entry : catalogues.expectations) items.push_back({expectations, entry});
  return items;
}

std::vector<CatalogueItem> find_items(const std::vector<CatalogueItem>& items, const std::string& name,
                                      const std::vector<std::string>& others) {
  std::vector<CatalogueItem> found;
  std::ranges::copy_if(items, std::back_inserter(found), [&](const CatalogueItem& item) { return item.entry.name == name; });
  if (found.empty()) {
    std::vector<std::string> names;
    for (const CatalogueItem& item : items) names.push_back(item.entry.name);
    names.insert(names.end(), others.begin(), others.end());
    reject("describe: unknown name {}{} `slipbench list` shows all names", quote(name), suggestion(name, names));
  }
  return found;
}

CatalogueKind find_kind(const std::string& plural) {
  const auto* const found = std::ranges::find(kinds, plural, &CatalogueKind::plural);
  if (found == kinds.end()) reject("list: unknown catalogue {}{}", quote(plural), allowed_names(plural, kind_names()));
  return *found;
}

std::string scene_example(const CatalogueItem& item, const Catalogues& catalogues) {
  const Entry& entry = item.entry;
  if (item.material) return fmt::format("surface: {{material: {}}}\n", entry.name);
  if (item.kind.plural == effects.plural) return "effects:\n" + list_item(entry, 2);
  if (item.kind.plural == sensors.plural)
    return fmt::format("sensors:\n  pad:\n    type: {}\n", entry.name) + parameter_lines(entry, 4);
  if (item.kind.plural == surfaces.plural) return fmt::format("surface:\n  shape: {}\n", entry.name) + parameter_lines(entry, 2);
  if (item.kind.plural == bodies.plural) {
    const std::string& touching = catalogues.sensors.front().name;
    return fmt::format("bodies:\n  object:\n    shape: {}\n{}sensors:\n  pad:\n    type: {}\n    touches: [object]\n", entry.name,
                       parameter_lines(entry, 4), touching);
  }
  if (item.kind.plural == detectors.plural) return fmt::format("detector:\n  type: {}\n", entry.name) + parameter_lines(entry, 2);
  if (item.kind.plural == controllers.plural) {
    return fmt::format("grip: {{}}\ncontroller:\n  type: {}\n", entry.name) + parameter_lines(entry, 2);
  }
  if (item.kind.plural == expectations.plural) {
    const auto declared = std::ranges::find(catalogues.expectations, entry.name, &ExpectationEntry::name);
    const std::string gripper = declared->of_grasp ? "grip: {}\n" : "";
    const std::string detector =
        declared->of_detector ? fmt::format("detector: {{type: {}}}\n", catalogues.detectors.front().name) : "";
    return gripper + detector + fmt::format("expect:\n  {}:\n", entry.name) + parameter_lines(entry, 4);
  }
  if (item.kind.plural == grasp.plural) {
    const std::string key = entry.name + ":\n" + parameter_lines(entry, 2);
    return entry.name == "scatter" ? "grip: {}\n" + key : key;
  }
  if (item.kind.plural == contact.plural) {
    // Most materials have two coefficients of friction, but MuJoCo's contact has one. With its
    // defaults, tips of 0.1 g bounce at a step of 1 ms; these values are stable.
    return fmt::format(
        "fidelity: mujoco_contact\nfriction: {{static: 0.5, kinetic: 0.5}}\n{}:\n  integrator: discrete\n  cone: elliptic\n"
        "  impratio: 10\n  solref: [0.002, 1]\n  solimp: [0.99, 0.999, 0.001]\n  tip_mass: 10 g\n",
        entry.name);
  }
  if (item.kind.plural == motions.plural) {
    const bool of_arm = std::ranges::find(catalogues.arm_motions, entry.name) != catalogues.arm_motions.end();
    const std::string arm = of_arm ? "grip: {}\n" : "";
    return arm + fmt::format("motion:\n  kind: {}\n", entry.name) + parameter_lines(entry, 2);
  }
  return fmt::format("sensors:\n  pad:\n    type: {}\n    electronics:\n", item.sensor) + list_item(entry, 6);
}

std::string describe_text(const CatalogueItem& item, const Catalogues& catalogues, const Style& style, std::size_t width) {
  const Entry& entry = item.entry;
  const std::string kind = std::string(item.kind.singular) + (item.sensor.empty() ? "" : " of " + item.sensor);
  std::string text = fmt::format("{}  {}\n", style.heading(entry.name), style.dim(kind));
  text += wrap_text(entry.summary, width, 2);
  if (item.material) {
    text += fmt::format("\n{}\n", style.bold("Friction against the pad's silicone"));
    text += fmt::format("  mu_static  {}\n  mu_kinetic {}\n", item.material->mu_static, item.material->mu_kinetic);
  }
  // A law is a set of equations: its line breaks are kept.
  if (!entry.law.empty()) text += fmt::format("\n{}\n", style.bold("Law")) + wrap_text(entry.law, width, 2);
  if (!entry.source.empty()) text += fmt::format("\n{}\n", style.bold("Source")) + wrap_text(entry.source, width, 2);
  if (!entry.parameters.empty()) {
    text += fmt::format("\n{}\n", style.bold("Parameters"));
    for (const ParameterSpec& spec : entry.parameters) text += parameter_text(spec, style, width);
  }
  text += fmt::format("\n{} ({})\n", style.bold("In a scene"), item.kind.use);
  // Not wrapped, for copying.
  text += wrap_text(scene_example(item, catalogues), std::string::npos, 2);
  return text;
}

Json describe_json(const CatalogueItem& item, const Catalogues& catalogues) {
  const Entry& entry = item.entry;
  Json json{{"kind", std::string(item.kind.singular)},
            {"name", entry.name},
            {"summary", entry.summary},
            {"law", entry.law},
            {"source", entry.source}};
  if (!item.sensor.empty()) json["sensor"] = item.sensor;
  if (item.material) {
    json["mu_static"] = item.material->mu_static;
    json["mu_kinetic"] = item.material->mu_kinetic;
  }
  json["parameters"] = Json::array();
  for (const ParameterSpec& spec : entry.parameters) json["parameters"].push_back(parameter_json(spec));
  json["scene_key"] = std::string(item.kind.use);
  json["example"] = scene_example(item, catalogues);
  return json;
}

std::string list_text(const std::vector<CatalogueItem>& items, std::span<const CatalogueKind> shown, const Style& style,
                      std::size_t width) {
  std::size_t column = 0;
  for (const CatalogueItem& item : items) column = std::max(column, item.entry.name.size());
  std::string text;
  for (const CatalogueKind& kind : shown) {
    if (!text.empty()) text += '\n';
    text += fmt::format("{}  {}\n", style.heading(kind.plural), style.dim(fmt::format("scene key {}", kind.use)));
    const std::vector<CatalogueItem> listed = items_of(items, kind);
    for (const CatalogueItem& item : listed) text += named_line(item.entry.name, item.entry.summary, column, width);
    if (listed.empty()) text += "  (none)\n";
  }
  return text;
}

Json list_json(const std::vector<CatalogueItem>& items, std::span<const CatalogueKind> shown) {
  Json json = Json::object();
  for (const CatalogueKind& kind : shown) {
    Json& list = json[std::string(kind.plural)] = Json::array();
    for (const CatalogueItem& item : items_of(items, kind)) {
      list.push_back({{"name", item.entry.name}, {"summary", item.entry.summary}});
    }
  }
  return json;
}

std::string recipe_list_text(const Style& style, std::size_t width) {
  std::size_t column = 0;
  for (const train::RecipeLine& recipe : train::recipe_list()) column = std::max(column, recipe.name.size());
  std::string text = fmt::format("{}  {}\n", style.heading("recipes"), style.dim("slipbench train --recipe"));
  for (const train::RecipeLine& recipe : train::recipe_list())
    text += named_line(std::string(recipe.name), std::string(recipe.summary), column, width);
  return text;
}

Json recipe_list_json() {
  Json list = Json::array();
  for (const train::RecipeLine& recipe : train::recipe_list())
    list.push_back({{"name", recipe.name}, {"summary", recipe.summary}});
  return list;
}

std::string draws_text(const HdSummary& summary, const Style& style) {
  Table table({"in %", "by sequence", "draw 0", "by frame"});
  for (const Figure& row : figures) {
    const auto figure = [&](const Evaluation& e) { return row.measure(e.*row.frames); };
    table.add({row.name, percent(over_draws(summary.by_sequence, figure)), percent(figure(summary.by_sequence.front())),
               percent(over_draws(summary.by_frame, figure))});
  }
  return table.text(style);
}

std::string confusion_text(const Confusion& confusion, const Style& style) {
  std::vector<std::string> head{"true class"};
  for (const PadStateName& called : pad_states_in_contact) head.push_back(fmt::format("detected {}", called.title));
  head.emplace_back("recall in %");
  Table table(head);
  for (const PadStateName& truth : pad_states_in_contact) {
    std::vector<std::string> row{truth.title};
    for (const PadStateName& called : pad_states_in_contact)
      row.push_back(std::to_string(samples_in(confusion, truth.value, called.value)));
    row.push_back(percent(recall(confusion, truth.value)));
    table.add(std::move(row));
  }
  return table.text(style);
}

std::string delays_text(const Delays& delays) {
  return fmt::format(
      "  delay after the true onset: median {} ms, quartiles {} and {} ms, over {} sequences\n"
      "  slipping sequences: {}, detected {}, early {} (slip reported before the onset), missed {}; sequences without slip: {}, false alarms {}\n",
      milliseconds(median(delays.delay)), milliseconds(quantile(delays.delay, 0.25)), milliseconds(quantile(delays.delay, 0.75)),
      delays.delay.size(), delays.slipping, delays.delay.size(), delays.early, delays.missed, delays.sequences - delays.slipping,
      delays.false_alarms);
}

}  // namespace slipbench
