// The scene's key `expect`: what must come out of its trials.
#pragma once

#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

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

}  // namespace slipbench
