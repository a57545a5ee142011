// Whether a dataset is what it says: digests, order, times, values, events, Coulomb's law.
#pragma once

#include <string>
#include <vector>

#include "tools/base/record/json.h"

namespace slipbench {

struct Verified {
  // One object a dataset: {"file", "files", "schema", "complete", "trials", "holds", "checks", "failures"} as Verification::json()
  // has them, {"file", "error"} where it cannot be read, {"file", "part_of"} for a further file of a dataset that was named too.
  Json datasets = Json::array();
  // Where several of them are shards of a sweep: {"shards", "trials", "duplicates", "holds", "failures": [text]}: whether they are of one sweep,
  // whole, and hold no trial twice with different digests; else null.
  Json sweep = nullptr;
  bool holds = true;
  bool readable = true;
};

// `paths`: datasets by their first files; further files of them may stand among them. Each is read in a child process. Throws
// nothing for a file that cannot be read: the others are verified all the same.
Verified verify_datasets(const std::vector<std::string>& paths);

}  // namespace slipbench
