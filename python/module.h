// Functions that define the parts of the Python module, one per file.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "sim/scene/parser.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench::python {

// Overrides of a scene in Python: path and YAML.
using Pairs = std::vector<std::pair<std::string, std::string>>;
std::vector<Override> overrides_of(const Pairs& pairs);

// Warnings in Python: subject and text.
using Texts = std::vector<std::pair<std::string, std::string>>;
Texts texts_of(const std::vector<Warning>& warnings);

// Prints the result of a command on stdout and flushes it. Raises Python's OSError if stdout cannot
// be written.
void print_whole(const std::function<void()>& print);

void bind_commands(nanobind::module_& module);
void bind_trial(nanobind::module_& module);
void bind_scene(nanobind::module_& module);
void bind_own_parts(nanobind::module_& module);
void bind_environments(nanobind::module_& module);
void bind_studies(nanobind::module_& module);
void bind_values(nanobind::module_& module);
void bind_learning(nanobind::module_& module);
void bind_import(nanobind::module_& module);

}  // namespace slipbench::python
