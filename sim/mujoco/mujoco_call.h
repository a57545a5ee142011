// MuJoCo's C interface for C++: owners of its objects, and its fatal errors as exceptions.
#pragma once

#include <exception>
#include <memory>
#include <type_traits>

#include <mujoco/mujoco.h>

namespace slipbench {

struct MujocoFree {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using SpecPointer = std::unique_ptr<mjSpec, MujocoFree>;
using ModelPointer = std::unique_ptr<mjModel, MujocoFree>;
using DataPointer = std::unique_ptr<mjData, MujocoFree>;

// Runs action(context). Where MuJoCo would end the process (mju_error), throws InputError with its
// text instead, or the argument of carry_to_caller(); the mjData in use may then only be deleted.
// `action` must own nothing that needs a destructor: it is left by longjmp. The first call sets
// mju_user_error and mju_user_warning for the whole process; warnings are then counted in mjData
// and not printed. Thread-safe.
void call_mujoco(void (*action)(void* context), void* context);

template <class Action>
void call_mujoco(Action&& action) {
  call_mujoco([](void* context) { (*static_cast<std::remove_reference_t<Action>*>(context))(); }, &action);
}

// For callbacks of MuJoCo, before they call mju_error, which accepts only a text: makes the
// call_mujoco() around it throw `error` itself. Does nothing if MuJoCo was called by other code.
void carry_to_caller(std::exception_ptr error);

}  // namespace slipbench
