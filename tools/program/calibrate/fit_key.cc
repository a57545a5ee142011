#include "tools/program/calibrate/fit_key.h"

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

}  // namespace slipbench::calibrate
