// A folder of text files that appears whole.
#pragma once

#include <string>
#include <vector>

namespace slipbench::hd {

struct TextFile {
  std::string name;
  std::string text;
};

// Throws InputError when `folder` cannot be made or replaced: it is no folder, holds a file that is none of `own_names`, or the
// folder that it is to stand in cannot be made or written to.
void check_folder_target(const std::string& folder, const std::vector<std::string>& own_names);

// Writes the files to FOLDER.partial.PID, syncs them and moves that into place; folders above are made. What stood there is
// removed. Throws InputError when that is not possible; then it stands there still. Call check_folder_target before.
void write_folder(const std::string& folder, const std::vector<TextFile>& files);

// Moves the folder `fresh` to `target`, and what stood there to `stale`, which must be free. Throws std::system_error when that is
// not possible; then `target` is as it was.
void replace_folder(const std::string& fresh, const std::string& target, const std::string& stale);

}  // namespace slipbench::hd
