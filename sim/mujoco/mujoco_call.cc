#include "sim/mujoco/mujoco_call.h"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

thread_local std::jmp_buf* way_back = nullptr;
thread_local std::array<char, 1024> text;
thread_local std::exception_ptr carried;

void on_error(const char* message) {
  if (way_back == nullptr) {  // not called by way of call_mujoco(): what MuJoCo itself would do
    std::fprintf(stderr, "ERROR: %s\n", message);
    std::exit(EXIT_FAILURE);
  }
  std::snprintf(text.data(), text.size(), "%s", message);
  std::longjmp(*way_back, 1);
}

void on_warning(const char*) {}

// The body of the degree of freedom or coordinate that a warning names, or nothing.
std::string body_of(const mjModel* model, int warning, int info) {
  int body = -1;
  if (warning == mjWARN_INERTIA || warning == mjWARN_BADQVEL || warning == mjWARN_BADQACC) {
    if (info >= 0 && info < model->nv) body = model->dof_bodyid[info];
  } else if (warning == mjWARN_BADQPOS) {
    for (int j = 0; j < model->njnt; ++j) {
      if (model->jnt_qposadr[j] <= info) body = model->jnt_bodyid[j];
    }
  }
  const char* name = body < 0 ? nullptr : mj_id2name(model, mjOBJ_BODY, body);
  return name == nullptr ? "" : fmt::format(", body '{}'", name);
}

}  // namespace

void call_mujoco(void (*action)(void* context), void* context) {
  [[maybe_unused]] static const bool installed = [] {
    mju_user_error = on_error;
    mju_user_warning = on_warning;
    return true;
  }();
  std::jmp_buf here;
  std::jmp_buf* const outer = way_back;
  if (setjmp(here) == 0) {
    way_back = &here;
    action(context);
    way_back = outer;
    return;
  }
  way_back = outer;
  if (carried) std::rethrow_exception(std::exchange(carried, nullptr));
  throw InputError(text.data());
}

void carry_to_caller(std::exception_ptr error) {
  if (way_back != nullptr) carried = std::move(error);
}

void refuse_warnings(const mjModel* model, const mjData* data, double time) {
  for (int w = 0; w < mjNWARNING; ++w) {
    if (data->warning[w].number == 0) continue;
    const int info = data->warning[w].lastinfo;
    throw InputError(fmt::format("MuJoCo warns: {} (at {:.6g} s{})", mju_warningText(w, static_cast<std::size_t>(info)), time,
                                 body_of(model, w, info)));
  }
}

}  // namespace slipbench
