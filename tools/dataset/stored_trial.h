// Location of a finished trial.
#pragma once

#include <cstddef>
#include <string>

#include "tools/files/output_file.h"

namespace slipbench {

// A trial of a batch or of a sweep's shard.
struct StoredTrial {
  std::size_t number = 0;  // k of demo_<k>
  std::string group;       // the trials are split by this
  Digest digest{};         // its attribute sha256
  std::string file;        // holds the trial
};

}  // namespace slipbench
