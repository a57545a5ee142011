// Folders of classifiers, in a format that C++ and $readmemh both read.
//
// A folder holds AM.hex, CIM.hex, CM.hex and IM.hex with one hypervector per line (to_hex): 3, 21,
// 4 and 12 lines. model.txt describes their model, one `key: value` per line:
//
//   slipbench_hd: 1
//   dimension: 1000
//   window: 15
//   encoding: graph_spatial_temporal   (spatial, spatial_temporal)
//   context_driven: true               (false)
//   ties: one                          (zero)
//   compat: paper                      (published_core)
//   quantiser: fixed_point             (exact, unrounded)
//   on: 5                              (default 1; consecutive frames that begin an alarm)
//   off: 2                             (default 1; consecutive frames that end it)
//   least: 3                           (default 1; frames that it lasts at least)
//   trained: hexapod.h5, draw 3        (any text, to the end of the line)
//
// The optional seen.txt lists the digests of the training trials, one per line (64 hexadecimal
// digits).
#pragma once

#include <optional>
#include <set>
#include <string>

#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/model.h"
#include "detectors/network/description.h"
#include "sim/core/error.h"

namespace slipbench::hd {

// Content of a classifier's folder.
struct SavedModel {
  Model model;
  Quantiser quantiser = Quantiser::fixed_point;
  std::string trained;  // description of the training data, for people
  Memories memories;
  network::Alarm alarm{};  // when the detector reports slip
};

// A folder without model.txt, if its model is not given otherwise.
class UnnamedModelError : public InputError {
 public:
  using InputError::InputError;
};

// Reads a folder. Without model.txt, as for the published memories, the model is `unnamed` (its
// dimension comes from the most common line length of the files); without `unnamed` it throws
// UnnamedModelError. The published IM.hex has two unused rows, which are accepted in that case.
// Throws InputError with file and line for a missing file, too few or too many lines, a line that
// is short, long or not hexadecimal, and a key that is unknown, missing or repeated.
SavedModel load(const std::string& folder, const std::optional<Model>& unnamed = std::nullopt);

// Throws InputError if save() could not replace what is at `folder`, or if that is anything but a
// model. For callers with long work to do before they save.
void check_save_target(const std::string& folder);

// Writes a folder under a temporary name, syncs it and moves it into place once complete. Replaces
// a folder of that name only if it holds nothing but a model. Throws InputError if it holds
// anything else or cannot be written, or if the parts of `saved` do not fit together; the old
// folder then stays. `seen`: digests of the training trials.
void save(const std::string& folder, const SavedModel& saved, const std::set<std::string>& seen = {});

// Returns the digests of the trials that a folder's memories were trained on; empty if the folder
// does not record them. Throws InputError with file and line for a line that is not a digest.
std::optional<std::set<std::string>> seen_by(const std::string& folder);

// Memories shipped with the program.

// The default of a scene, and the one trained on scenes/learn.
inline constexpr const char* default_memories = "cl_gst_hd";
inline constexpr const char* learnt_memories = "learn_gst_hd";

// Returns the folder of the shipped classifier `name`, relative to the running program
// (share/slipbench/memories/hd beside its bin). Throws InputError, with the path searched, if there
// is no such folder.
std::string shipped_memories(const std::string& name);

// Returns the folder of the classifier `name`: a plain word names a shipped one, even if the
// current folder has an entry of that name; otherwise a path. Throws as shipped_memories().
std::string memories_folder(const std::string& name);

// Writing a folder of text files atomically.

struct TextFile {
  std::string name;
  std::string text;
};

// Moves the folder `fresh` to `target`, and the old `target` to `stale`, which must not exist.
// Throws std::system_error if that fails; `target` is then unchanged.
void replace_folder(const std::string& fresh, const std::string& target, const std::string& stale);

}  // namespace slipbench::hd
