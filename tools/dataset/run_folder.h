// Folder of an unfinished run.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/files/output_file.h"

namespace slipbench {

// The folder OUT.h5.partial/ of the dataset OUT.h5. It holds everything that a run writes until the
// file gets its final name:
//
// | name | content |
// |---|---|
// | lock | empty, locked by the run (flock); a second run is refused |
// | batch.h5, batch-0001.h5, ... | finished batches of a sweep, see batches.h |
// | batch.h5.damaged, ... | batches that a resumed sweep could not read |
// | *.h5.partial | a file being written; worthless after a kill |
class RunFolder {
 public:
  // Creates and locks the folder, and removes unfinished files of a killed run. `path`: the
  // dataset's first file. Throws InputError if no dataset may be written at `path` (check_target),
  // if another run holds the lock, if something else has the folder's name, and with the system's
  // reason if the folder cannot be created.
  explicit RunFolder(const std::string& path);
  // Calls close().
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  // The dataset's first file.
  [[nodiscard]] const std::string& target() const { return target_; }
  // The folder.
  [[nodiscard]] const std::string& path() const { return path_; }
  // Temporary name in the folder of the k-th file of the dataset.
  [[nodiscard]] std::string unfinished_file(std::size_t k) const;
  // Final name of the k-th batch. It is written as temporary_path() of that name.
  [[nodiscard]] std::string batch(std::size_t k) const;
  // Names of the finished batches in ascending order.
  [[nodiscard]] std::vector<std::string> batches() const;
  // Throws InputError if there are finished batches, so that no finished work is lost.
  void refuse_batches() const;
  // Removes all finished and damaged batches; the dataset holds their trials.
  void remove_batches() const;
  // Ends the run: removes the folder unless it holds batches, and releases the lock. Repeating it
  // does nothing.
  void close();

 private:
  std::string target_;
  std::string path_;
  Descriptor lock_;
};

// Name of the folder: "a/OUT.h5.partial" for "a/OUT.h5".
std::string run_folder_path(const std::string& path);
// The file that a run of `path` locks.
std::string run_lock_path(const std::string& path);
// Name of the first finished batch of a sweep to `path`. Readers open it, with all further batches,
// as an unfinished dataset.
std::string first_batch_path(const std::string& path);

}  // namespace slipbench
