// libslipbench_mujoco-VERSION.so: the plugin for one release of MuJoCo. This part does not depend
// on MuJoCo, so that both releases share its object file.
#include <algorithm>
#include <cstring>
#include <exception>
#include <string>

#include "sim/core/quantity.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

[[gnu::constructor]] void register_on_load() { register_field_plugin({pad_catalogues(), &make_sensor}); }

}  // namespace
}  // namespace slipbench

// C interface for slipbench.mujoco (python), called by ctypes. Each function writes up to
// `size` - 1 characters of its result and a zero to `text`, and returns the length of the whole
// result. On an error it returns -1 and `text` is the message.
namespace {

template <class Action>
int write_text(char* text, int size, const Action& action) {
  std::string written;
  int length = -1;
  try {
    written = action();
    length = static_cast<int>(written.size());
  } catch (const std::exception& error) {
    written = error.what();
  }
  const std::size_t shown = std::min(written.size(), static_cast<std::size_t>(size) - 1);
  std::memcpy(text, written.data(), shown);
  text[shown] = '\0';
  return length;
}

}  // namespace

extern "C" {

// Returns describe_pads() of sim/mujoco/pads/register_plugin.h.
[[gnu::visibility("default")]] int slipbench_describe_pads(const mjModel_* model, char* text, int size) {
  return write_text(text, size, [model] { return slipbench::describe_pads(model); });
}

// Returns longest_step() of the same file, as a number of seconds.
[[gnu::visibility("default")]] int slipbench_longest_step(const mjModel_* model, mjData_* data, char* text, int size) {
  return write_text(text, size, [model, data] { return slipbench::format_number(slipbench::longest_step(model, data)); });
}

}  // extern "C"
