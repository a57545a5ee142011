// What a run that did not come to its end has left, for one that goes on with it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/files/output_file.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// The trials that were left of the dataset `path`. A killed run leaves OUT.h5.partial, an interrupted one OUT.partial.h5; one
// that went on with the other's and was killed leaves both, of which the one with more trials counts.
class KeptTrials {
 public:
  // Without anything left it holds no trial. Otherwise what is left has the names after an interrupt from then on; files that
  // lack nothing but their own names get these. Throws InputError when another run is writing it, when it cannot be read, and
  // when what the runs, or that of a dataset which is there, say of themselves is not the same: the message names what differs,
  // and nothing is changed. Call it before any thread is made (guarded.h).
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
  // Empty where its digest does not hold or it cannot be read. Damage may end the process: call it in one that may end (isolated_worker.h), which then
  // opens the files for itself.
  [[nodiscard]] std::optional<Trial> read(std::size_t trial) const;

 private:
  Descriptor lock_;  // of what is left: no other run goes on with it meanwhile
  std::vector<std::size_t> trials_;
  std::vector<std::string> files_;
  mutable std::optional<DatasetReader> reader_;  // made by the first read()
};

// A dataset whose run came to its end.
struct FinishedDataset {
  std::size_t trials = 0;
  std::vector<FailedTrial> failed;
  std::vector<std::string> files;
};

// The dataset at `path`, where it says `header` of itself. Empty where there is none, where its run did not come to its end, and
// where it cannot be read. Call it before any thread is made (guarded.h).
std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header);

// What two runs say differently of themselves, as a clause: "seed 7, this run has 8; ...". `other`: what the second one is called. Empty:
// nothing.
std::string header_difference(const DatasetHeader& left, const DatasetHeader& now, const std::string& other = "this run");

}  // namespace slipbench
