// Another program, run to its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slipbench::counts {

// A file's bytes; throws InputError where it cannot be read.
std::string file_text(const std::filesystem::path& path);

// Runs the program words[0] in `folder` with `environment` ("NAME=value") and nothing else of this program's, its streams in
// `folder`/out and `folder`/err. Returns the exit status, 128 + signal where a signal ended it. Throws InputError where it
// cannot be started.
int run_child(std::vector<std::string> words, const std::filesystem::path& folder, std::vector<std::string> environment);

}  // namespace slipbench::counts
