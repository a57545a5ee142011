// Finds the trials of a file without reading their arrays.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/stored_trial.h"

namespace slipbench {

// The trials of one file in ascending order. Throws InputError if a sweep did not write the file in
// this form.
std::vector<StoredTrial> stored_trials(const std::string& path);

// Reads a trial as it is stored, ready to be written again: its chunks stay compressed. `file`:
// open handle of stored.file. Throws InputError if the trial is not stored as the encoder stores
// it.
EncodedTrial read_encoded(hid_t file, const StoredTrial& stored);

// Array of the groups of a file's trials in ascending order of trial number: in a batch, and in a
// shard of a sweep, whose masks are not final.
inline constexpr const char* batch_groups_name = "group";
inline constexpr const char* shard_groups_name = "mask/group";

// Returns k of the member "demo_<k>" of the list of trials. Throws InputError for another name.
std::size_t trial_number(const hdf5::Place& list, const std::string& name);

// Path of a trial in a file: "/data/demo_<k>".
std::string demo_path(std::size_t trial);

}  // namespace slipbench
