// The folder that an export writes into.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/files/output_file.h"

namespace slipbench {

// Made when the first file is ready to be written, and removed again where none could be.
class OutputFolder {
 public:
  // `inputs`: files that are never replaced. `compress`: files are written by gzip, with .gz behind their names. Touches nothing.
  OutputFolder(std::string path, std::vector<std::string> inputs, bool compress = false)
      : path_(std::move(path)), inputs_(std::move(inputs)), compress_(compress) {}
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Writes PATH/NAME, where NAME may begin with one folder more, and returns that path. Throws InputError when it cannot be
  // written or something stands there that is not of this kind.
  std::string write(const std::string& name, const TextKind& kind, const std::string& bytes);
  // Makes the folder, and returns PATH/NAME for a file that someone else will write. Throws InputError for a name with control
  // characters and for one that leads out of the folder.
  std::string prepare(const std::string& name);

  [[nodiscard]] const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  void make(const std::string& folder);

  std::string path_;
  std::vector<std::string> inputs_;
  bool compress_;
  std::vector<std::string> made_;
};

// Text files in the container of gzip.

// As `gzip` writes it, without a name or a time: the same text gives the same bytes.
std::string gzip(std::string_view text);

// The text of a file of gzip that begins so, up to 64 kB of it; empty: it is none.
std::string beginning_of_gzip(std::string_view bytes);

}  // namespace slipbench
