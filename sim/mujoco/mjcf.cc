#include "sim/mujoco/mjcf.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
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
constexpr double most_folders = 50;  // each name is looked for in each folder
// Bytes of a cell while a model is compiled: MuJoCo keeps one copy in its specification and one in the model.
constexpr double texture_bytes = 2.0 * 3.0, hfield_bytes = 2.0 * 4.0;

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

double hfield_cells(const Tag& tag) {
  return tag.attributes.contains("nrow") ? std::max(0.0, product_of(tag, "nrow") * product_of(tag, "ncol")) : 0.0;
}

double texture_cells(const Tag& tag) {
  return tag.attributes.contains("width") ? std::max(0.0, product_of(tag, "width") * product_of(tag, "height")) : 0.0;
}

// True if an attribute holds the number NaN. MuJoCo takes it as a missing value, with a warning.
bool has_nan(std::string_view tag, std::string_view key, std::string_view value) {
  if (tag == "text" && key == "data") return false;  // any text
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

// A model file with the files that it includes, which share its folders and names.
struct Model {
  std::string path;                                  // canonical
  std::vector<fs::path> roots;                       // its folder, then those of the models that name it
  std::vector<std::string> folders;                  // all values of assetdir, meshdir and texturedir, in any of the files
  bool strips = false;                               // strippath
  std::vector<fs::path> files;                       // the model file first
  std::multimap<std::string, std::string> attached;  // names that <attach> may use, and keys of CheckedFiles::models
};

// Files already checked. MuJoCo's rules for a name depend on its version and on the order of the elements, so that a
// name is checked in every folder in which MuJoCo may look for it.
struct CheckedFiles {
  fs::path folder;  // of the main model
  std::map<std::string, std::vector<Tag>> files;
  std::map<std::string, std::string> shown;                      // by canonical path: the key in `files`
  std::map<std::string, Model> models;                           // by key_of()
  std::map<std::pair<std::string, std::string>, double> copies;  // by model and file: copies made of its elements
};

// Returns the same text for all paths of a file.
std::string identity_of(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(path, error);
  return (error ? path.lexically_normal() : found).string();
}

// The folders of the naming model count too, so that a model is checked for each.
std::string key_of(const fs::path& path, const Model* naming) {
  return identity_of(path) + '\n' + (naming == nullptr ? "" : naming->path);
}

// Returns the tags of a file, read once.
const std::vector<Tag>& tags_of_file(const fs::path& path, CheckedFiles& checked) {
  const auto [shown, is_new] = checked.shown.emplace(identity_of(path), path.lexically_normal().string());
  if (is_new) {
    check_regular_file(path.string(), largest_file);
    std::ifstream stream(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    checked.files[shown->second] = tags_of(text);
  }
  return checked.files.at(shown->second);
}

// MuJoCo takes a backslash as a slash.
std::string with_slashes(std::string name) {
  std::ranges::replace(name, '\\', '/');
  return name;
}

// Returns the paths that MuJoCo may open for `name` in `file`. MuJoCo removes ".." from the text of a path, whether or
// not the folder before it exists; the system follows a link first. Both are returned.
std::vector<fs::path> candidates(const Model& model, const fs::path& file, const std::string& name) {
  std::vector<std::string> names{name, with_slashes(name)};
  if (model.strips) names.push_back(fs::path(names.back()).filename().string());
  std::vector<fs::path> folders = model.roots, result;
  folders.push_back(file.parent_path());
  for (const fs::path& root : model.roots) {
    for (const std::string& folder : model.folders) folders.push_back(root / folder);
  }
  std::set<std::string> known;
  const auto add = [&](fs::path path) {
    if (known.insert(path.string()).second) result.push_back(std::move(path));
  };
  for (const fs::path& folder : folders) {
    for (const std::string& one : names) {
      add((folder / one).lexically_normal());
      add(folder / one);
    }
  }
  return result;
}

// Returns the existing files that MuJoCo may open for an attribute. Throws InputError if one of them is outside of the
// allowed folders, or if none exists and all of them would be outside.
std::vector<fs::path> named_files(const Model& model, const fs::path& file, const Tag& tag, const std::string& key,
                                  const CheckedFiles& checked) {
  const std::string place = fmt::format("{}:{}: {}", file.string(), tag.line, printable(key));
  const std::vector<fs::path> paths = candidates(model, file, tag.attributes.at(key));
  std::vector<fs::path> found;
  for (const fs::path& path : paths) {
    std::error_code error;
    if (!fs::exists(path, error)) continue;
    check_named_file(path, checked.folder, place, "");
    found.push_back(path);
  }
  if (found.empty() && std::ranges::none_of(paths, [&](const fs::path& path) { return may_be_named(path, checked.folder); })) {
    refuse_named_file(paths.front(), place, "");
  }
  return found;
}

// Adds the folders that the tags name. Returns true if any is new.
bool add_folders(const fs::path& file, const std::vector<Tag>& tags, Model& model) {
  bool is_new = false;
  for (const Tag& tag : tags) {
    for (const char* key : {"assetdir", "meshdir", "texturedir"}) {
      const auto found = tag.attributes.find(key);
      if (found == tag.attributes.end()) continue;
      for (const std::string& folder : {found->second, with_slashes(found->second)}) {
        if (std::ranges::find(model.folders, folder) != model.folders.end()) continue;
        model.folders.push_back(folder);
        is_new = true;
        check_size(file.string(), tag, "and its model have the folders", static_cast<double>(model.folders.size()), most_folders);
      }
    }
    const auto strips = tag.attributes.find("strippath");
    if (strips == tag.attributes.end() || strips->second == "false" || model.strips) continue;
    model.strips = is_new = true;
  }
  return is_new;
}

// Reads a model file and all that it includes. A folder named in one of the files holds for all of them, so that the
// search is repeated until no folder is new.
Model read_model(const fs::path& path, const Model* naming, CheckedFiles& checked) {
  Model model;
  if (naming != nullptr) model = *naming;
  model.path = identity_of(path);
  model.roots.insert(model.roots.begin(), path.parent_path());
  constexpr std::size_t most_nested = 10;
  if (model.roots.size() > most_nested) {
    throw InputError(
        fmt::format("{}: models name models {} deep; allowed: at most {}", path.string(), model.roots.size(), most_nested));
  }
  model.files = {path};
  model.attached.clear();
  std::set<std::string> known{model.path};
  add_folders(path, tags_of_file(path, checked), model);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < model.files.size(); ++i) {
      const fs::path file = model.files[i];
      for (const Tag& tag : tags_of_file(file, checked)) {
        if (!tag.begins || tag.name != "include" || !tag.attributes.contains("file")) continue;
        for (const fs::path& found : named_files(model, file, tag, "file", checked)) {
          if (!known.insert(identity_of(found)).second) continue;
          model.files.push_back(found);
          again = add_folders(found, tags_of_file(found, checked), model) || again;
        }
      }
    }
  }
  return model;
}

void check_model(const fs::path& path, const Model* naming, CheckedFiles& checked, double copies = 1.0);

void check_file(const fs::path& path, const std::string& model_key, CheckedFiles& checked, double copies) {
  double& known_copies = checked.copies[{model_key, identity_of(path)}];
  if (copies <= known_copies) return;  // MuJoCo refuses a file that includes itself
  known_copies = copies;
  Model& model = checked.models.at(model_key);
  std::vector<double> replicated{copies};  // stack of the open elements' factors
  for (const Tag& tag : tags_of_file(path, checked)) {
    if (tag.name == "replicate" && !tag.begins && replicated.size() > 1) replicated.pop_back();
    if (!tag.begins) continue;
    check_size(path.string(), tag, "has the cells", hfield_cells(tag), most_cells);
    check_size(path.string(), tag, "has the cells", texture_cells(tag), most_cells);
    const double count = replicated.back() * std::max(1.0, product_of(tag, "count"));
    check_size(path.string(), tag, "has the count", count, most_copies);
    if (tag.name == "replicate" && !tag.ends) replicated.push_back(count);
    check_size(path.string(), tag, "has the memory", product_of(tag, "memory"), most_memory);
    check_size(path.string(), tag, "has the nkey", product_of(tag, "nkey"), most_keys);
    for (const auto& [key, value] : tag.attributes) {
      if (key.starts_with("nuser")) check_size(path.string(), tag, ("has the " + key).c_str(), product_of(tag, key), most_values);
      if (tag.name == "attach" && key == "model") {
        for (auto [at, end] = model.attached.equal_range(value); at != end; ++at) {
          const fs::path child = checked.models.at(at->second).files.front();
          check_model(child, &model, checked, replicated.back());
        }
      }
      const bool names_file = key.starts_with("file");  // also of a cube's sides
      const std::size_t entity = value.find('&');
      if ((names_file || key.ends_with("dir")) && entity != std::string::npos && value.find(';', entity) != std::string::npos)
        throw InputError(fmt::format("{}:{}: {} is {}; use a name without XML entities", path.string(), tag.line, printable(key),
                                     quote(value)));
      if (has_nan(tag.name, key, value)) {
        throw InputError(fmt::format("{}:{}: <{}> {} is {}; expected a finite number", path.string(), tag.line,
                                     printable(tag.name), printable(key), quote(value)));
      }
      if (!names_file) continue;
      for (const fs::path& found : named_files(model, path, tag, key, checked)) {
        if (tag.name == "include") {
          check_file(found, model_key, checked, replicated.back());
        } else if (tag.name != "model") {
          check_regular_file(found.string(), largest_file);
        }
      }
    }
  }
}

// `naming`: the model that names this one; null for the main model.
void check_model(const fs::path& path, const Model* naming, CheckedFiles& checked, double copies) {
  const std::string key = key_of(path, naming);
  if (!checked.models.contains(key)) {
    checked.models.emplace(key, read_model(path, naming, checked));
    Model& model = checked.models.at(key);
    for (const fs::path& file : model.files) {
      for (const Tag& tag : tags_of_file(file, checked)) {
        if (!tag.begins || tag.name != "model" || !tag.attributes.contains("file")) continue;
        for (const fs::path& found : named_files(model, file, tag, "file", checked)) {
          // Without a name here, <attach> uses the name inside the file.
          std::set<std::string> names;
          if (const auto name = tag.attributes.find("name"); name != tag.attributes.end()) names.insert(name->second);
          for (const Tag& inside : tags_of_file(found, checked)) {
            const auto name = inside.attributes.find("model");
            if (inside.name == "mujoco" && name != inside.attributes.end()) names.insert(name->second);
          }
          for (const std::string& name : names) model.attached.emplace(name, key_of(found, &model));
          check_model(found, &model, checked);
        }
      }
    }
  }
  check_file(path, key, checked, copies);
}

// Returns the memory that a model declares, in bytes, with that of a child for each <attach>.
double declared_memory(const std::string& model_key, const CheckedFiles& checked, std::map<std::string, double>& known) {
  const auto [place, is_new] = known.emplace(model_key, 0.0);  // 0 while a model that names itself is open
  if (!is_new) return place->second;
  const Model& model = checked.models.at(model_key);
  double bytes = 0.0;
  for (const fs::path& file : model.files) {
    for (const Tag& tag : checked.files.at(checked.shown.at(identity_of(file)))) {
      if (!tag.begins) continue;
      bytes += texture_bytes * texture_cells(tag) + hfield_bytes * hfield_cells(tag);
      if (tag.attributes.contains("memory")) bytes += std::max(0.0, product_of(tag, "memory"));
      const auto child = tag.attributes.find("model");
      if (tag.name != "attach" || child == tag.attributes.end()) continue;
      for (auto [at, end] = model.attached.equal_range(child->second); at != end; ++at) {
        bytes += declared_memory(at->second, checked, known);
      }
    }
  }
  return known[model_key] = bytes;
}

CheckedFiles check_tree(const std::string& path) {
  CheckedFiles checked{.folder = fs::path(path).parent_path(), .files = {}, .shown = {}, .models = {}, .copies = {}};
  check_model(path, nullptr, checked);
  std::map<std::string, double> known;
  const double bytes = declared_memory(key_of(path, nullptr), checked, known);
  if (bytes > most_memory) {
    throw InputError(fmt::format("{}: textures, height fields and `memory` need {} GB in all; allowed: at most {:.0f} GB", path,
                                 format_number(std::ceil(bytes / 1e8) / 10.0), most_memory / 1e9));
  }
  return checked;
}

}  // namespace

void check_mjcf(const std::string& path) { static_cast<void>(check_tree(path)); }

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
  const CheckedFiles checked = check_tree(path);
  std::string places;
  for (const auto& [file, tags] : checked.files) {
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
