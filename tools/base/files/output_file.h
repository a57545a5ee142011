// What may be written to, and files that appear whole.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slipbench {

// A kind of text file that the program makes, told by its beginning from the files of others.
struct TextKind {
  std::string_view name;                       // "report"
  bool (*begins)(std::string_view beginning);  // of the file's first 4 kB
};

// Throws InputError when a file cannot be put at `path`: no file name, a folder, a special file, a symbolic link (which would be
// replaced, not followed), a read-only file, a missing folder.
void check_target(const std::string& path);

// The same for a text file made from `inputs` and written by write_text_file, and for the name that it has while it is written.
// Refuses besides the inputs themselves, and whatever holds something and does not begin as such a file.
void check_text_target(const std::string& path, const std::vector<std::string>& inputs, const TextKind& kind);

// The name of a file while it is written: OUT.h5.partial.
std::string temporary_path(const std::string& path);

// Throws InputError with the system's reason.
void rename_file(const std::string& from, const std::string& to);

// Writes `text` to PATH.partial, syncs it and renames it. Throws InputError when that is not possible; then nothing is left
// behind. Call check_text_target before.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace slipbench
