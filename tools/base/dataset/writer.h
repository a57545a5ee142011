// Writing datasets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/run_folder.h"
#include "tools/base/dataset/stored_trial.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

class DatasetFile;

// Writes the files of a dataset, OUT.h5, OUT-0001.h5 and so on. They lie in the folder of the run (run_folder.h) until commit() renames
// them. The content depends on the header and the trials alone. All functions throw InputError with the system's reason when the target
// cannot be written. The HDF5 library is not thread-safe: use all readers and writers of a process from one thread.
class DatasetWriter {
 public:
  static constexpr std::uint64_t default_shard_limit = 1'000'000'000;  // bytes

  // Makes the run's folder. Refuses at once what cannot become a dataset (RunFolder, check_dataset_target), and where a sweep has left
  // finished batches. Call it before any thread is made. `path`: the first file. `shard_limit`: a new file begins before one would have
  // more bytes.
  DatasetWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit = default_shard_limit);
  // The same in a folder that is there. `folder` must outlive the writer.
  DatasetWriter(const RunFolder& folder, DatasetHeader header, std::uint64_t shard_limit = default_shard_limit);
  // Without commit(): what has been written is removed.
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  // Adds a trial. Trials come in ascending order.
  void append(const EncodedTrial& trial);
  // Takes a file with all trials so far as the dataset's first one. Nothing may have been added before.
  void adopt(std::unique_ptr<DatasetFile> file);
  // Notes a trial that failed; each file gets all of these when it is finished.
  void add_failed(FailedTrial failed);
  // Number of trials added.
  [[nodiscard]] std::size_t size() const;

  // Writes masks and digests, closes and syncs the files, and renames them, the first one last: once it is there, all are. Returns the
  // final names. Files of the dataset that is replaced which this one does not have are removed. Refuses a file in the way that is not
  // this dataset's to replace.
  std::vector<std::string> commit();

 private:
  std::unique_ptr<RunFolder> own_folder_;  // null: the caller's
  const RunFolder& folder_;
  DatasetHeader header_;
  std::uint64_t shard_limit_;
  std::vector<std::unique_ptr<DatasetFile>> files_;
  std::vector<FailedTrial> failed_;
  std::size_t longest_group_ = 0;  // bytes
};

// Copies trials in the order of the list, which must be ascending, from the files that hold them. Their chunks are copied as they are
// compressed.
void copy_trials(const std::vector<StoredTrial>& trials, DatasetWriter& writer);

}  // namespace slipbench
