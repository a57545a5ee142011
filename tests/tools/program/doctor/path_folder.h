// A temporary folder of stand-in programs that is all of PATH while it lives.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace slipbench {

class PathFolder {
 public:
  PathFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "slipbench_doctor_").string() + std::string(6, 'X');
    folder_ = mkdtemp(name.data());
    setenv("PATH", folder_.c_str(), 1);
  }
  ~PathFolder() {
    std::filesystem::remove_all(folder_);
    setenv("PATH", old_path_.c_str(), 1);
  }
  PathFolder(const PathFolder&) = delete;
  PathFolder& operator=(const PathFolder&) = delete;

  // Adds a program that prints `output`, and returns its path. The script needs the shell alone: PATH holds nothing else.
  std::string add_program(const std::string& name, const std::string& output) {
    const std::filesystem::path path = folder_ / name;
    std::ofstream(path) << "#!/bin/sh\necho '" << output << "'\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path.string();
  }

 private:
  std::filesystem::path folder_;
  std::string old_path_ = std::getenv("PATH");
};

}  // namespace slipbench
