// Trials as a file stores them: compressed, ready to be stored again.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/hdf5/hdf5_place.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

// k of the member "demo_<k>" of the list of trials, or of one of the names that it holds. Throws InputError for another name.
std::size_t trial_number(const hdf5::Place& list, const std::string& name);

// Trial `trial` at its place in a file: its chunks are those of the file, and are not unfolded. `material` stays empty. Throws InputError where it
// is not stored as this program does it.
EncodedTrial read_encoded(const hdf5::Place& demo, std::size_t trial);

// The trials of one shard of a sweep in ascending order. One of its files is open at a time, and of that one trial in memory. All functions
// throw InputError when a file is not what it should be. HDF5 itself may crash on damaged bytes: call check_readable() first.
class StoredTrials {
 public:
  // `path`: the shard's first file; `about`: its file_about(). Refuses what is no shard of a sweep, and one whose run did not come to its end.
  StoredTrials(std::string path, std::optional<FileAbout> about);

  // What the shard says of itself; `split` is set.
  [[nodiscard]] const FileAbout& about() const { return about_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  // Names of its files.
  [[nodiscard]] std::vector<std::string> files() const;
  // Numbers of all its trials, ascending, and the groups that they are split by. Opens each file once, and goes back to the first trial.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::string>> list();

  // The number of the trial at which it stands; empty: after the last.
  [[nodiscard]] std::optional<std::size_t> trial();
  // Its attribute sha256, 64 hexadecimal digits.
  [[nodiscard]] std::string sha256();
  // The trial by read_encoded(), with its group.
  [[nodiscard]] EncodedTrial read();
  // Goes to the next one. After the last of a file: throws InputError where the file's content_sha256 is not that of its trials' digests and of
  // what it holds beside them.
  void advance();

 private:
  void open(std::size_t file);
  [[nodiscard]] hdf5::Place place(const std::string& object) const { return {file_.get(), name_, object}; }

  std::string path_;
  FileAbout about_;
  std::size_t index_ = 0;  // of the open file
  std::string name_;       // its name
  hdf5::Handle file_;
  std::string content_sha256_;
  std::vector<std::pair<std::size_t, std::string>> trials_;  // of the open file
  std::size_t next_ = 0;
  std::vector<std::pair<std::size_t, Digest>> digests_;
};

}  // namespace slipbench
