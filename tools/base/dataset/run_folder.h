// The folder of a run that has not come to its end.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/files/output_file.h"

namespace slipbench {

// OUT.h5.partial/, beside the dataset OUT.h5. All that a run writes lies there until it gets its final name:
//
// | name | what it is |
// |---|---|
// | lock | empty, held by the run (flock); a second run is refused |
// | batch.h5, batch-0001.h5, ... | finished batches of a sweep, see batches.h |
// | batch.h5.damaged, ... | batches that a resumed sweep could not read |
// | *.h5.partial | a file that is being written; what a killed run has left of it is worthless |
class RunFolder {
 public:
  // Makes and locks the folder, and removes what a killed run has left of unfinished files. `path`: the dataset's first file. Throws
  // InputError where no dataset can be put at `path` (check_target), where another run holds the lock, where something else than such
  // a folder stands under its name, and with the system's reason where it cannot be made.
  explicit RunFolder(const std::string& path);
  // As close().
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  // The dataset's first file.
  [[nodiscard]] const std::string& target() const { return target_; }
  // The folder.
  [[nodiscard]] const std::string& path() const { return path_; }
  // A name in the folder for the k-th file of the dataset while it is written.
  [[nodiscard]] std::string unfinished_file(std::size_t k) const;
  // The k-th batch. It is written as temporary_path() of this.
  [[nodiscard]] std::string batch(std::size_t k) const;
  // Names of the finished batches in ascending order.
  [[nodiscard]] std::vector<std::string> batches() const;
  // Throws InputError where there are any: finished work is not thrown away.
  void refuse_batches() const;
  // Removes all finished batches, damaged ones, too: the dataset holds their trials.
  void remove_batches() const;
  // Ends the run: removes the folder, unless it holds batches, and lets other runs have it. Repeating it does nothing.
  void close();

 private:
  std::string target_;
  std::string path_;
  Descriptor lock_;
};

// The folder's name: "a/OUT.h5.partial" of "a/OUT.h5".
std::string run_folder_path(const std::string& path);
// The file that a run of `path` locks.
std::string run_lock_path(const std::string& path);
// The first batch that a sweep has finished of `path`. Readers open it, and all further ones with it, as a dataset without an end.
std::string first_batch_path(const std::string& path);

}  // namespace slipbench
