#include "python/module.h"

#include <cerrno>
#include <cstdio>
#include <exception>
#include <system_error>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/mujoco/releases/release_table.h"

namespace nb = nanobind;

std::vector<slipbench::Override> slipbench::python::overrides_of(const Pairs& pairs) {
  std::vector<Override> overrides;
  for (const auto& [path, value] : pairs) overrides.push_back({path, value});
  return overrides;
}

void slipbench::python::print_whole(const std::function<void()>& print) {
  try {
    print();
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  } catch (const std::system_error& error) {  // of fmt
    errno = error.code().value();
  }
  PyErr_SetFromErrno(PyExc_OSError);
  throw nb::python_error();
}

// The extension `_core`, which the package `slipbench` wraps and documents.
NB_MODULE(_core, module) {
  nb::set_leak_warnings(false);  // registered user classes live as long as the process
  nb::exception<slipbench::InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
      "Bad input, a ValueError, with the message of the program: file:line, what is wrong, and what would be right.";
  nb::register_exception_translator([](const std::exception_ptr& error, void*) {
    try {
      std::rethrow_exception(error);
    } catch (const slipbench::Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
  module.attr("version") = SLIPBENCH_VERSION;
  module.def("known_releases", &slipbench::known_releases);
  module.def("check_release", [](const std::string& version, const std::string& folder, const std::string& mujoco_file) {
    if (!slipbench::find_layout(version, folder))
      throw slipbench::InputError(slipbench::how_to_add(version, folder, mujoco_file));
  });
  slipbench::python::bind_commands(module);
  slipbench::python::bind_trial(module);
  slipbench::python::bind_own_parts(module);
  slipbench::python::bind_scene(module);
  slipbench::python::bind_environments(module);
  slipbench::python::bind_studies(module);
  slipbench::python::bind_values(module);
  slipbench::python::bind_learning(module);
  slipbench::python::bind_import(module);
}
