// The trials of a file, found without reading their arrays.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/dataset/stored_trial.h"
#include "tools/base/hdf5/hdf5_place.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

// The trials of one file in ascending order. Throws InputError where the file is not as a sweep writes it.
std::vector<StoredTrial> stored_trials(const std::string& path);

// The trial as it is stored, ready to be written again: its chunks are not decompressed. `file`: the handle of stored.file, which is open.
// Throws InputError where the trial is not stored as the encoder does it.
EncodedTrial read_encoded(hid_t file, const StoredTrial& stored);

// Name of the array that holds the groups of a file's trials in ascending order of number: in a batch, and in a sweep's shard, whose
// masks are not final.
inline constexpr const char* batch_groups_name = "group";
inline constexpr const char* shard_groups_name = "mask/group";

// k of the member "demo_<k>" of the list of trials, or of one of the names that it holds. Throws InputError for another name.
std::size_t trial_number(const hdf5::Place& list, const std::string& name);

// Where a trial stands in a file.
std::string demo_path(std::size_t trial);

}  // namespace slipbench
