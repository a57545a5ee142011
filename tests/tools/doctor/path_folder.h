// A temporary folder of stand-in programs that is the whole PATH while it exists.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/files.h"

namespace slipbench {

class PathFolder {
 public:
  PathFolder() { setenv("PATH", folder_.path().c_str(), 1); }
  ~PathFolder() { setenv("PATH", old_path_.c_str(), 1); }

  // Adds a program that prints `output`, and returns its path. The script uses only the shell,
  // because PATH holds nothing else.
  std::string add_program(const std::string& name, const std::string& output) {
    std::string path = folder_ / name;
    std::ofstream(path) << "#!/bin/sh\necho '" << output << "'\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

 private:
  TemporaryFolder folder_;
  std::string old_path_ = std::getenv("PATH");
};

}  // namespace slipbench
