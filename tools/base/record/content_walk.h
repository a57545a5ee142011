// The digests of README.md, made from what a file holds.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "tools/base/files/sha256.h"
#include "tools/base/hdf5/hdf5_place.h"

namespace slipbench {

// Name of a demo's attribute that holds its own digest, which is not among its entries.
inline constexpr const char* trial_sha256_name = "sha256";
// The same of a file.
inline constexpr const char* file_sha256_name = "content_sha256";

// Of a demo: all of its arrays and attributes. Throws InputError where something in it cannot be read or is of a type that no
// dataset has.
Digest stored_trial_digest(const hdf5::Place& demo);

// Of a demo, as schema 1 has it: over its arrays alone.
Digest stored_arrays_digest(const hdf5::Place& demo);

// Of a file, whose root is given: all that it holds beside its trials, and their digests.
Digest stored_file_digest(const hdf5::Place& root, const std::vector<std::pair<std::size_t, Digest>>& trials);

}  // namespace slipbench
