// libslipbench_mujoco.so, for mj_loadPluginLibrary of any MuJoCo. It links to no MuJoCo: it finds
// those that are loaded, and registers the plugin of sim/mujoco in each, with the names of
// tools/registry.
#include <algorithm>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "sim/mujoco/releases/mujoco_library.h"
#include "sim/mujoco/releases/release_table.h"
#include "tools/plugin/loaded_mujocos.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

std::string own_folder() {
  static const char here = 0;
  Dl_info info{};
  return ::dladdr(&here, &info) != 0 ? std::filesystem::path(info.dli_fname).parent_path().string() : std::string();
}

// A MuJoCo in which the plugin is registered.
struct Registered {
  std::string version;
  std::unique_ptr<MujocoLibrary> mujoco;
};

// Never destroyed: models may outlive the static objects of this library.
std::vector<Registered>& registered() {
  static std::vector<Registered>& all = *new std::vector<Registered>;
  return all;
}

// Throws InputError if the library lacks a function that every release has.
std::unique_ptr<MujocoLibrary> functions_of(void* loaded) {
  auto mujoco = std::make_unique<MujocoLibrary>();
  const auto find = [loaded](const char* name, auto& function) {
    function = mujoco_function<std::remove_reference_t<decltype(function)>>(loaded, name);
    return function != nullptr;
  };
  const auto need = [&](const char* name, auto& function) {
    if (!find(name, function)) throw InputError(std::string("MuJoCo has no function ") + name);
  };
#define SLIPBENCH_FUNCTION(result, name, parameters) need(#name, mujoco->name);
  SLIPBENCH_MUJOCO_FUNCTIONS(SLIPBENCH_FUNCTION)
#undef SLIPBENCH_FUNCTION
  need("mj_fullM", mujoco->mj_fullM);
  return mujoco;
}

// Throws InputError if the release is not supported.
void register_in(void* loaded, const std::string& file) {
  const std::string version = version_of(loaded);
  if (version.empty()) throw InputError(file + " does not state its version");
  const std::optional<SlipbenchLayout> layout = find_layout(version, own_folder());
  if (!layout) throw InputError(how_to_add(version, own_folder(), file));
  std::unique_ptr<MujocoLibrary> mujoco = functions_of(loaded);
  mujoco->layout = *layout;
  if (mujoco->mj_version() != layout->version) throw InputError(file + " states two versions");
  if (layout->discrete >= 0) {  // its name was mjd_effShift in 3.14 and 3.15
    mujoco->mj_arenaAllocByte = mujoco_function<decltype(mujoco->mj_arenaAllocByte)>(loaded, "mj_arenaAllocByte");
    for (const char* name : {"mj_effShift", "mjd_effShift"}) {
      if (mujoco->mj_effShift == nullptr) mujoco->mj_effShift = mujoco_function<decltype(mujoco->mj_effShift)>(loaded, name);
    }
  }
  if (!register_plugin(*mujoco, field_plugin_name, {pad_catalogues(), &make_sensor}, nullptr)) {
    throw InputError(file + " is one MuJoCo too many in this process");
  }
  registered().push_back({version, std::move(mujoco)});
}

[[gnu::constructor]] void register_on_load() {
  const std::vector<std::string> files = loaded_mujocos();
  if (files.empty()) warn(nullptr, "slipbench.field: no libmujoco.so is loaded, so the plugin is not registered");
  for (const std::string& file : files) {
    void* const loaded = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    try {
      register_in(loaded, file);
    } catch (const std::exception& error) {
      warn(loaded, std::string("slipbench.field: ") + error.what());
    }
  }
}

// Returns the MuJoCo of this version. Throws InputError if it is not loaded.
const MujocoLibrary& mujoco_of(const char* version) {
  for (const Registered& one : registered()) {
    if (one.version == version) return *one.mujoco;
  }
  throw InputError(std::string("the plugin is not registered in MuJoCo ") + version);
}

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

// Returns describe_pads() of sim/mujoco/pads/register_plugin.h. `version`: of the model's MuJoCo.
[[gnu::visibility("default")]] int slipbench_describe_pads(const char* version, const mjModel_* model, char* text, int size) {
  return write_text(text, size, [=] { return slipbench::describe_pads({model, slipbench::mujoco_of(version)}); });
}

// Returns longest_step() of the same file, as a number of seconds.
[[gnu::visibility("default")]] int slipbench_longest_step(const char* version, const mjModel_* model, mjData_* data, char* text,
                                                          int size) {
  return write_text(text, size, [=] {
    const slipbench::MujocoLibrary& mujoco = slipbench::mujoco_of(version);
    return slipbench::format_number(slipbench::longest_step({model, mujoco}, {data, mujoco}));
  });
}

}  // extern "C"
