// The scene's key `accuracy`: how right its results have to be, instead of how finely time is to be cut.
#pragma once

#include <optional>

#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

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

}  // namespace slipbench
