#include "tools/cli/format/describe_key.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/scene/scene_reader.h"
#include "sim/scene/sweep.h"

namespace slipbench {
namespace {

constexpr std::size_t most_explained = 24;  // keys; of a longer list the names alone are shown

// Resolves a reference into the schema.
const Json& resolved(const Json& part, const Json& schema) {
  const auto reference = part.find("$ref");
  if (reference == part.end()) return part;
  return resolved(schema.at(Json::json_pointer(reference->get<std::string>().substr(1))), schema);
}

// Returns the schema of the map that a value may be: the schema itself, one of its alternatives, or
// that below free names. Null: the value cannot be a map.
const Json* map_in(const Json& part, const Json& schema) {
  const Json& value = resolved(part, schema);
  if (value.contains("properties")) return &value;
  if (value.contains("additionalProperties") && value["additionalProperties"].is_object())
    return map_in(value["additionalProperties"], schema);
  if (!value.contains("anyOf")) return nullptr;
  for (const Json& alternative : value["anyOf"]) {
    if (const Json* map = map_in(alternative, schema)) return map;
  }
  return nullptr;
}

// Returns the words that a value, or an item of a sequence, may be.
std::vector<std::string> words_in(const Json& part, const Json& schema) {
  const Json& value = resolved(part, schema);
  std::vector<std::string> words;
  const auto add = [&](const Json& word) { words.push_back(word.is_string() ? word.get<std::string>() : word.dump()); };
  if (value.contains("const")) add(value["const"]);
  if (value.contains("enum")) {
    for (const Json& word : value["enum"]) {
      if (!word.is_boolean()) add(word);
    }
  }
  if (value.contains("items")) return words_in(value["items"], schema);
  if (value.contains("anyOf")) {
    for (const Json& alternative : value["anyOf"]) {
      for (std::string& word : words_in(alternative, schema)) words.push_back(std::move(word));
    }
  }
  return words;
}

std::string text_of_json(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

// Returns the lines below the description of a value.
std::string value_lines(const Json& part, const Json& schema, std::size_t width, std::size_t indent) {
  std::string text;
  const std::vector<std::string> words = words_in(part, schema);
  if (!words.empty()) text += wrap_text(fmt::format("words:   {}", fmt::join(words, ", ")), width, indent);
  if (part.contains("default")) text += wrap_text("default: " + text_of_json(part["default"]), width, indent);
  return text;
}

std::string description_of(const Json& part, const Json& schema) {
  if (part.contains("description")) return part["description"].get<std::string>();
  const Json& value = resolved(part, schema);
  return value.contains("description") ? value["description"].get<std::string>() : "";
}

std::string draws_text(const Style& style, std::size_t width) {
  std::string text = fmt::format("\n{}\n", style.bold("Draws: {draw: NAME, ...}"));
  for (const DrawKind& kind : draw_kinds()) {
    text += wrap_text(fmt::format("{}: {}{}{}", kind.name, fmt::join(kind.required, ", "),
                                  kind.optional.empty() ? "" : "; optional: ", fmt::join(kind.optional, ", ")),
                      width, 2);
  }
  return text;
}

}  // namespace

std::vector<std::string> scene_key_names() {
  std::vector<std::string> names;
  for (const SceneKey& key : scene_keys()) names.emplace_back(key.name);
  return names;
}

std::string describe_key_text(const std::string& key, const Json& schema, const Style& style, std::size_t width) {
  const Json& part = schema.at("properties").at(key);
  std::string text = fmt::format("{}  {}\n", style.heading(key), style.dim("key of a scene"));
  text += wrap_text(description_of(part, schema), width, 2) + value_lines(part, schema, width, 2);
  if (const Json* map = map_in(part, schema)) {
    text += fmt::format("\n{}\n", style.bold("Keys"));
    const Json& keys = (*map)["properties"];
    if (keys.size() > most_explained) {
      std::vector<std::string> names;
      for (const auto& [name, value] : keys.items()) names.push_back(name);
      text += wrap_text(fmt::format("{}", fmt::join(names, ", ")), width, 2);
    } else {
      for (const auto& [name, value] : keys.items()) {
        text += fmt::format("  {}\n", style.bold(name));
        if (const std::string about = description_of(value, schema); !about.empty()) text += wrap_text(about, width, 6);
        text += value_lines(value, schema, width, 6);
      }
    }
  }
  if (key == "sweep") text += draws_text(style, width);
  return text;
}

Json describe_key_json(const std::string& key, const Json& schema) {
  const Json& part = schema.at("properties").at(key);
  return {{"kind", "key of a scene"}, {"name", key}, {"summary", description_of(part, schema)}, {"schema", part}};
}

}  // namespace slipbench
