// Reads datasets.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/output_file.h"

namespace slipbench {

// Attributes of a demo, cheap to read.
struct DemoInfo {
  std::size_t num_samples = 0;
  std::uint64_t seed = 0;
  std::string params;   // JSON object: path -> value of what was swept
  std::string outcome;  // JSON object, see TrialOutcome
};

// Root attributes of one file, independent of the other files of its dataset.
struct FileAbout {
  DatasetHeader header;
  std::uint64_t schema = 0;             // version of the format
  std::uint64_t shard = 0;              // index of the file in its dataset
  std::optional<std::uint64_t> shards;  // number of files; empty if the run was killed
  std::uint64_t trials = 0;             // number of trials in the file
  bool complete = false;                // true if the run finished
  std::vector<FailedTrial> failed;
};

// Returns the root attributes of a file; empty if it is HDF5 but not a dataset. Throws InputError
// if it cannot be read, or is an HDF5 file without any content, as a killed run may leave it.
std::optional<FileAbout> file_about(const std::string& path);

// A dataset of one or several shards, opened by the name of the first. Files that a killed or
// interrupted run left behind open too; complete() is false for them. All functions throw
// InputError, naming file and object, if the file is invalid. HDF5 itself may crash on damaged
// bytes: open untrusted files through checked_dataset.h. The HDF5 library is not thread-safe: use
// all readers and writers of a process from one thread.
class DatasetReader {
 public:
  explicit DatasetReader(const std::string& path);
  // Opens one file alone, whatever its index in its dataset.
  static DatasetReader of_file(const std::string& path);
  ~DatasetReader();
  DatasetReader(DatasetReader&&) noexcept;
  DatasetReader& operator=(DatasetReader&&) noexcept;

  [[nodiscard]] const DatasetHeader& header() const;
  // Names of the shards in order.
  [[nodiscard]] std::vector<std::string> files() const;
  // Digest of each shard in order (README.md defines it); empty strings if the run was killed.
  [[nodiscard]] const std::vector<std::string>& content_sha256() const;
  // Version of the format of one shard.
  [[nodiscard]] std::uint64_t schema(std::size_t file) const;
  // True if the run that wrote the dataset finished.
  [[nodiscard]] bool complete() const;

  // The k of every demo_<k>, ascending.
  [[nodiscard]] const std::vector<std::size_t>& trials() const;
  // The trials that failed, ascending; the dataset does not contain them.
  [[nodiscard]] const std::vector<FailedTrial>& failed() const;
  // Index into files() of the file that holds a trial.
  [[nodiscard]] std::size_t file_of(std::size_t trial) const;
  // Trials of a split: "train", "valid" or "test". Empty if the file has no masks (a killed run).
  [[nodiscard]] std::vector<std::size_t> mask(const std::string& split) const;
  // Split of each trial of a dataset with masks: "train", "valid", "test", or "none" for a trial in
  // no mask. Empty if the file has no masks.
  [[nodiscard]] std::map<std::size_t, std::string> split() const;

  [[nodiscard]] DemoInfo info(std::size_t trial) const;
  // Both are empty if only the outcome was recorded.
  [[nodiscard]] std::vector<std::string> sensors(std::size_t trial) const;
  [[nodiscard]] std::vector<std::string> bodies(std::size_t trial) const;
  // Throws InputError if only the outcome was recorded.
  void check_recorded(std::size_t trial) const;
  // Throws InputError if the recordings are imported: "FILE: WHAT needs the truth, which it does
  // not hold (none: imported from bts3v2); allowed: ALLOWED".
  void check_truth(const std::string& what, const std::string& allowed = "a dataset that slipbench has simulated") const;

  // Reads a whole trial. `material` stays empty: it is not stored per trial. An outcome of a
  // version without `detection` gets one by the current rule (settle_detection).
  [[nodiscard]] TrialRecord read_trial(std::size_t trial) const;
  // Type of a sensor: "papillarray".
  [[nodiscard]] std::string sensor_type(std::size_t trial, const std::string& sensor) const;
  // Reads one sensor's samples and labels.
  [[nodiscard]] SensorRecord read_sensor(std::size_t trial, const std::string& sensor) const;

  // Digest of the stored content of a trial, as README.md defines it for the schema of its file.
  // `read`: result of read_trial() for it, whose arrays are not read again; may be null.
  [[nodiscard]] Digest stored_digest(std::size_t trial, const TrialRecord* read = nullptr) const;
  // The trial's attribute `sha256`, 64 hexadecimal digits; empty in a file of schema 1, which lacks
  // it.
  [[nodiscard]] std::string trial_sha256(std::size_t trial) const;
  // Expected content_sha256 of a file, computed from the digests of all of its trials in ascending
  // order and from the rest of its content.
  [[nodiscard]] std::string stored_sha256(std::size_t file, const std::vector<std::pair<std::size_t, Digest>>& trials) const;

  // Reads one array by its path inside the demo, e.g. read<std::uint8_t>(3, "labels/pad/state"),
  // converted to T (float, double, std::uint8_t or std::uint32_t), in C order.
  template <class T>
  [[nodiscard]] std::vector<T> read(std::size_t trial, const std::string& path) const;
  // Extents of that array.
  [[nodiscard]] std::vector<std::size_t> shape(std::size_t trial, const std::string& path) const;

 private:
  DatasetReader();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
