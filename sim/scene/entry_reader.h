// Reads values and entries of a catalogue by their declarations; the key `expect`.
// Every function throws InputError at the node that does not fit.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// A value that a scene was read from, or its default.
struct ReadValue {
  std::string json;                    // numbers in SI
  Quantity quantity = Quantity::none;  // of a number
  std::string written = {};            // as written in the scene; empty: a default, or not a scalar

  friend bool operator==(const ReadValue&, const ReadValue&) = default;
};

// All values, by path.
using Trace = std::map<std::string, ReadValue, std::less<>>;

// Returns a text as a JSON string.
std::string json_text(const std::string& text);

// Returns a number as JSON: the shortest text that reads back as the same double; an infinite one
// as the string "inf" or "-inf".
std::string json_number(double value);

// Returns names of items in alphabetical order, for messages.
template <class Items>
std::vector<std::string_view> names_of(const Items& items) {
  std::vector<std::string_view> names;
  for (const auto& item : items) names.push_back(item.name);
  std::ranges::sort(names);
  return names;
}

// Returns the item called `name`. `noun`: the kind of item, for messages.
template <class Item>
const Item& named(const std::vector<Item>& items, const std::string& name, const Origin& origin, std::string_view noun) {
  const auto found = std::ranges::find(items, name, &Item::name);
  if (found == items.end())
    fail(origin, "unknown " + std::string(noun) + " " + quote(name) + allowed_names(name, names_of(items)));
  return *found;
}

// Returns the text of a scalar. `path`: such as "motion.tilt.0".
const std::string& text_of(const YamlNode& node, std::string_view path, std::string_view allowed);

void require_map(const YamlNode& node, const std::string& where, const std::string& allowed);

// Lists `allowed` in alphabetical order.
void check_keys(const YamlNode& map, const std::string& where, const std::vector<std::string_view>& allowed);

// Returns one scalar of `spec`'s type, or one entry of its vector.
Parameters::Value scalar(const YamlNode& node, const std::string& path, const ParameterSpec& spec);

class EntryReader {
 public:
  // `root`: origin of the scene's root; paths are relative to its file's folder, those given by
  // --set to the current folder. `trace` may be null.
  EntryReader(Origin root, Trace* trace) : root_(std::move(root)), trace_(trace) {}

 protected:
  [[nodiscard]] const Origin& root_origin() const { return root_; }
  // From here on a protocol's figures are the defaults.
  void use(const Protocol& protocol) { protocol_ = &protocol; }

  void record(const std::string& path, const Parameters::Value& value, Quantity quantity = Quantity::none,
              const std::string& written = {});

  // Use of a file that a scene names: code that the user chooses to run, a file that a part opens when
  // it is made, or a table that is read with the scene.
  enum class FileUse { library, part, table };
  // Resolves the path that is written at `node`, the value of the key `path`: relative to the
  // scene's folder, or to the current folder if it was given by --set. Throws InputError if a scene
  // file names a file that it may not (named_files.h), or the scene of a dataset such a table.
  [[nodiscard]] std::string resolved_path(const YamlNode& node, const std::string& path, FileUse use) const;

  // Returns the value at `node`, or the default if it is null.
  Parameters::Value value(const YamlNode* node, const std::string& path, const ParameterSpec& spec);
  double number(const YamlNode* node, const std::string& path, const ParameterSpec& spec) {
    return std::get<double>(value(node, path, spec));
  }

  // Reads the parameters of `entry` from `map` (null: all at their defaults). The map may also
  // contain `other_keys`.
  Parameters parameters(const YamlNode* map, const std::string& path, const std::string& where, const Entry& entry,
                        const std::vector<std::string_view>& other_keys);

  // Reads a map whose `selector` names the entry: motion.kind, surface.shape.
  Named read_kind(const YamlNode* node, const std::string& path, const std::string& selector, const std::string& default_name,
                  const std::vector<Entry>& entries, const std::string& noun, std::vector<std::string_view> other_keys);

  // Reads a sequence of names, or of maps of one key with parameters: "[ageing, {stribeck: {speed:
  // 1 mm/s}}]". Null: empty.
  std::vector<Named> read_list(const YamlNode* node, const std::string& path, const std::vector<Entry>& entries,
                               const std::string& noun);

 private:
  [[nodiscard]] Parameters::Value default_at(const std::string& path, const ParameterSpec& spec) const;
  Parameters::Value vector(const YamlNode& node, const std::string& path, const ParameterSpec& spec);
  Parameters::Value map(const YamlNode& node, const std::string& path, const ParameterSpec& spec);
  Parameters::Value table(const YamlNode* node, const std::string& path, const ParameterSpec& spec);

  Origin root_;
  Trace* trace_;
  const Protocol* protocol_ = nullptr;
};

// The scene's key `expect`: the required results of its trials.

// The controller that never tightens on slip.
inline constexpr const char* negative_control = "hold_preset";

// Reads
//   expect:
//     dropped: false                        # the limit alone
//     max_slip: {limit: 3 mm, pass: 0.9}    # with further parameters of the catalogue's entry
//     confidence: 0.99                      # default 0.95
//     control: none                         # default: hold_preset with a controller, else none
class ExpectationReader : EntryReader {
 public:
  // Records into the trace of `reader`.
  explicit ExpectationReader(const EntryReader& reader) : EntryReader(reader) {}

  // `scene`: read except for this key. Throws InputError at the node that does not fit: an unknown
  // expectation, one that needs a gripper or a detector in a scene without it, a limit of another
  // quantity.
  ExpectScene read(const YamlNode& node, const Scene& scene, const std::vector<ExpectationEntry>& catalogue);

 private:
  Named read_expectation(const YamlNode& node, const Scene& scene, const ExpectationEntry& entry);
  std::string read_control(const YamlNode* node, const Scene& scene);
};

}  // namespace slipbench
