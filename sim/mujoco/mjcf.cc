#include "sim/mujoco/mjcf.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "sim/core/error.h"
#include "sim/core/process/named_files.h"
#include "sim/core/process/regular_file.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = 100'000'000;  // bytes
constexpr double most_cells = 1e8;
constexpr double most_copies = 1e6;  // nested ones multiplied
constexpr double most_values = 1e6;  // per body, joint and the like
constexpr double most_keys = 1e4;    // MuJoCo's time grows with its square
constexpr double most_memory = 4e9;  // bytes

constexpr std::string_view space = " \t\r\n\v\f";

struct Tag {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::size_t line = 1;
  bool begins = false, ends = false;  // of an element; both: an empty element
};

// Parts that MuJoCo's XML parser skips, such as comments; "<!" begins two others too.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> skipped{
    {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<!", ">"}, {"<?", "?>"}}};

// Returns the tags of a text. The result for text that is not XML is arbitrary.
std::vector<Tag> tags_of(std::string_view text) {
  std::vector<Tag> tags;
  std::size_t line = 1, counted = 0;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const auto skip = std::ranges::find_if(skipped, [&](const auto& ends) { return text.substr(at).starts_with(ends.first); });
    if (skip != skipped.end()) {
      at = std::min(text.find(skip->second, at + skip->first.size()), text.size());
      continue;
    }
    for (; counted < at; ++counted) line += text[counted] == '\n' ? 1U : 0U;
    Tag tag;
    tag.line = line;
    tag.begins = !text.substr(at).starts_with("</");
    const std::size_t name = std::min(text.find_first_not_of(space, at + (tag.begins ? 1 : 2)), text.size());
    std::size_t end = std::min(text.find_first_of(" \t\r\n\v\f/>", name), text.size());
    tag.name = text.substr(name, end - name);
    while (true) {
      const std::size_t begin = text.find_first_not_of(space, end);
      const std::size_t equals = text.find_first_of("=><", begin == std::string_view::npos ? end : begin);
      if (begin == std::string_view::npos || equals == std::string_view::npos || text[equals] != '=') break;
      const std::size_t open = text.find_first_not_of(space, equals + 1);
      if (open == std::string_view::npos || (text[open] != '"' && text[open] != '\'')) break;
      const std::size_t close = text.find(text[open], open + 1);
      if (close == std::string_view::npos) break;
      std::string_view name = text.substr(begin, equals - begin);
      name = name.substr(0, name.find_last_not_of(space) + 1);
      tag.attributes.emplace(name, text.substr(open + 1, close - open - 1));
      end = close + 1;
    }
    const std::size_t slash = text.find_first_not_of(space, end);
    tag.ends = !tag.begins || (slash != std::string_view::npos && text[slash] == '/');
    tags.push_back(std::move(tag));
    at = std::max(end, at + 1);
  }
  return tags;
}

// Returns the product of an attribute's numbers, 1 if it is missing: "3 4" is 12, "2M" is 2^21.
// With an entity such as "&#51;" it is infinite, since it may be any number.
double product_of(const Tag& tag, const std::string& attribute) {
  const auto found = tag.attributes.find(attribute);
  if (found == tag.attributes.end()) return 1.0;
  if (found->second.find('&') != std::string::npos) return std::numeric_limits<double>::infinity();
  double product = 1.0;
  const std::string& text = found->second;
  for (std::size_t at = 0;;) {
    at = std::min(text.find_first_not_of(space, at), text.size());
    if (text.compare(at, 1, "+") == 0) ++at;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
    if (error == std::errc::invalid_argument) return product;
    // beyond the range of a double: as large as can be, since it may overflow
    product *= error == std::errc{} ? value : std::numeric_limits<double>::infinity();
    at = static_cast<std::size_t>(stop - text.data());
    constexpr std::string_view prefixes = "KMGTPE";
    if (at == text.size()) return product;
    const std::size_t power = prefixes.find(static_cast<char>(std::toupper(static_cast<unsigned char>(text[at]))));
    if (power == std::string_view::npos) continue;
    for (std::size_t i = 0; i <= power; ++i) product *= 1024.0;
    ++at;
  }
}

// True if an attribute holds the number NaN. MuJoCo takes it as a missing value, with a warning.
bool has_nan(std::string_view key, std::string_view value) {
  // Attributes whose words are names.
  constexpr std::array<std::string_view, 24> names{
      "actuator", "body",   "body1",  "body2", "childclass", "class", "file", "geom",   "geom1",  "geom2", "hfield", "instance",
      "joint",    "joint1", "joint2", "key",   "material",   "mesh",  "name", "plugin", "prefix", "site",  "target", "value"};
  if (std::ranges::find(names, key) != names.end() || key.ends_with("name")) return false;
  constexpr std::string_view nan = "nan";
  for (std::size_t at = 0; (at = value.find_first_not_of(space, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(value.find_first_of(space, at), value.size());
    const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
    if (std::ranges::equal(value.substr(at, end - at), nan, same)) return true;
    at = end;
  }
  return false;
}

void check_size(const std::string& file, const Tag& tag, const char* what, double found, double most) {
  if (found <= most) return;
  constexpr double longest_text = 1e15;  // beyond it a count is shorter with an exponent
  throw InputError(fmt::format("{}:{}: <{}> {} {}; allowed: at most {:.0f}", file, tag.line, printable(tag.name), what,
                               found < longest_text ? fmt::format("{:.0f}", found) : format_number(found), most));
}

// Files already checked.
struct Looked {
  fs::path folder;  // of the model
  std::map<std::string, std::vector<Tag>> files;
  std::map<std::string, double> copies;    // number of copies made of each file's elements
  std::map<std::string, fs::path> models;  // that <attach> may name
};

// `root`: the folder to which the model's own folders are relative.
void check_file(const fs::path& path, const fs::path& root, Looked& looked, double copies = 1.0) {
  check_regular_file(path.string(), largest_file);
  const std::string file = path.lexically_normal().string();
  if (copies <= looked.copies[file]) return;  // MuJoCo refuses a file that includes itself
  looked.copies[file] = copies;
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::vector<Tag> tags = tags_of(text);
  looked.files[file] = tags;
  std::vector<fs::path> folders{root, path.parent_path()};
  for (const Tag& tag : tags) {
    for (const char* key : {"assetdir", "meshdir", "texturedir"}) {
      if (const auto found = tag.attributes.find(key); found != tag.attributes.end()) folders.push_back(root / found->second);
    }
  }
  const auto for_each_file = [&folders](const std::string& name, const auto& action) {
    for (const fs::path& folder : folders) {
      std::error_code error;
      if (fs::exists(folder / name, error)) action(folder / name);
    }
  };
  for (const Tag& tag : tags) {
    if (tag.name != "model" || !tag.attributes.contains("name") || !tag.attributes.contains("file")) continue;
    for_each_file(tag.attributes.at("file"), [&](const fs::path& found) { looked.models[tag.attributes.at("name")] = found; });
  }
  std::vector<double> replicated{copies};  // stack of the open elements' factors
  for (const Tag& tag : tags) {
    if (tag.name == "replicate" && !tag.begins && replicated.size() > 1) replicated.pop_back();
    if (!tag.begins) continue;
    check_size(path.string(), tag, "has the cells", product_of(tag, "nrow") * product_of(tag, "ncol"), most_cells);
    check_size(path.string(), tag, "has the cells", product_of(tag, "width") * product_of(tag, "height"), most_cells);
    const double count = replicated.back() * std::max(1.0, product_of(tag, "count"));
    check_size(path.string(), tag, "has the count", count, most_copies);
    if (tag.name == "replicate" && !tag.ends) replicated.push_back(count);
    check_size(path.string(), tag, "has the memory", product_of(tag, "memory"), most_memory);
    check_size(path.string(), tag, "has the nkey", product_of(tag, "nkey"), most_keys);
    for (const auto& [key, value] : tag.attributes) {
      if (key.starts_with("nuser")) check_size(path.string(), tag, ("has the " + key).c_str(), product_of(tag, key), most_values);
      if (tag.name == "attach" && key == "model" && looked.models.contains(value)) {
        const fs::path model = looked.models.at(value);
        check_file(model, model.parent_path(), looked, replicated.back());
      }
      const bool names_file = key.starts_with("file");  // also of a cube's sides
      const std::size_t entity = value.find('&');
      if ((names_file || key.ends_with("dir")) && entity != std::string::npos && value.find(';', entity) != std::string::npos)
        throw InputError(fmt::format("{}:{}: {} is {}; use a name without XML entities", path.string(), tag.line, printable(key),
                                     quote(value)));
      if (has_nan(key, value)) {
        throw InputError(fmt::format("{}:{}: <{}> {} is {}; expected a finite number", path.string(), tag.line,
                                     printable(tag.name), printable(key), quote(value)));
      }
      if (!names_file) continue;
      for_each_file(value, [&](const fs::path& found) {
        check_named_file(found, looked.folder, fmt::format("{}:{}: {}", path.string(), tag.line, printable(key)), "");
        if (tag.name == "include") {
          check_file(found, root, looked, replicated.back());
        } else if (tag.name == "model") {
          check_file(found, found.parent_path(), looked);
        } else {
          check_regular_file(found.string(), largest_file);
        }
      });
    }
  }
}

}  // namespace

void check_mjcf(const std::string& path) {
  Looked looked{.folder = fs::path(path).parent_path(), .files = {}, .copies = {}, .models = {}};
  check_file(path, fs::path(path).parent_path(), looked);
}

void try_mjcf(const std::string& path) {
  // MuJoCo's own handlers would write a log into the current folder.
  mju_user_warning = [](const char*) {};
  mju_user_error = [](const char* message) {
    std::fprintf(stderr, "ERROR: %s\n", message);
    std::exit(EXIT_FAILURE);
  };
  std::array<char, 1024> error{};
  mjSpec* const spec = mj_parseXML(path.c_str(), nullptr, error.data(), static_cast<int>(error.size()));
  if (spec == nullptr) return;
  mj_deleteModel(mj_compile(spec, nullptr));
  mj_deleteSpec(spec);
}

std::string placed_message(const std::string& path, std::string message) {
  const auto word_after = [&message](std::string_view what) {
    const std::size_t at = message.find(what);
    return at == std::string::npos ? ""
                                   : message.substr(at + what.size(), message.find('\'', at + what.size()) - at - what.size());
  };
  constexpr std::string_view no_line = ", line 0";
  const std::size_t line = message.rfind(no_line);
  const std::string element = word_after("Element '"), name = word_after("Element name '");
  const std::string attribute = word_after("attribute: '") + word_after("attribute '");
  if (line == std::string::npos || element.empty() == name.empty()) return message;
  const auto is_meant = [&](const Tag& tag) {
    if (!element.empty()) return tag.begins && tag.name == element && (attribute.empty() || tag.attributes.contains(attribute));
    const auto named = tag.attributes.find("name");
    return named != tag.attributes.end() && named->second == name;
  };
  Looked looked{.folder = fs::path(path).parent_path(), .files = {}, .copies = {}, .models = {}};
  check_file(path, fs::path(path).parent_path(), looked);
  std::string places;
  for (const auto& [file, tags] : looked.files) {
    for (const Tag& tag : tags) {
      if (is_meant(tag)) places += (places.empty() ? ", " : " or ") + file + ":" + std::to_string(tag.line);
    }
  }
  return places.empty() ? message : message.replace(line, no_line.size(), places);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string config_element(const std::string& key, const std::string& value) {
  return fmt::format("<config key=\"{}\" value=\"{}\"/>", key, escaped(value));
}

std::string mujoco_library_version() { return mj_versionString(); }

bool mujoco_header_matches_library() { return mjVERSION_HEADER == mj_version(); }

}  // namespace slipbench
