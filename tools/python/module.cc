#include "tools/python/module.h"

#include <exception>

#include "sim/core/error.h"
#include "sim/core/interrupted.h"

namespace nb = nanobind;

// The extension `_core`: what the package `slipbench` is made of, which documents it.
NB_MODULE(_core, module) {
  nb::set_leak_warnings(false);  // detectors that a user registers live as long as the process
  const nb::exception<slipbench::InputError> input_error(module, "InputError", PyExc_ValueError);
  nb::register_exception_translator([](const std::exception_ptr& error, void*) {
    try {
      std::rethrow_exception(error);
    } catch (const slipbench::Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
  module.attr("__version__") = SLIPBENCH_VERSION;
  slipbench::python::bind_trial(module);
  slipbench::python::bind_own_parts(module);
  slipbench::python::bind_scene(module);
  slipbench::python::bind_environments(module);
}
