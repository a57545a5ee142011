// Writing datasets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/files/output_file.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// What a run that did not come to its end has left, for one that goes on with it.

// The trials that were left of the dataset `path`. A killed run leaves OUT.h5.partial, an interrupted one OUT.partial.h5; one
// that went on with the other's and was killed leaves both, of which the one with more trials counts.
class KeptTrials {
 public:
  // Without anything left it holds no trial. Otherwise what is left has the names after an interrupt from then on; files that
  // lack nothing but their own names get these. Throws InputError when another run is writing it, when it cannot be read, and
  // when what the runs, or that of a dataset which is there, say of themselves is not the same: the message names what differs,
  // and nothing is changed.
  KeptTrials(const std::string& path, const DatasetHeader& header);

  [[nodiscard]] std::size_t size() const { return trials_.size(); }
  [[nodiscard]] bool holds(std::size_t trial) const;
  // Names of its files.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

  // What is told of a trial, and the trial as it is stored, both without its material.
  struct Trial {
    TrialRecord counts;
    EncodedTrial encoded;
  };
  // Empty where its digest does not hold or it cannot be read. Damage may end the process: read each one in a child process first.
  [[nodiscard]] std::optional<Trial> read(std::size_t trial) const;

 private:
  Descriptor lock_;  // of what is left: no other run goes on with it meanwhile
  std::vector<std::size_t> trials_;
  std::vector<std::string> files_;
  std::optional<DatasetReader> reader_;  // empty: there is nothing left
};

// A dataset whose run came to its end.
struct FinishedDataset {
  std::size_t trials = 0;
  std::vector<FailedTrial> failed;
  std::vector<std::string> files;
};

// The dataset at `path`, where it says `header` of itself. Empty where there is none, where its run did not come to its end, and
// where it cannot be read.
std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header);

// What two runs say differently of themselves, as a clause: "seed 7, this run has 8; ...". `other`: what the second one is called. Empty:
// nothing.
std::string header_difference(const DatasetHeader& left, const DatasetHeader& now, const std::string& other = "this run");

// Writes the trials of a dataset to OUT.h5.partial (and OUT-0001.h5.partial, ... when a file would grow over the limit or get
// more than most_trials_per_file). A killed run leaves the trials that were published. Only commit() makes the final names
// appear. The bytes depend on the header and the trials alone. All functions throw InputError with the system's reason when the
// target cannot be written. The HDF5 library is not thread-safe: use all readers and writers of a process from one thread.
class DatasetWriter {
 public:
  static constexpr std::uint64_t default_shard_limit = 1'000'000'000;  // bytes

  // Refuses at once what cannot become a dataset: a folder, a special file, a symbolic link, a read-only file, a missing folder,
  // a target that another run is writing, and files that are not this dataset's to replace, such as the scene itself
  // (dataset_target.h). Call it before any thread is made. `planned`: trials that will come, for which a file makes room in its
  // list beforehand. `kept`: what a run that did not come to its end has left of this dataset, which stays until commit(), or
  // until keep_partial() leaves as much; null: nothing may be there.
  DatasetWriter(std::string path, DatasetHeader header, std::size_t planned = most_trials_per_file,
                std::uint64_t shard_limit = default_shard_limit, const KeptTrials* kept = nullptr);
  // Without commit() or keep_partial(): the same as keep_partial(), errors ignored.
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  // Adds a trial. Trials come in ascending order. Refuses to begin a further file where another stands in its way.
  void append(const EncodedTrial& trial);
  // Notes a trial that failed; the files get all of these when they are finished.
  void add_failed(FailedTrial failed);
  // All trials so far are safe: whatever happens to the process or to the machine's power, the files can be read and hold them.
  // Costs two syncs of the disk; when it is called does not change a byte of the finished dataset.
  void publish();
  // Trials appended; after keep_partial() those that the files hold which it names.
  [[nodiscard]] std::size_t size() const;
  // Trials that are safe.
  [[nodiscard]] std::size_t published() const;

  // Writes masks and digests, closes, syncs and renames to the final names, which it returns. What earlier runs that did not
  // come to their end have left of this target is removed, and so are the further files of the dataset that is replaced.
  std::vector<std::string> commit();
  // Ends a run that did not come to its end: what is finished is kept under OUT.partial.h5, whose names are returned; without a
  // finished trial nothing is left. Works after a failed append too.
  std::vector<std::string> keep_partial();
  // Ends a run of which nothing is to be kept: what it has written is removed. Not of one that goes on with `kept`.
  void discard();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
