#include "tools/program/calibrate/fitted_scene.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "sim/core/quantity.h"
#include "sim/scene/entry_reader.h"

namespace slipbench::calibrate {
namespace {

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
