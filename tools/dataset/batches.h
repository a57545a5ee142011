// Writes the dataset of a sweep, which may be killed at any instant.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/dataset/run_folder.h"
#include "tools/dataset/stored_trial.h"
#include "tools/dataset/writer.h"

namespace slipbench {

class DatasetFile;

// Writes trials to batches, small HDF5 files in the folder of the run. A finished batch is closed,
// synced, renamed to its final name and not changed again, so it survives a kill and a power
// failure. commit() joins the batches to the dataset and then removes them. A sweep shorter than
// one batch has a single batch, which becomes the dataset without being copied.
// All functions throw InputError when something cannot be written. Use from one thread.
class SweepWriter {
 public:
  // A batch is finished after this much work, so that at most 5 s of it are lost, syncing included.
  static constexpr std::chrono::seconds batch_time{3};
  static constexpr std::uint64_t default_batch_limit = 256'000'000;  // bytes

  // Creates the run's folder. Throws InputError for a target that DatasetWriter refuses too, but
  // accepts finished batches: call resume() or refuse_left() next. `path`: the dataset's first
  // file. `shard_limit` [bytes]: a new file of the dataset begins before one exceeds it.
  // `batch_limit` [bytes]: likewise for batches.
  SweepWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit = DatasetWriter::default_shard_limit,
              std::uint64_t batch_limit = default_batch_limit);
  ~SweepWriter();
  SweepWriter(const SweepWriter&) = delete;
  SweepWriter& operator=(const SweepWriter&) = delete;

  // Throws InputError if an earlier sweep left batches.
  void refuse_left() const { folder_.refuse_batches(); }
  // Returns the bytes that the caller derives from a trial.
  using Summarise = std::function<std::string(const TrialRecord& record)>;
  // Continues with the batches that an earlier run of the same sweep left. Returns the result of
  // `summarise` for each of their trials, by trial number. A batch that is damaged or does not
  // match its digests is renamed with the suffix ".damaged" and listed in damaged(). Throws
  // InputError if a batch (or, without batches, the existing dataset) was written by another run,
  // if two batches hold the same trial with different content, and if a batch cannot be read for an
  // external reason; all batches are kept then.
  std::map<std::size_t, std::string> resume(const Summarise& summarise);
  // Current names of the batches that resume() found damaged.
  [[nodiscard]] const std::vector<std::string>& damaged() const { return damaged_; }

  // Adds a trial. Trials come in ascending order, without those that resume() returned. Finishes
  // the batch before it would become too large.
  void append(const EncodedTrial& trial);
  // Records a trial that failed.
  void add_failed(FailedTrial failed) { failed_.push_back(std::move(failed)); }
  // When finish_batch() must be called, unless the sweep ends first. Empty while the batch has no
  // trial.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> due() const;
  // Closes and syncs the current batch, so that all trials so far survive a crash.
  void finish_batch();

  // Number of trials in finished batches.
  [[nodiscard]] std::size_t finished() const { return trials_.size(); }
  // The folder of the run.
  [[nodiscard]] const std::string& folder() const { return folder_.path(); }

  // Writes the dataset and returns the names of its files. On failure all batches are kept.
  std::vector<std::string> commit();
  // Removes the batches; the existing dataset already holds their trials.
  void drop_batches() { folder_.remove_batches(); }
  // Ends an unfinished run: finishes the batch. Returns the names of all batches; if there are
  // none, the destructor removes the folder.
  std::vector<std::string> keep();

 private:
  RunFolder folder_;
  DatasetHeader header_;
  std::uint64_t shard_limit_;
  std::uint64_t batch_limit_;
  std::vector<std::string> damaged_;
  std::vector<StoredTrial> trials_;     // trials of finished batches
  std::unique_ptr<DatasetFile> batch_;  // being written; null: no trial yet
  std::size_t batch_number_ = 0;        // number of `batch_`
  std::chrono::steady_clock::time_point batch_begin_ = std::chrono::steady_clock::now();
  std::vector<FailedTrial> failed_;
};

}  // namespace slipbench
