// Which files a run may replace or remove: those that a run has written under the names that it uses, and no others.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/files/output_file.h"

namespace slipbench {

// The k-th file of the dataset `path` has three names: its own (shard_path), one while it is written (temporary_path) and one
// after an interrupt (kept_path). What may be replaced: under its own name an empty file or a dataset's k-th file, under the
// others an empty file or a dataset without a trial that a run has left. Nothing else, no link and no special file.

// Throws InputError when one of the first `planned` files may not be written. Returns for how many that is known: at least
// `planned`, more where further files stand there that may be replaced. `resumes`: what a run that did not come to its end has
// left may hold trials, with which this one goes on, and which it has locked.
std::size_t check_dataset_targets(const std::string& path, std::size_t planned, bool resumes);

// For a k-th file beyond those: throws InputError when anything stands under one of its names.
void check_names_are_free(const std::string& path, std::size_t k);

// Names of the files of the finished dataset at `path` from the `first`-th on, as far as they are there and belong to it.
std::vector<std::string> later_files(const std::string& path, std::size_t first);

// Gives the files of a run that was ended after it had finished them, and before they had their own names, these names. Returns
// whether there were any. Throws InputError as check_dataset_targets() does. Call it, as the next one, while leftovers() are held.
bool finish_names(const std::string& path);

// A file that a run which did not come to its end has left, locked against other runs as long as the object lives.
struct Leftover {
  std::string name;
  Descriptor lock;
};

// Those of the dataset `path`, the first of each run, as far as they hold trials. Throws InputError when another run is writing one
// of them or goes on with it, or when one cannot be read.
std::vector<Leftover> leftovers(const std::string& path);

// Gives what leftovers() are under their temporary names the names after an interrupt. Of two k-th files the one with more trials
// stays. Returns how many files there are.
std::size_t gather_leftovers(const std::string& path);

// Removes what a run that did not come to its end has left under the temporary names of `path`, from the `first`-th on.
void remove_temporary(const std::string& path, std::size_t first);
// The same of the names after an interrupt.
void remove_kept(const std::string& path, std::size_t first);

}  // namespace slipbench
