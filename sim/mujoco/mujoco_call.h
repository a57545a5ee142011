// MuJoCo's C interface for C++: owners of its objects, and its fatal errors as exceptions.
#pragma once

#include <exception>
#include <memory>
#include <mutex>
#include <type_traits>

#include <mujoco/mujoco.h>

#include "sim/core/process/crash_guard.h"

namespace slipbench {

struct MujocoFree {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using SpecPointer = std::unique_ptr<mjSpec, MujocoFree>;
using ModelPointer = std::unique_ptr<mjModel, MujocoFree>;
using DataPointer = std::unique_ptr<mjData, MujocoFree>;

// Runs action(context). Where MuJoCo would end the process (mju_error) throws InputError with its text instead, or what
// carry_to_caller() was given; the mjData in use is then good for nothing but to be deleted. `action` must own nothing that needs a
// destructor: it is left by longjmp. The first call takes over mju_user_error and mju_user_warning for the whole process; warnings
// are then counted in mjData and not printed. Thread-safe.
void call_mujoco(void (*action)(void* context), void* context);

template <class Action>
void call_mujoco(Action&& action) {
  call_mujoco([](void* context) { (*static_cast<std::remove_reference_t<Action>*>(context))(); }, &action);
}

// MuJoCo's parser and compiler have a C++ run time of their own, whose std::bad_alloc ends the process. Where memory is limited (ulimit -v), no two of
// these objects live at a time, and making one throws std::bad_alloc where less is left than a model of the bench takes: make one around such calls.
class CompilerMemory {
 public:
  CompilerMemory();
  // Runs action(), which calls the compiler. Where it crashes throws std::bad_alloc if memory is limited, else SceneValueError at `path`.
  template <class Action>
  void run(const char* path, Action&& action) const {
    if (const int signal = run_guarded(action); signal != 0) tell_crash(path, signal);
  }

 private:
  [[noreturn]] void tell_crash(const char* path, int signal) const;

  std::unique_lock<std::mutex> alone_;
};

// For what MuJoCo calls back, before it ends with mju_error, which takes no more than a text: the call_mujoco() around it throws `error`
// itself. Does nothing where MuJoCo was called by others.
void carry_to_caller(std::exception_ptr error);

// Throws InputError where mjData has counted a warning, with MuJoCo's text, the time [s] and the body that it names, if any.
void refuse_warnings(const mjModel* model, const mjData* data, double time);

}  // namespace slipbench
