#include "sim/mujoco/mujoco_call.h"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "sim/core/error.h"

namespace slipbench {
namespace {

struct Call;
// The thread's innermost call.
thread_local Call* under_way = nullptr;
thread_local std::array<char, 1024> text;

struct Call {
  Call() = default;
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() { under_way = outer; }

  Call* outer = std::exchange(under_way, this);
  std::jmp_buf* way_back = nullptr;
  std::exception_ptr carried;
};

void on_error(const char* message) {
  if (under_way == nullptr) {  // outside of call_mujoco(): does what MuJoCo itself would do
    std::fprintf(stderr, "ERROR: %s\n", message);
    std::exit(EXIT_FAILURE);
  }
  std::snprintf(text.data(), text.size(), "%s", message);
  std::longjmp(*under_way->way_back, 1);
}

void on_warning(const char*) {}

// Runs the action; true if MuJoCo left it through its error handler.
bool jumps_back(Call& call, void (*action)(void*), void* context) {
  std::jmp_buf here;
  call.way_back = &here;
  if (setjmp(here) != 0) return true;
  action(context);
  return false;
}

}  // namespace

void call_mujoco(void (*action)(void* context), void* context) {
  [[maybe_unused]] static const bool installed = [] {
    mju_user_error = on_error;
    mju_user_warning = on_warning;
    return true;
  }();
  Call call;
  if (!jumps_back(call, action, context)) return;
  if (call.carried) std::rethrow_exception(call.carried);
  throw InputError(text.data());
}

void carry_to_caller(std::exception_ptr error) {
  if (under_way != nullptr) under_way->carried = std::move(error);
}

}  // namespace slipbench
