#include "tools/studies/hd_papillarray/hd_core_figures.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/project/project_file.h"

namespace slipbench::reproduce {
namespace {

using Json = nlohmann::ordered_json;

double number_at(const Json& entry, const char* key, const std::string& subject) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number() || found->get<double>() < 0.0) {
    throw InputError(fmt::format("{}: {} is {}; allowed: a number from 0 on", subject, key,
                                 found == entry.end() ? "missing" : quote(found->dump())));
  }
  return found->get<double>();
}

std::string text_at(const Json& entry, const char* key, const std::string& subject) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_string()) throw InputError(fmt::format("{}: {} is no text", subject, key));
  return found->get<std::string>();
}

}  // namespace

CoreFigures read_core_figures(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  const Json json = Json::parse(std::string(std::istreambuf_iterator<char>(file), {}), nullptr, false);
  if (!json.is_object()) throw InputError(path + ": is no JSON object");
  const auto tools = json.find("tools");
  if (tools == json.end() || !tools->is_object()) throw InputError(path + ": tools is no object; allowed: {\"yosys\": version}");
  const std::string version = text_at(*tools, "yosys", path + ": tools");
  CoreFigures figures{version.substr(0, version.find(" (")), {}};  // "Yosys 0.70 (git sha1 ..."
  const auto unrollings = json.find("unrollings");
  if (unrollings == json.end() || !unrollings->is_object() || unrollings->empty()) {
    throw InputError(path + ": unrollings is no object; allowed: one entry for each degree of unrolling");
  }
  for (const auto& [name, entry] : unrollings->items()) {
    const std::string subject = fmt::format("{}: unrolling '{}'", path, name);
    if (!entry.is_object()) throw InputError(subject + ": is no JSON object");
    const auto number = [&entry = entry, &subject](const char* key) { return number_at(entry, key, subject); };
    figures.configurations.push_back({name, static_cast<std::size_t>(number("latency_cycles")),
                                      static_cast<std::size_t>(number("interval_cycles")), number("lut"), number("ff"),
                                      number("bram36"), number("dsp"), number("levels")});
  }
  return figures;
}

std::optional<CoreFigures> stored_core_figures() {
  const std::optional<std::string> path = find_project_file(core_figures_file);
  if (!path) return std::nullopt;
  return read_core_figures(*path);
}

}  // namespace slipbench::reproduce
