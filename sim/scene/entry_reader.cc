#include "sim/scene/entry_reader.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>
#include <variant>

#include <nlohmann/json.hpp>

#include "sim/core/counted.h"
#include "sim/core/process/named_files.h"
#include "sim/scene/scene_values.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

// True for what the command line or a caller in C++ or Python gave, false for a file, standard
// input, and the scene and the overrides in a dataset. The name of the source does not count: a file may have any.
bool is_callers_own(const Origin& origin) { return !origin.source || origin.callers_own; }

// True if files that the scene names are checked: not for the scene in a dataset, whose files other code opens.
bool is_file_or_stdin(const std::string& source) {
  std::error_code error;
  return source == "<stdin>" || fs::is_regular_file(source, error);
}

std::string allowed_form(const ParameterSpec& spec) {
  switch (spec.type) {
    case ParameterType::number: return "a number such as " + spec.default_text;
    case ParameterType::integer: return "a whole number such as " + spec.default_text;
    case ParameterType::flag: return "true or false";
    case ParameterType::choice: return "a name such as " + spec.default_text;
    case ParameterType::vector: return "a sequence of " + std::to_string(spec.size) + " such as " + spec.default_text;
    case ParameterType::path: return "a path relative to the scene's folder, or " + spec.default_text;
    case ParameterType::map:
      return spec.choices.empty() ? "a map of numbers, texts and booleans such as {threshold: 0.3}"
                                  : "a map of names such as {a: " + spec.choices.front() + "}";
    case ParameterType::table: return "rows of numbers, [[a, b, ...], ...], the path of a CSV file, or " + spec.default_text;
  }
  throw std::logic_error("no such parameter type");
}

struct ToJson {
  std::string operator()(double value) const { return json_number(value); }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const { return json_text(value); }
  std::string operator()(const std::vector<double>& values) const {
    std::string text = "[";
    for (const double value : values) text.append(text.size() > 1 ? "," : "").append(json_number(value));
    return text.append("]");
  }
  std::string operator()(const NumberTable& table) const {
    if (!table.path.empty()) return json_text(table.path);
    std::string text = "[";
    for (const std::vector<double>& row : table.rows) {
      std::string cells;
      for (const double value : row) {
        if (!std::isnan(value)) cells.append(cells.empty() ? "" : ",").append(json_number(value));
      }
      text.append(text.size() > 1 ? ",[" : "[").append(cells).append("]");
    }
    return text.append("]");
  }
  std::string operator()(const ParameterMap&) const { throw std::logic_error("a map is recorded by its entries"); }
};

// Returns a value without a declaration: true, false, a number with or without a unit in SI, else
// text.
Parameters::Value undeclared_value(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  try {
    return parse_quantity(text, quantity_of(text));
  } catch (const std::invalid_argument&) {
    return text;
  }
}

}  // namespace

std::string json_text(const std::string& text) { return nlohmann::json(text).dump(); }

std::string json_number(double value) { return std::isfinite(value) ? format_number(value) : json_text(format_number(value)); }

const std::string& text_of(const YamlNode& node, std::string_view path, std::string_view allowed) {
  if (node.kind != YamlNode::Kind::scalar)
    fail(node.origin, std::string(path) + " is " + described(node) + "; allowed: " + std::string(allowed));
  return node.text;
}

void EntryReader::record(const std::string& path, const Parameters::Value& value, Quantity quantity, const std::string& written) {
  if (trace_ != nullptr) trace_->insert_or_assign(path, ReadValue{std::visit(ToJson{}, value), quantity, written});
}

void require_map(const YamlNode& node, const std::string& where, const std::string& allowed) {
  if (node.kind != YamlNode::Kind::map) fail(node.origin, where + " is " + described(node) + "; allowed: a map of " + allowed);
}

void check_keys(const YamlNode& map, const std::string& where, const std::vector<std::string_view>& allowed) {
  for (const YamlNode& child : map.children) {
    if (std::ranges::find(allowed, child.key) == allowed.end()) {
      fail(child.key_origin, "unknown key " + quote(child.key) + " in " + where + allowed_names(child.key, allowed));
    }
  }
}

Parameters::Value scalar(const YamlNode& node, const std::string& path, const ParameterSpec& spec) {
  if (node.kind != YamlNode::Kind::scalar)
    fail(node.origin, path + " is " + described(node) + "; allowed: " + allowed_form(spec));
  try {
    return parse_scalar(spec, node.text);
  } catch (const std::invalid_argument& error) {
    fail(node.origin, path + ": " + error.what());
  }
}

Parameters::Value EntryReader::value(const YamlNode* node, const std::string& path, const ParameterSpec& spec) {
  if (spec.type == ParameterType::map) return node == nullptr ? default_of(spec) : map(*node, path, spec);
  if (spec.type == ParameterType::table) return table(node, path, spec);
  Parameters::Value result = node == nullptr                      ? default_at(path, spec)
                             : spec.type == ParameterType::vector ? vector(*node, path, spec)
                                                                  : scalar(*node, path, spec);
  record(path, result, spec.quantity, node == nullptr ? std::string() : node->text);
  if (node != nullptr && spec.type == ParameterType::path && node->text != spec.default_text &&
      std::ranges::find(spec.choices, node->text) == spec.choices.end())
    return resolved_path(*node, path, spec.name == "library" ? FileUse::library : FileUse::part);
  return result;
}

std::string EntryReader::resolved_path(const YamlNode& node, const std::string& path, FileUse use) const {
  const fs::path folder = node.origin.typed || !root_.source ? fs::path() : fs::path(*root_.source).parent_path();
  const fs::path file = folder / node.text;
  const bool checks = use == FileUse::table || (root_.source && is_file_or_stdin(*root_.source));
  if (use != FileUse::library && checks && !is_callers_own(node.origin))
    check_named_file(file, folder, node.origin.text() + ": " + path, "--set " + path + "=PATH");
  return file.string();
}

Parameters::Value EntryReader::default_at(const std::string& path, const ParameterSpec& spec) const {
  if (protocol_ == nullptr || !protocol_->defaults.contains(path)) return default_of(spec);
  return parse_scalar(spec, protocol_->defaults.at(path));
}

Parameters::Value EntryReader::vector(const YamlNode& node, const std::string& path, const ParameterSpec& spec) {
  if (node.kind != YamlNode::Kind::sequence)
    fail(node.origin, path + " is " + described(node) + "; allowed: " + allowed_form(spec));
  if (node.children.size() != spec.size) {
    fail(node.origin, path + " has " + counted(node.children.size(), "entry") + "; allowed: " + allowed_form(spec));
  }
  std::vector<double> entries;
  for (std::size_t i = 0; i < spec.size; ++i) {
    const std::string entry_path = path + "." + std::to_string(i);
    entries.push_back(std::get<double>(scalar(node.children[i], entry_path, spec)));
    record(entry_path, entries.back(), spec.quantity, node.children[i].text);
  }
  return entries;
}

Parameters::Value EntryReader::map(const YamlNode& node, const std::string& path, const ParameterSpec& spec) {
  if (node.kind != YamlNode::Kind::map) fail(node.origin, path + " is " + described(node) + "; allowed: " + allowed_form(spec));
  ParameterMap entries;
  for (const YamlNode& child : node.children) {
    if (!is_identifier(child.key)) {
      fail(child.key_origin,
           quote(child.key) + " is not a valid name of a parameter; allowed: letters, digits and '_', no digit first");
    }
    const std::string entry_path = path + "." + child.key;
    const std::string& text = text_of(child, entry_path, "a number, a text, true or false");
    if (!spec.choices.empty()) {
      static_cast<void>(scalar(child, entry_path, choice_spec(spec.name, spec.choices.front(), spec.choices, "", "")));
    }
    record(entry_path, undeclared_value(text));
    entries.emplace_back(child.key, text);
  }
  return entries;
}

Parameters::Value EntryReader::table(const YamlNode* node, const std::string& path, const ParameterSpec& spec) {
  NumberTable table;
  const bool none = node == nullptr || (node->kind == YamlNode::Kind::scalar && node->text == spec.default_text);
  if (none) {
    record(path, spec.default_text);
    return table;
  }
  const bool in_file = node->kind == YamlNode::Kind::scalar;
  const YamlNode rows = in_file ? read_csv(resolved_path(*node, path, FileUse::table), spec.columns, node->origin) : *node;
  if (rows.kind != YamlNode::Kind::sequence || rows.children.empty())
    fail(rows.origin, path + " is " + described(rows) + "; allowed: " + allowed_form(spec));
  std::string needed = spec.columns.empty() ? "as many numbers as in the first row" : "";
  for (std::size_t i = 0; i < spec.columns.size(); ++i) {
    needed += (i == 0 ? "" : ", ") + spec.columns[i].name + (i < spec.size ? "" : " or none");
  }
  for (const YamlNode& row : rows.children) {
    const std::size_t width = row.children.size(), first = rows.children.front().children.size();
    const bool fits = spec.columns.empty() ? width == first : width >= spec.size && width <= spec.columns.size();
    if (row.kind != YamlNode::Kind::sequence || row.children.empty() || !fits)
      fail(row.origin, path + ": a row is " + described(row) + " of " + std::to_string(width) + "; allowed: " + needed);
    std::vector<double>& values = table.rows.emplace_back();
    for (std::size_t i = 0; i < width; ++i) {
      const Quantity quantity = spec.columns.empty() ? Quantity::none : spec.columns[i].quantity;
      const ParameterSpec cell = number_spec(spec.name, quantity, "1", any_value, "", "");
      const bool left_out = row.children[i].kind == YamlNode::Kind::null && i >= spec.size;
      values.push_back(left_out ? std::nan("") : std::get<double>(scalar(row.children[i], path, cell)));
    }
    values.resize(std::max(width, spec.columns.size()), std::nan(""));
  }
  if (in_file) table.path = node->text;  // as written in the scene
  record(path, table);
  if (in_file) table.path = resolved_path(*node, path, FileUse::table);
  return table;
}

Parameters EntryReader::parameters(const YamlNode* map, const std::string& path, const std::string& where, const Entry& entry,
                                   const std::vector<std::string_view>& other_keys) {
  if (map != nullptr) {
    std::vector<std::string_view> allowed = names_of(entry.parameters);
    allowed.insert(allowed.end(), other_keys.begin(), other_keys.end());
    std::ranges::sort(allowed);
    check_keys(*map, where, allowed);
  }
  Parameters result;
  for (const ParameterSpec& spec : entry.parameters) {
    result.set(spec.name, value(map == nullptr ? nullptr : map->find(spec.name), path + "." + spec.name, spec));
  }
  return result;
}

Named EntryReader::read_kind(const YamlNode* node, const std::string& path, const std::string& selector,
                             const std::string& default_name, const std::vector<Entry>& entries, const std::string& noun,
                             std::vector<std::string_view> other_keys) {
  if (node != nullptr) require_map(*node, path, "'" + selector + "' and parameters");
  const YamlNode* choice = node == nullptr ? nullptr : node->find(selector);
  const std::string name =
      choice == nullptr ? default_name : text_of(*choice, path + "." + selector, "a name such as " + default_name);
  const Origin origin = choice != nullptr ? choice->origin : node != nullptr ? node->origin : root_;
  const Entry& entry = named(entries, name, origin, noun);
  record(path + "." + selector, name);
  other_keys.push_back(selector);
  return {name, parameters(node, path, path, entry, other_keys)};
}

std::vector<Named> EntryReader::read_list(const YamlNode* node, const std::string& path, const std::vector<Entry>& entries,
                                          const std::string& noun) {
  std::vector<Named> list;
  if (node == nullptr) return list;
  if (node->kind != YamlNode::Kind::sequence) {
    fail(node->origin, path + " is " + described(*node) + "; allowed: a sequence of names or of {name: {parameters}}");
  }
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < node->children.size(); ++i) {
    const YamlNode& item = node->children[i];
    const std::string item_path = path + "." + std::to_string(i);
    if (item.kind != YamlNode::Kind::scalar && (item.kind != YamlNode::Kind::map || item.children.size() != 1)) {
      const std::string found =
          item.kind == YamlNode::Kind::map ? "a map of " + counted(item.children.size(), "key") : described(item);
      fail(item.origin, item_path + " is " + found + "; allowed: a name, or one {name: {parameters}}");
    }
    const bool bare = item.kind == YamlNode::Kind::scalar;
    const std::string& name = bare ? item.text : item.children.front().key;
    const Origin& origin = bare ? item.origin : item.children.front().key_origin;
    const Entry& entry = named(entries, name, origin, noun);
    if (!seen.insert(entry.name).second) fail(origin, noun + " " + quote(name) + " is named twice in " + path);
    const YamlNode* map = bare || item.children.front().kind == YamlNode::Kind::null ? nullptr : &item.children.front();
    if (map != nullptr) require_map(*map, path + "." + name, "parameters");
    if (bare) record(item_path, name);
    list.push_back({name, parameters(map, item_path + "." + name, name, entry, {})});
  }
  return list;
}

ExpectScene ExpectationReader::read(const YamlNode& node, const Scene& scene, const std::vector<ExpectationEntry>& catalogue) {
  require_map(node, "expect", "expectations, such as 'gross_slip_by: 1.0 s'");
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
    fail(node.origin,
         "no key 'limit' in " + path + "; it gives the bound of the expectation, such as 'limit: " + limit.default_text + "'");
  }
  return {entry.name, parameters(&node, path, path, entry, {})};
}

std::string ExpectationReader::read_control(const YamlNode* node, const Scene& scene) {
  if (node == nullptr) return scene.controller ? negative_control : "";
  if (std::get<std::string>(value(node, "expect.control", control_spec)) == "none") return "";
  if (!scene.controller)
    fail(node->origin, "expect.control replaces the controller, but the scene has no controller; leave it out");
  return negative_control;
}

}  // namespace slipbench
