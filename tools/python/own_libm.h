// Whose sine the libraries call that a simulation runs through.
#pragma once

namespace slipbench::python {

// Makes the loaded MuJoCo, FFTW and NLopt call the functions of libm that this code is linked with (sim/core/CMakeLists.txt). In a program they do
// so by themselves, since its own precede libm's; in a library that another program has loaded, as Python's module is, libm's come first.
// Throws std::system_error where the tables of calls cannot be written.
void give_own_libm();

}  // namespace slipbench::python
