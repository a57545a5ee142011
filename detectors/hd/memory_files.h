// Classifiers in folders: the format that C++ and $readmemh both read.
//
// A folder holds AM.hex, CIM.hex, CM.hex and IM.hex: a hypervector a line (to_hex), 3, 21, 4 and 12 lines. model.txt says which
// model they belong to, a `key: value` a line:
//
//   slipbench_hd: 1
//   dimension: 1000
//   window: 15
//   encoding: graph_spatial_temporal   (spatial, spatial_temporal)
//   context_driven: true               (false)
//   ties: one                          (zero)
//   compat: paper                      (published_core)
//   quantiser: fixed_point             (exact, unrounded)
//   on: 5                              (frames in a row that begin an alarm; likewise off, that end it, and least, that it lasts; not there: 1)
//   trained: hexapod.h5, draw 3        (anything, to the end of the line)
//
// seen.txt, where it is there, lists the digests of the trials that the memories were trained on,
// one a line (64 hexadecimal digits).
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

// A classifier as it stands in a folder.
struct SavedModel {
  Model model;
  Quantiser quantiser = Quantiser::fixed_point;
  std::string trained;  // from what, for people
  Memories memories;
  network::Alarm alarm{};  // when the detector says slip
};

// A folder without model.txt, where nothing else says which model its memories belong to.
class UnnamedModelError : public InputError {
 public:
  using InputError::InputError;
};

// Reads a folder. Without model.txt, as the published memories are, the model is `unnamed` (its dimension is that of
// most lines of the files): when that is not given either, it is refused with UnnamedModelError. The published IM.hex has two rows that nothing reads; they are let pass there.
// Throws InputError with file and line: a missing file, too few or too many lines, a line that is short, long or not hexadecimal, a
// key that is unknown, missing or said twice.
SavedModel load(const std::string& folder, const std::optional<Model>& unnamed = std::nullopt);

// Throws InputError when save() could not put a model there: what stands there holds anything but a model, or cannot be replaced.
// For a caller with long work to do before it saves.
void check_save_target(const std::string& folder);

// Writes a folder under a temporary name, syncs it and moves it into place when it is whole. A folder of that name is replaced when
// it holds nothing but a model. Throws InputError when it holds anything else or cannot be written, or when `saved` does not fit
// together; what stood there then stands there still. `seen`: digests of the trials that it was
// trained on.
void save(const std::string& folder, const SavedModel& saved, const std::set<std::string>& seen = {});

// The digests of the trials that a folder's memories were trained on; empty: the folder does not
// record them. Throws InputError with file and line for a line that is not a digest.
std::optional<std::set<std::string>> seen_by(const std::string& folder);

// The memories that ship with the program.

// The one that a scene gets when it names none, and the one that learnt scenes/learn.
inline constexpr const char* default_memories = "cl_gst_hd";
inline constexpr const char* learnt_memories = "learn_gst_hd";

// Folder of the shipped classifier `name`, found from the place of the running program (share/slipbench/memories/hd beside its bin).
// Throws InputError when there is no such folder: where it was looked for.
std::string shipped_memories(const std::string& name);

// Folder of the classifier `name`, a word for one that ships, whatever is called so here, or a path. Throws as shipped_memories().
std::string memories_folder(const std::string& name);

// A folder of text files that appears whole.

struct TextFile {
  std::string name;
  std::string text;
};

// Moves the folder `fresh` to `target`, and what stood there to `stale`, which must be free. Throws std::system_error when that is
// not possible; then `target` is as it was.
void replace_folder(const std::string& fresh, const std::string& target, const std::string& stale);

}  // namespace slipbench::hd
