#include "tools/studies/counts/results.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/page/svg.h"
#include "tools/studies/counts/count.h"

namespace slipbench::counts {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format_version = 1;
constexpr const char* format_key = "slipbench_bench";

Json facts_json(const Facts& facts) {
  Json json = Json::object();
  for (const auto& [name, value] : facts) json[name] = value;
  return json;
}

Json scene_json(const SceneCount& scene) {
  Json functions = Json::object();
  for (const FunctionCount& function : scene.functions) {
    if (functions.size() == stored_functions) break;
    functions[function.name] = function.instructions;
  }
  return {{"scene", scene.scene},    {"simulated_s", scene.simulated},
          {"steps", scene.steps},    {"instructions", scene.instructions},
          {"cpu_s", scene.cpu_time}, {"functions", std::move(functions)}};
}

// A place in a file of results. What is read there is checked, and refused with the place.
class Place {
 public:
  Place(const Json& json, const std::string& path, std::string where) : json_(json), path_(path), where_(std::move(where)) {}

  [[nodiscard]] Place at(const char* key) const {
    if (!json_.is_object()) refuse("an object");
    const auto found = json_.find(key);
    if (found == json_.end()) refuse(fmt::format("an object with the key '{}'", key));
    return {*found, path_, where_.empty() ? key : where_ + "." + key};
  }

  [[nodiscard]] std::vector<Place> elements() const {
    if (!json_.is_array() || json_.empty()) refuse("a list with something in it");
    std::vector<Place> places;
    for (const Json& element : json_) places.emplace_back(element, path_, fmt::format("{}[{}]", where_, places.size()));
    return places;
  }

  [[nodiscard]] std::vector<std::pair<std::string, Place>> entries() const {
    if (!json_.is_object() || json_.empty()) refuse("an object with something in it");
    std::vector<std::pair<std::string, Place>> places;
    for (const auto& [name, value] : json_.items()) places.emplace_back(name, Place(value, path_, where_ + "." + name));
    return places;
  }

  [[nodiscard]] std::string text() const {
    if (!json_.is_string()) refuse("a text");
    return json_.get<std::string>();
  }

  [[nodiscard]] std::uint64_t count() const {
    if (!json_.is_number_unsigned() || json_.get<std::uint64_t>() == 0) refuse("a whole number above zero");
    return json_.get<std::uint64_t>();
  }

  [[nodiscard]] double seconds() const {
    const double value = json_.is_number() ? json_.get<double>() : 0.0;
    if (!(value > 0.0 && value <= std::numeric_limits<double>::max())) refuse("a number above zero");
    return value;
  }

  [[nodiscard]] Facts facts() const {
    Facts facts;
    for (const auto& [name, place] : entries()) facts.emplace_back(name, place.text());
    return facts;
  }

  [[noreturn]] void refuse(const std::string& allowed) const {
    std::string found = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    throw InputError(fmt::format("{}: {} is {}; allowed: {}", path_, where_.empty() ? "the file" : where_, found, allowed));
  }

 private:
  const Json& json_;
  const std::string& path_;
  std::string where_;
};

SceneCount scene_of(const Place& place) {
  SceneCount scene{.scene = place.at("scene").text(),
                   .simulated = place.at("simulated_s").seconds(),
                   .steps = place.at("steps").count(),
                   .instructions = place.at("instructions").count(),
                   .cpu_time = place.at("cpu_s").seconds(),
                   .functions = {}};
  std::uint64_t sum = 0;
  for (const auto& [name, function] : place.at("functions").entries()) {
    scene.functions.push_back({name, function.count()});
    sum += scene.functions.back().instructions;
  }
  if (sum > scene.instructions) place.at("instructions").refuse(fmt::format("no less than its functions add up to, {}", sum));
  if (!std::ranges::is_sorted(scene.functions, std::ranges::greater{}, &FunctionCount::instructions)) {
    place.at("functions").refuse("the dearest first");
  }
  return scene;
}

const std::string* value_of(const Facts& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &Facts::value_type::first);
  return found == facts.end() ? nullptr : &found->second;
}

std::string quoted(const std::string* value) { return value == nullptr ? "not said" : fmt::format("'{}'", *value); }

}  // namespace

std::string scene_name(std::string_view path) {
  constexpr std::string_view folder = "scenes/";
  constexpr std::string_view ending = ".yaml";
  if (path.starts_with(folder)) path.remove_prefix(folder.size());
  if (path.ends_with(ending)) path.remove_suffix(ending.size());
  return std::string(path);
}

std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(std::abs(value));
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return (value < 0 ? "-" : "") + digits;
}

std::string results_json(const Results& results) {
  Json scenes = Json::array();
  for (const SceneCount& scene : results.scenes) scenes.push_back(scene_json(scene));
  const Json json = {{format_key, format_version},
                     {"build", facts_json(results.build)},
                     {"context", facts_json(results.context)},
                     {"scenes", std::move(scenes)}};
  return json.dump(1) + '\n';
}

Results parse_results(std::string_view text, const std::string& path) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: no JSON ({}); allowed: what slipbench bench -o writes", path, error.what()));
  }
  const Place file(json, path, "");
  const Place version = file.at(format_key);
  if (version.count() != format_version) version.refuse(std::to_string(format_version));
  Results results{.build = file.at("build").facts(), .context = file.at("context").facts(), .scenes = {}};
  for (const Place& scene : file.at("scenes").elements()) results.scenes.push_back(scene_of(scene));
  return results;
}

Results read_results(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(fmt::format("{}: there is no such file", path));
  if (!std::filesystem::is_regular_file(path, error))
    throw InputError(fmt::format("{}: no file; allowed: results of slipbench bench", path));
  return parse_results(file_text(path), path);
}

std::string differences(const Facts& there, const Facts& here) {
  std::vector<std::string> found;
  const auto compare = [&](const std::string& name) {
    const std::string* const before = value_of(there, name);
    const std::string* const now = value_of(here, name);
    if (before == nullptr || now == nullptr || *before != *now) {
      found.push_back(fmt::format("{} ({} there, {} here)", name, quoted(before), quoted(now)));
    }
  };
  for (const auto& [name, value] : here) compare(name);
  for (const auto& [name, value] : there) {
    if (value_of(here, name) == nullptr) compare(name);
  }
  return fmt::format("{}", fmt::join(found, ", "));
}

std::string find_results(const std::string& folder, const Facts& build) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<std::string> same;
  std::string others;
  for (const std::filesystem::path& file : files) {
    const std::string difference = differences(read_results(file.string()).build, build);
    if (difference.empty()) {
      same.push_back(file.string());
    } else {
      others += fmt::format("; {} is of another {}", file.filename().string(), difference);
    }
  }
  if (same.size() > 1) throw InputError(fmt::format("{} and {} are of one build; allowed: one of them", same[0], same[1]));
  if (same.empty()) {
    throw InputError(
        fmt::format("no results of this build in {}{}; to add them: slipbench bench -o {}/NAME.json", folder, others, folder));
  }
  return same.front();
}

namespace {

std::vector<FunctionChange> changed_functions(const SceneCount& before, const SceneCount& now) {
  std::map<std::string, std::uint64_t> current;
  for (const FunctionCount& function : now.functions) current[function.name] = function.instructions;
  std::vector<FunctionChange> changes;
  for (const FunctionCount& function : before.functions) {
    const auto found = current.find(function.name);
    changes.push_back({function.name, function.instructions, found == current.end() ? 0 : found->second});
    if (found != current.end()) current.erase(found);
  }
  // Of a function that the file does not list it is known only that it was no dearer than the cheapest that it lists.
  const std::uint64_t cheapest = before.functions.back().instructions;
  for (const auto& [name, instructions] : current) {
    if (instructions > cheapest) changes.push_back({name, cheapest, instructions, false});
  }
  std::erase_if(changes, [](const FunctionChange& change) { return change.difference() == 0; });
  std::ranges::stable_sort(changes, std::ranges::greater{},
                           [](const FunctionChange& change) { return std::abs(change.difference()); });
  return changes;
}

}  // namespace

void check_comparable(const Results& before, const Facts& build, const std::string& path) {
  if (const std::string difference = differences(before.build, build); !difference.empty()) {
    throw InputError(fmt::format("{}: counts of another build cannot be compared: it is of another {}", path, difference));
  }
  if (!std::ranges::equal(before.scenes, reference_scenes(), {}, &SceneCount::scene)) {
    std::string found;
    for (const SceneCount& scene : before.scenes) found += (found.empty() ? "" : ", ") + scene.scene;
    throw InputError(fmt::format("{}: its scenes are {}; allowed: {}; to count again: slipbench bench -o {}", path, found,
                                 fmt::join(reference_scenes(), ", "), path));
  }
}

std::vector<SceneChange> compare(const Results& before, const Results& now) {
  std::vector<SceneChange> changes;
  for (std::size_t i = 0; i < now.scenes.size(); ++i) {
    const SceneCount& old = before.scenes.at(i);
    const SceneCount& fresh = now.scenes[i];
    changes.push_back({fresh.scene, old.instructions, fresh.instructions, old.steps, fresh.steps, changed_functions(old, fresh)});
  }
  return changes;
}

namespace {

// In pixels.
constexpr double width = 760.0, top = 46.0, row = 24.0, bar_height = 14.0, names_end = 140.0;
constexpr double label_room = 52.0;  // for the number after the longest bar

// Three significant digits (two below 1), without an exponent: "3.04", "183", "4,610".
std::string short_number(double value) {
  if (value < 1.0) return fmt::format("{:.2g}", value);
  if (value < 999.5) return fmt::format("{:.3g}", value);
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return grouped(std::lround(std::round(value / step) * step));
}

// Bars of one kind of value, beside the names of their scenes, on an axis of whole decades.
void add_bars(page::Svg& svg, const std::vector<double>& values, double begin, double end, std::string_view title,
              std::string_view kind) {
  const page::Axis axis = page::decade_axis(values, begin, end - label_room);
  svg.text("name", begin, 20.0, title);
  for (const double decade : axis.ticks) {
    const double x = axis.at(decade);
    svg.line("mesh", x, top - 4.0, x, top + row * static_cast<double>(values.size()));
    svg.text("small middle", x, 38.0, short_number(decade));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double y = top + row * static_cast<double>(i) + 0.5 * (row - bar_height), reach = axis.at(values[i]);
    svg.bar(kind, begin, y, reach - begin, bar_height);
    svg.text("name", reach + 5.0, y + 11.0, short_number(values[i]));
  }
}

std::string joined(const Facts& facts, std::initializer_list<std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(facts, name, &Facts::value_type::first);
    if (found != facts.end()) out += (out.empty() ? "" : ", ") + found->second;
  }
  return out;
}

}  // namespace

std::string drawing(const Results& results) {
  std::vector<double> counts;
  std::vector<double> times;
  for (const SceneCount& scene : results.scenes) {
    counts.push_back(scene.instructions_per_second() * 1e-6);
    times.push_back(scene.times_real_time());
  }
  const double bottom = top + row * static_cast<double>(results.scenes.size());
  page::Svg svg(width, bottom + 44.0);
  for (std::size_t i = 0; i < results.scenes.size(); ++i) {
    svg.text("name end", names_end, top + row * static_cast<double>(i) + 16.0, scene_name(results.scenes[i].scene));
  }
  add_bars(svg, counts, 150.0, 440.0, "million instructions per simulated second", "s0");
  add_bars(svg, times, 460.0, 745.0, "times real time, one core", "s2");
  svg.text("small", 14.0, bottom + 18.0, joined(results.build, {"compiler", "flags", "sources", "instruction set"}));
  svg.text("small", 14.0, bottom + 33.0, joined(results.context, {"processor", "system", "commit"}));
  return svg.file("What the reference scenes cost");
}

}  // namespace slipbench::counts
