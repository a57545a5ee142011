// Counts the instructions of the reference scenes.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/catalogues.h"
#include "tools/studies/counts/results.h"

namespace slipbench::counts {

// The scenes whose cost is kept, from the project's root: one for each kind of thing the program does.
std::span<const std::string_view> reference_scenes();

struct CountOptions {
  std::size_t jobs = 1;                          // scenes counted at a time; a count does not depend on it
  std::size_t timings = 0;                       // runs of each scene without valgrind, whose median CPU time is kept; 0: none
  const std::atomic<bool>* interrupt = nullptr;  // once true, running counts finish and no other starts
  std::function<void(const SceneCount&)> on_counted = {};  // called after each, in order; may be empty
};

// The path of valgrind. Throws InputError, which says how to get it, where it is not on PATH.
std::string find_valgrind();

// What decides the counts of this program on this machine: compiler, flags, instruction set, libraries, valgrind. Throws as
// find_valgrind.
Facts build_facts();

// What else is worth knowing of it: version, commit, system, processor, libraries.
Facts context_facts();

// Runs the first trial of each reference scene with this very program under callgrind, and counts what run_trial spends: bench,
// sensors, detectors, controllers, set-up of the trial included, start of the program, reading of the scene and output not.
// Empty when interrupted. Throws InputError where valgrind is missing or fails, and where a scene cannot be found.
std::optional<Results> count_reference_scenes(const CountOptions& options, const Catalogues& catalogues);

// Another program, run to its end.

// A file's bytes; throws InputError where it cannot be read.
std::string file_text(const std::filesystem::path& path);

// Runs the program words[0] in `folder` with `environment` ("NAME=value") and nothing else of this program's, its streams in
// `folder`/out and `folder`/err. Returns the exit status, 128 + signal where a signal ended it. Throws InputError where it
// cannot be started.
int run_child(std::vector<std::string> words, const std::filesystem::path& folder, std::vector<std::string> environment);

}  // namespace slipbench::counts
