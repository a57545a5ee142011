// Writes datasets.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/run_folder.h"
#include "tools/dataset/stored_trial.h"

namespace slipbench {

class DatasetFile;

// Writes the files of a dataset, OUT.h5, OUT-0001.h5 and so on. They are in the folder of the run
// (run_folder.h) until commit() renames them. The content depends on the header and the trials
// alone. All functions throw InputError with the system's reason if the target cannot be written.
// The HDF5 library is not thread-safe: use all readers and writers of a process from one thread.
class DatasetWriter {
 public:
  static constexpr std::uint64_t default_shard_limit = 1'000'000'000;  // bytes

  // Creates the run's folder. Throws InputError if `path` cannot become a dataset (RunFolder,
  // check_dataset_target) or a sweep left finished batches. Call it before any thread starts.
  // `path`: the first file. `shard_limit` [bytes]: a new file begins before one exceeds it.
  DatasetWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit = default_shard_limit);
  // As above, in an existing folder. `folder` must outlive the writer.
  DatasetWriter(const RunFolder& folder, DatasetHeader header, std::uint64_t shard_limit = default_shard_limit);
  // Without commit(), removes what was written.
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  // Adds a trial. Trials come in ascending order.
  void append(const EncodedTrial& trial);
  // Adopts a file with all trials so far as the dataset's first file. No trial may have been added
  // before.
  void adopt(std::unique_ptr<DatasetFile> file);
  // Records a trial that failed; each file stores all of them when it is finished.
  void add_failed(FailedTrial failed);
  // Number of trials added.
  [[nodiscard]] std::size_t size() const;

  // Writes masks and digests, closes and syncs the files, and renames them, the first one last: if
  // it exists, all do. Returns the final names. Removes files of the replaced dataset beyond the
  // new ones. Throws InputError if another file is in the way that does not belong to this dataset.
  std::vector<std::string> commit();

 private:
  std::unique_ptr<RunFolder> own_folder_;  // null: the caller owns the folder
  const RunFolder& folder_;
  DatasetHeader header_;
  std::uint64_t shard_limit_;
  std::vector<std::unique_ptr<DatasetFile>> files_;
  std::vector<FailedTrial> failed_;
  std::size_t longest_group_ = 0;  // bytes
};

// Copies trials in the order of the list, which must be ascending, from their files. Chunks are
// copied without decompression.
void copy_trials(const std::vector<StoredTrial>& trials, DatasetWriter& writer, const std::atomic<bool>* interrupt = nullptr);

}  // namespace slipbench
