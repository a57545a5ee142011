// What the networks of a study have said, on the disk as soon as each is done: a study that is killed or interrupted need not teach them again.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "tools/base/files/output_file.h"

namespace slipbench::reproduce {

// A study teaches its networks in sets, one after the other, and each time in the same order. The file has a line that says whose it is, and
// a record of each network that is done: set, number, its bytes and their SHA-256. A last record that a killed run has left unfinished is dropped.
class KeptNetworks {
 public:
  // `of`: all that decides what the networks say, as the command and its options, the data and the program. `resume`: goes on with what the file holds; else
  // it begins anew. Throws InputError where the file cannot be written, is damaged before its end, holds networks and `resume` is false, or is not `of`.
  KeptNetworks(std::string path, const std::string& of, bool resume);

  // A file without a network goes.
  ~KeptNetworks();
  KeptNetworks(const KeptNetworks&) = delete;
  KeptNetworks& operator=(const KeptNetworks&) = delete;

  // The next set of networks begins.
  void begin_set() { ++set_; }
  // What network `index` of the set has said; null: it has to be taught.
  [[nodiscard]] const std::string* find(std::size_t index) const;
  // Keeps it: once this returns it is on the disk. Throws InputError with the system's reason.
  void keep(std::size_t index, const std::string& said);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::size_t size() const { return said_.size(); }  // networks of all sets
  // The study is done: the file goes.
  void remove();

 private:
  std::string path_;
  Descriptor file_;
  std::size_t set_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, std::string> said_;  // by set and number
};

}  // namespace slipbench::reproduce
