// Reading datasets.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/files/output_file.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// What a demo says of itself, cheap to read.
struct DemoInfo {
  std::size_t num_samples = 0;
  std::uint64_t seed = 0;
  std::string params;   // JSON object: path -> value of what was swept
  std::string outcome;  // JSON object, see TrialOutcome
};

// What the root of one file says, whatever the other files of its dataset.
struct FileAbout {
  DatasetHeader header;
  std::uint64_t schema = 0;             // version of the format
  std::uint64_t shard = 0;              // which file of its dataset it is
  std::optional<std::uint64_t> shards;  // of how many; empty where the run was killed
  std::uint64_t trials = 0;             // that it holds
  bool complete = false;                // whether the run came to its end
  std::vector<FailedTrial> failed;
};

// Empty when the file is HDF5 and no dataset. Throws InputError when it cannot be read, also when it is an HDF5 file that holds
// nothing at all, as a killed run may leave it.
std::optional<FileAbout> file_about(const std::string& path);

// A dataset of one or several shards, opened by the name of the first. A file that a killed or interrupted run left behind opens
// as well: complete() says which. All functions throw InputError when the file is not what it should be, naming file and place.
// HDF5 itself may crash on damaged bytes: a program opens files that are not its own by checked_dataset.h.
// The HDF5 library is not thread-safe: use all readers and writers of a process from one thread.
class DatasetReader {
 public:
  explicit DatasetReader(const std::string& path);
  // One file alone, whichever it is of its dataset.
  static DatasetReader of_file(const std::string& path);
  ~DatasetReader();
  DatasetReader(DatasetReader&&) noexcept;
  DatasetReader& operator=(DatasetReader&&) noexcept;

  [[nodiscard]] const DatasetHeader& header() const;
  // Names of the shards in order.
  [[nodiscard]] std::vector<std::string> files() const;
  // The digest of each shard in order (README.md says over what); empty strings where the run was killed.
  [[nodiscard]] const std::vector<std::string>& content_sha256() const;
  // Version of the format of one shard.
  [[nodiscard]] std::uint64_t schema(std::size_t file) const;
  // Whether the run that wrote it came to its end.
  [[nodiscard]] bool complete() const;

  // The k of every demo_<k>, ascending.
  [[nodiscard]] const std::vector<std::size_t>& trials() const;
  // The trials that failed, ascending: the dataset does not hold them.
  [[nodiscard]] const std::vector<FailedTrial>& failed() const;
  // Index into files() of the one that holds a trial.
  [[nodiscard]] std::size_t file_of(std::size_t trial) const;
  // Trials of a split: "train", "valid" or "test". Empty where the file has no masks (a killed run).
  [[nodiscard]] std::vector<std::size_t> mask(const std::string& split) const;
  // The part of each trial of a dataset with masks: "train", "valid", "test", or "none" for a trial
  // that no mask names. Empty where the file has no masks.
  [[nodiscard]] std::map<std::size_t, std::string> split() const;

  [[nodiscard]] DemoInfo info(std::size_t trial) const;
  // Both are empty where only the outcome was recorded.
  [[nodiscard]] std::vector<std::string> sensors(std::size_t trial) const;
  [[nodiscard]] std::vector<std::string> bodies(std::size_t trial) const;
  // Throws InputError where only the outcome was recorded.
  void check_recorded(std::size_t trial) const;
  // Throws InputError where the recordings are imported: "FILE: WHAT needs the truth, which it does not hold (none: imported from
  // bts3v2); allowed: ALLOWED".
  void check_truth(const std::string& what, const std::string& allowed = "a dataset that slipbench has simulated") const;

  // Everything of one trial. `material` is not stored a trial and stays empty. A file of a version before outcomes had
  // `detection` gets one by today's rule (settle_detection).
  [[nodiscard]] TrialRecord read_trial(std::size_t trial) const;
  // What a sensor is: "papillarray".
  [[nodiscard]] std::string sensor_type(std::size_t trial, const std::string& sensor) const;
  // One sensor's samples and labels.
  [[nodiscard]] SensorRecord read_sensor(std::size_t trial, const std::string& sensor) const;

  // The digest of what the file holds of a trial, as README.md says for the schema of its file. `read`: its read_trial(), whose arrays are not read
  // again; null: none.
  [[nodiscard]] Digest stored_digest(std::size_t trial, const TrialRecord* read = nullptr) const;
  // What its attribute `sha256` says, 64 hexadecimal digits; empty in a file of schema 1, which has none.
  [[nodiscard]] std::string trial_sha256(std::size_t trial) const;
  // What a file's content_sha256 should say, made of the digests of all of its trials in ascending order and of what it holds
  // beside them.
  [[nodiscard]] std::string stored_sha256(std::size_t file, const std::vector<std::pair<std::size_t, Digest>>& trials) const;

  // One array by its path inside the demo, e.g. read<std::uint8_t>(3, "labels/pad/state"), converted to T (float, double,
  // std::uint8_t or std::uint32_t), in C order.
  template <class T>
  [[nodiscard]] std::vector<T> read(std::size_t trial, const std::string& path) const;
  // Its extents.
  [[nodiscard]] std::vector<std::size_t> shape(std::size_t trial, const std::string& path) const;

 private:
  DatasetReader();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
