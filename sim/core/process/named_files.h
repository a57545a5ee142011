// Files that a file from others names: it may name those in its own folder, in the current folder
// and in the folders of the program, so that it cannot make the program read any other file.
#pragma once

#include <filesystem>
#include <string>

namespace slipbench {

// Throws InputError "PLACE: ..." if the file at `path` is outside of these folders, also by a link
// or by "..". Does not report a missing file: opening it does.
//
// `folder`: of the file that names it; empty: the current folder. `place`: where it is named.
// `remedy`: how the user can name the file, such as "--set model=PATH"; empty: only by starting the
// command in another folder.
void check_named_file(const std::filesystem::path& path, const std::filesystem::path& folder, const std::string& place,
                      const std::string& remedy);

// True if the file at `path`, which may be missing, is in one of these folders.
bool may_be_named(const std::filesystem::path& path, const std::filesystem::path& folder);

// Throws the error of check_named_file().
[[noreturn]] void refuse_named_file(const std::filesystem::path& path, const std::string& place, const std::string& remedy);

}  // namespace slipbench
