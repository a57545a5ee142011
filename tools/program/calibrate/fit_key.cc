#include "tools/program/calibrate/fit_key.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench::calibrate {
namespace {

const std::string& scalar_text(const YamlNode& node, const std::string& where, const std::string& allowed) {
  return text_of(node, where, allowed);
}

bool chosen(const YamlNode& map, const char* key, const std::string& path, std::string_view no, std::string_view yes) {
  const YamlNode* node = map.find(key);
  if (node == nullptr) return false;
  const std::string where = path + "." + key;
  const std::string text = scalar_text(*node, where, fmt::format("{} or {}", no, yes));
  if (text != no && text != yes) fail(node->origin, fmt::format("{} is {}; allowed: {} or {}", where, quote(text), no, yes));
  return text == yes;
}

FitKey read_fit_key(const YamlNode& node) {
  FitKey key{.path = node.key};
  static_cast<void>(split_path(key.path, node.key_origin));
  require_map(node, key.path, "{min: .., max: ..}");
  check_keys(node, key.path, {"draw", "each", "max", "min"});
  const auto bound = [&](const char* name) {
    const YamlNode* found = node.find(name);
    if (found == nullptr) fail(node.origin, fmt::format("no key '{}' in {}; allowed: {{min: .., max: ..}}", name, key.path));
    const std::string where = key.path + "." + name;
    const std::string text = scalar_text(*found, where, "a number");
    try {
      const Quantity quantity = quantity_of(text);
      if (key.quantity != Quantity::none && quantity != Quantity::none && quantity != key.quantity)
        fail(found->origin, fmt::format("{} is {}; allowed: a number in {}", where, quote(text), si_symbol(key.quantity)));
      if (quantity != Quantity::none) key.quantity = quantity;
      return parse_quantity(text, quantity);
    } catch (const std::invalid_argument& error) {
      fail(found->origin, where + ": " + error.what());
    }
  };
  key.min = bound("min");
  key.max = bound("max");
  key.logarithmic = chosen(node, "draw", key.path, "uniform", "log_uniform");
  key.each = chosen(node, "each", key.path, "false", "true");
  if (!(key.min < key.max) || !std::isfinite(key.max - key.min))
    fail(node.origin, fmt::format("{}: min is {} and max is {}; allowed: finite bounds, min below max", key.path,
                                  format_quantity(key.min, key.quantity), format_quantity(key.max, key.quantity)));
  if (key.logarithmic && !(key.min > 0.0))
    fail(node.origin,
         fmt::format("{}: min is {}; allowed with draw: log_uniform: above 0", key.path, format_quantity(key.min, key.quantity)));
  return key;
}

// A scalar inside [] and {}: as it is where it says the same there, else in quotes, whose rules JSON shares.
std::string scalar(const std::string& text) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view(" ./_%+-()").find(c) != std::string_view::npos;
  };
  const bool begins =
      !text.empty() && (std::isalnum(static_cast<unsigned char>(text.front())) != 0 ||
                        (text.size() > 1 && text.front() == '-' && std::isdigit(static_cast<unsigned char>(text[1])) != 0));
  return begins && text.back() != ' ' && std::ranges::all_of(text, plain) ? text : json_text(text);
}

std::string flow(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return "null";
    case YamlNode::Kind::scalar: return scalar(node.text);
    case YamlNode::Kind::sequence:
    case YamlNode::Kind::map: break;
  }
  const bool map = node.kind == YamlNode::Kind::map;
  std::string inside;
  for (const YamlNode& child : node.children)
    inside += fmt::format("{}{}{}", inside.empty() ? "" : ", ", map ? scalar(child.key) + ": " : "", flow(child));
  return fmt::format("{}{}{}", map ? '{' : '[', inside, map ? '}' : ']');
}

// A key a line; what a sweep or the sensors have stands on lines of its own, and so do the items of an axis of maps.
std::string block(const YamlNode& root) {
  std::string text;
  for (const YamlNode& child : root.children) {
    const bool lines = child.kind == YamlNode::Kind::map && (child.key == "sweep" || child.key == "sensors");
    if (!lines || child.children.empty()) {
      text += fmt::format("{}: {}\n", scalar(child.key), flow(child));
      continue;
    }
    text += fmt::format("{}:\n", scalar(child.key));
    for (const YamlNode& inner : child.children) {
      const bool items =
          inner.kind == YamlNode::Kind::sequence && !inner.children.empty() && inner.children.front().kind == YamlNode::Kind::map;
      if (!items) {
        text += fmt::format("  {}: {}\n", scalar(inner.key), flow(inner));
        continue;
      }
      text += fmt::format("  {}:\n", scalar(inner.key));
      for (const YamlNode& item : inner.children) text += fmt::format("    - {}\n", flow(item));
    }
  }
  return text;
}

std::string draw_of(const FitKey& key, const Json& parameter) {
  const double centre = parameter.at("value").get<double>(), sd = parameter.at("scatter").get<double>();
  const auto written = [&](double value) { return format_quantity(value, key.quantity); };
  if (key.logarithmic) return fmt::format("{{draw: lognormal, median: {}, sd: {}}}", written(centre), format_number(sd));
  return fmt::format("{{draw: normal, mean: {}, sd: {}, min: {}, max: {}}}", written(centre), written(sd), written(key.min),
                     written(key.max));
}

}  // namespace

double FitKey::value(double place) const { return logarithmic ? min * std::pow(max / min, place) : min + (max - min) * place; }

double FitKey::place(double value) const {
  if (!logarithmic) return (value - min) / (max - min);
  return value > 0.0 ? std::log(value / min) / std::log(max / min) : -1.0;
}

std::string FitKey::text(double value, int digits) const {
  // A unit in which the bounds have a readable size; of that, four digits.
  const Unit* best = nullptr;
  const double size = std::max(std::abs(min), std::abs(max));
  for (const Unit& unit : units_of(quantity)) {
    const double scaled = size / unit.factor;
    if (best == nullptr || (scaled >= 1.0 && (scaled < size / best->factor || size / best->factor < 1.0))) best = &unit;
  }
  if (quantity == Quantity::angle) {
    for (const Unit& unit : units_of(quantity)) best = unit.symbol == "deg" ? &unit : best;
  }
  return fmt::format("{:.{}g}{}{}", value / best->factor, digits, best->symbol.empty() ? "" : " ", best->symbol);
}

std::vector<FitKey> parse_fit_keys(const std::string& text) {
  const YamlNode root = parse_yaml(text, "--fit " + text, false);
  require_map(root, "--fit", "KEY: {min: .., max: ..}");
  std::vector<FitKey> keys;
  for (const YamlNode& child : root.children) keys.push_back(read_fit_key(child));
  return keys;
}

std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result) {
  SceneFile fitted = file;
  std::string head = fmt::format("# {}\n", result.at("command").get<std::string>());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const FitKey& key = keys[k];
    const Json& parameter = result.at("parameters").at(k);
    const bool determined = parameter.at("determined").get<bool>();
    const std::string bound = !key.each && parameter.at("at_bound").get<bool>() ? ", at its bound" : "";
    const std::string value = key.text(parameter.at("value").get<double>());
    if (!determined) {
      head += fmt::format("# {}: not determined by these recordings{}\n", key.path, bound);
    } else if (key.each) {
      head += fmt::format("# {}: {} over the recordings\n", key.path, draw_of(key, parameter));
    } else {
      head += fmt::format("# {}: {}, 95 % {} to {}{}\n", key.path, value, key.text(parameter.at("low").get<double>()),
                          key.text(parameter.at("high").get<double>()), bound);
    }
    if (key.path == lag_key) continue;
    // To the last digit: the scene simulates what was fitted, not what the head rounds.
    fitted.apply(key.each ? Override{"sweep." + key.path, draw_of(key, parameter)}
                          : Override{key.path, format_quantity(parameter.at("value").get<double>(), key.quantity)});
  }
  return head + block(fitted.root());
}

}  // namespace slipbench::calibrate
