// Verifies a dataset: digests, order, times, values, events, Coulomb's law, one surface under each
// element.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "tools/dataset/record/json.h"

namespace slipbench {

struct Verified {
  // One object per dataset: {"file", "files", "schema", "complete", "trials", "holds", "checks",
  // "failures"} as in Verification::json(), {"file", "error"} if it is unreadable, {"file",
  // "part_of"} for a further file of a dataset that was also named.
  Json datasets = Json::array();
  // If several datasets are shards of a sweep: {"shards", "trials", "duplicates", "holds",
  // "failures": [text]}. It holds if they belong to one sweep, are complete, and contain no trial
  // twice with different digests. Otherwise null.
  Json sweep = nullptr;
  bool holds = true;
  bool readable = true;
};

// `paths`: datasets by their first files, and optionally further files of them. Does not throw for
// an unreadable file: the others are verified. Throws Interrupted once `interrupt`, which may be
// null, is true.
Verified verify_datasets(const std::vector<std::string>& paths, const std::atomic<bool>* interrupt = nullptr);

// The result as `slipbench verify --json` prints it.
Json verified_json(const Verified& verified);

}  // namespace slipbench
