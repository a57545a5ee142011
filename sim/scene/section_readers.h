// What a scene is read with: values and entries by their declarations, and sections that are read apart: what its results have to
// be, and the bodies that move by forces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
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

// What scene_reader.cc reads every section with: values and entries of a catalogue, by their declarations. Every function throws
// InputError at the node that does not fit.

// A value that a scene was read from or that was filled in by default.
struct ReadValue {
  std::string json;                    // numbers in SI
  Quantity quantity = Quantity::none;  // of a number
  std::string written = {};            // as the scene has it; empty: a default, or no scalar

  friend bool operator==(const ReadValue&, const ReadValue&) = default;
};

// All of them, by path.
using Trace = std::map<std::string, ReadValue, std::less<>>;

// A text as a JSON string.
std::string json_text(const std::string& text);

// A number as JSON: the shortest text that reads back as the same double; an infinite one as the string "inf" or "-inf".
std::string json_number(double value);

// Names of items, in alphabetical order, as a message lists them.
template <class Items>
std::vector<std::string_view> names_of(const Items& items) {
  std::vector<std::string_view> names;
  for (const auto& item : items) names.push_back(item.name);
  std::ranges::sort(names);
  return names;
}

// The item called `name`; `noun` says in a message what it would be.
template <class Item>
const Item& named(const std::vector<Item>& items, const std::string& name, const Origin& origin, const std::string& noun) {
  const auto found = std::ranges::find(items, name, &Item::name);
  if (found == items.end()) fail(origin, "unknown " + noun + " " + quote(name) + allowed_names(name, names_of(items)));
  return *found;
}

// The text of a scalar. `path`: as in "motion.tilt.0".
const std::string& text_of(const YamlNode& node, const std::string& path, const std::string& allowed);

void require_map(const YamlNode& node, const std::string& where, const std::string& allowed);

// `allowed` in alphabetical order.
void check_keys(const YamlNode& map, const std::string& where, const std::vector<std::string_view>& allowed);

// One scalar of `spec`'s type, or one entry of its vector.
Parameters::Value scalar(const YamlNode& node, const std::string& path, const ParameterSpec& spec);

class EntryReader {
 public:
  // `root`: of the scene; its file's folder is where paths begin, also where --set has put them. `trace` may be null.
  EntryReader(Origin root, Trace* trace) : root_(std::move(root)), trace_(trace) {}

 protected:
  [[nodiscard]] const Origin& root_origin() const { return root_; }
  // From here on a protocol's figures are the defaults.
  void use(const Protocol& protocol) { protocol_ = &protocol; }

  void record(const std::string& path, const Parameters::Value& value, Quantity quantity = Quantity::none,
              const std::string& written = {});

  // A path as the scene writes it, from the scene's own folder.
  [[nodiscard]] std::string in_folder(const std::string& path) const;

  // The value at `node`, or the default where that is null.
  Parameters::Value value(const YamlNode* node, const std::string& path, const ParameterSpec& spec);
  double number(const YamlNode* node, const std::string& path, const ParameterSpec& spec) {
    return std::get<double>(value(node, path, spec));
  }

  // The parameters of `entry` out of `map` (null: all at their defaults). `other_keys` may stand beside them.
  Parameters parameters(const YamlNode* map, const std::string& path, const std::string& where, const Entry& entry,
                        const std::vector<std::string_view>& other_keys);

  // A map whose `selector` names the entry: motion.kind, surface.shape.
  Named read_kind(const YamlNode* node, const std::string& path, const std::string& selector, const std::string& default_name,
                  const std::vector<Entry>& entries, const std::string& noun, std::vector<std::string_view> other_keys);

  // A sequence of names, or of maps of one key with parameters: "[ageing, {stribeck: {speed: 1 mm/s}}]". Null: empty.
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

// The scene's key `accuracy`: how right its results have to be, instead of how finely time is to be cut.

// Reads
//   accuracy: {onset: 1 %, creep: 1 um/s}    # what may be wished for: accuracy_specs(); none: nothing is
class AccuracyReader : EntryReader {
 public:
  // Records where `reader` does.
  explicit AccuracyReader(const EntryReader& reader) : EntryReader(reader) {}

  // `root`: of the scene. Empty where it wishes for nothing. Throws InputError at the node that does not fit, also where the
  // scene sets itself what is to be found: its step or its solver.
  std::optional<AccuracyScene> read(const YamlNode& root);
};

// What may be wished for, by name: shares of 1, but for creep, a speed.
const std::vector<ParameterSpec>& accuracy_specs();

// The scene's key `expect`: what must come out of its trials.

// The controller that never tightens on slip.
inline constexpr const char* negative_control = "hold_preset";

// Reads
//   expect:
//     dropped: false                        # the limit alone
//     max_slip: {limit: 3 mm, pass: 0.9}    # with further parameters of the catalogue's entry
//     confidence: 0.99                      # default 0.95
//     control: none                         # default: hold_preset in a scene with a controller, else none
class ExpectationReader : EntryReader {
 public:
  // Records where `reader` does.
  explicit ExpectationReader(const EntryReader& reader) : EntryReader(reader) {}

  // `scene`: read but for this key. Throws InputError at the node that does not fit: no such expectation, one that needs a gripper or a
  // detector in a scene without, a limit of another quantity.
  ExpectScene read(const YamlNode& node, const Scene& scene, const std::vector<ExpectationEntry>& catalogue);

 private:
  Named read_expectation(const YamlNode& node, const Scene& scene, const ExpectationEntry& entry);
  std::string read_control(const YamlNode* node, const Scene& scene);
};

// What a scene says of bodies that move by forces, and refuses where it has none. `scene`: read but for that, for detector, controller and
// expectations. Records where `reader` does. Throws InputError at the node that does not fit.
void read_dynamics(const EntryReader& reader, const YamlNode& root, const Catalogues& catalogues, Scene& scene);

// The value of `key` in the scene, null where it has none or takes it back.
const YamlNode* find_kept(const YamlNode& root, std::string_view key);

// The path of an entry of the map `list`, which names a `what` by an identifier and says by `selector` which of `entries` it is. Throws InputError
// where it does not; `allowed`: what stands in it.
std::string named_part(const YamlNode& node, const std::string& list, const std::string& what, const std::string& allowed,
                       const std::string& selector, const std::vector<Entry>& entries);

// From a tree of YAML values to a checked Scene.

// A key that stands at the root of a scene.
struct SceneKey {
  std::string_view name;
  std::string_view doc;  // one sentence, what it holds
};

// All of them, in alphabetical order.
std::span<const SceneKey> scene_keys();

// Reads the tree of a scene without its key `sweep`. Throws InputError at the first thing that is wrong. `trace` may be null.
// Throws InputError naming the root's line where a default name (the motion 'stage', say) is not in its catalogue.
Scene read_scene(const YamlNode& root, const Catalogues& catalogues, Trace* trace);

// The scene's `seed`, 0 where it has none. Throws InputError when it is no unsigned number of 64 bits.
std::uint64_t read_seed(const YamlNode& root);

}  // namespace slipbench
