// Writing the dataset of a sweep, which may be killed at any instant.
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

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/run_folder.h"
#include "tools/base/dataset/stored_trial.h"
#include "tools/base/dataset/writer.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

class DatasetFile;

// Trials are written to batches, small HDF5 files in the folder of the run. A finished batch is closed, synced, renamed to its final name
// and not touched again, so it survives a kill and a power failure. commit() joins the batches to the dataset and removes them then. A
// sweep that is shorter than a batch has one only, which becomes the dataset without being copied.
// All functions throw InputError when something cannot be written. Use it from one thread.
class SweepWriter {
 public:
  // A batch is finished when its trials are the work of this time, so that with the syncing no more than 5 s are lost.
  static constexpr std::chrono::seconds batch_time{3};
  static constexpr std::uint64_t default_batch_limit = 256'000'000;  // bytes

  // Makes the run's folder, and refuses what cannot become a dataset as DatasetWriter does, but not finished batches. Call resume() or
  // refuse_left() next. `path`: the dataset's first file. `shard_limit`: a new file of the dataset begins before one would have more bytes.
  // `batch_limit`: a new batch begins likewise.
  SweepWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit = DatasetWriter::default_shard_limit,
              std::uint64_t batch_limit = default_batch_limit);
  ~SweepWriter();
  SweepWriter(const SweepWriter&) = delete;
  SweepWriter& operator=(const SweepWriter&) = delete;

  // Throws InputError where an earlier sweep has left batches.
  void refuse_left() const { folder_.refuse_batches(); }
  // Bytes that the caller makes of a trial.
  using Summarise = std::function<std::string(const TrialRecord& record)>;
  // Goes on with the batches that an earlier run of the same sweep has left. Returns what `summarise` makes of each of their trials.
  // A batch that is damaged, or does not hold its digests, gets ".damaged" behind its name and is named in damaged(). Throws InputError where a
  // batch, or without one the dataset that is there, was written by another run, where two batches hold the same trial with other content, and
  // where a batch cannot be read for reasons outside of it: all batches stay then.
  std::map<std::size_t, std::string> resume(const Summarise& summarise);
  // Names, as they are now, of the batches that resume() found damaged.
  [[nodiscard]] const std::vector<std::string>& damaged() const { return damaged_; }

  // Adds a trial. Trials come in ascending order, without those that resume() has returned. Finishes the batch before it would become too
  // large.
  void append(const EncodedTrial& trial);
  // Notes a trial that failed.
  void add_failed(FailedTrial failed) { failed_.push_back(std::move(failed)); }
  // When finish_batch() is to be called, unless the sweep is at its end. Empty while the batch has no trial.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> due() const;
  // Makes all trials so far survive whatever happens.
  void finish_batch();

  // Number of trials in finished batches.
  [[nodiscard]] std::size_t finished() const { return trials_.size(); }
  // The folder of the run.
  [[nodiscard]] const std::string& folder() const { return folder_.path(); }

  // Writes the dataset and returns the names of its files. Where it fails all batches stay.
  std::vector<std::string> commit();
  // Removes the batches: a dataset that is there already holds their trials.
  void drop_batches() { folder_.remove_batches(); }
  // Ends a run that did not come to its end: finishes the batch. Returns the names of all batches; without any the folder is removed.
  std::vector<std::string> keep();

 private:
  RunFolder folder_;
  DatasetHeader header_;
  std::uint64_t shard_limit_;
  std::uint64_t batch_limit_;
  std::vector<std::string> damaged_;
  std::vector<StoredTrial> trials_;     // of finished batches
  std::unique_ptr<DatasetFile> batch_;  // the one that is being written; null: it has no trial yet
  std::size_t batch_number_ = 0;        // its number
  std::chrono::steady_clock::time_point batch_begin_ = std::chrono::steady_clock::now();
  std::vector<FailedTrial> failed_;
};

}  // namespace slipbench
