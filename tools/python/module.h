// The parts of Python's module, a file each.
#pragma once

#include <nanobind/nanobind.h>

namespace slipbench::python {

void bind_trial(nanobind::module_& module);
void bind_scene(nanobind::module_& module);
void bind_own_parts(nanobind::module_& module);
void bind_environments(nanobind::module_& module);

}  // namespace slipbench::python
