// The shards of a sweep put together.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace slipbench {

struct Merged {
  std::size_t trials = 0;      // in `files`
  std::size_t failed = 0;      // trials that no shard could simulate
  std::size_t duplicates = 0;  // trials that several of the files hold, with the same digest
  std::vector<std::string> files;
};

// Writes the dataset that the undivided sweep would have written, byte for byte, from the shards `paths` (their first files; further ones may
// stand among them). Chunks are copied as they lie there. Throws InputError, and writes nothing, where a file is no whole shard, where one is of
// another sweep, where trials are missing, where two files hold a trial with different digests, and where `output` cannot be written. What a
// killed merge has left of `output` is replaced. Reads in a child process: call it before any thread is made (guarded.h).
Merged merge_shards(const std::vector<std::string>& paths, const std::string& output);

}  // namespace slipbench
