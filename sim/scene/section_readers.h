// Sections of a scene that are read apart: what its results have to be, and the bodies that move by forces.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

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

// Reads the tree of a scene without its key `sweep`. Throws InputError at the first thing that is wrong. `trace` may be null.
// Throws InputError naming the root's line where a default name (the motion 'stage', say) is not in its catalogue.
Scene read_scene(const YamlNode& root, const Catalogues& catalogues, Trace* trace);

// The scene's `seed`, 0 where it has none. Throws InputError when it is no unsigned number of 64 bits.
std::uint64_t read_seed(const YamlNode& root);

}  // namespace slipbench
