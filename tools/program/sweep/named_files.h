// The files that decide what a scene's trials give, beside the scene itself.
#pragma once

#include <map>
#include <set>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Adds the paths that the scene names: its model, and parameters of type path that are not at their default. A model's own
// includes and meshes are not among them.
void add_named_files(const Scene& scene, const Catalogues& catalogues, std::set<std::string>& paths);

// SHA-256 as 64 hexadecimal digits, by path; a folder stands for the files in it. Throws InputError for what cannot be read.
std::map<std::string, std::string> digests_of(const std::set<std::string>& paths);

}  // namespace slipbench
