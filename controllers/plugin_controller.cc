#include <dlfcn.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <string>

#include "controllers/controller_kinds.h"
#include "controllers/grip.h"
#include "controllers/plugin_abi.h"
#include "sim/core/error.h"

namespace slipbench::controllers {
namespace {

constexpr const char* no_library = "none";

[[noreturn]] void refuse(const std::string& what) { throw SceneValueError("controller.library", what); }

// A shared library, for as long as the object lives.
class Library {
 public:
  explicit Library(const std::string& path) : name_("'" + path + "'") {
    if (!std::filesystem::exists(path)) refuse("no file " + name_ + "; allowed: the path of a shared library");
    handle_.reset(dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL));  // a bare name would be searched for
    if (!handle_) refuse("cannot load " + name_ + ": " + dlerror() + "; allowed: a shared library");
  }

  [[nodiscard]] const std::string& name() const { return name_; }  // for messages

  [[nodiscard]] void* symbol(const char* name) const {
    void* address = dlsym(handle_.get(), name);
    if (address == nullptr) {
      refuse(name_ + " has no symbol '" + name + "'; allowed: a library that exports what controllers/plugin_abi.h declares");
    }
    return address;
  }

 private:
  struct Close {
    void operator()(void* handle) const { dlclose(handle); }
  };
  std::string name_;
  std::unique_ptr<void, Close> handle_;
};

class Plugin final : public Controller {
 public:
  Plugin(const std::string& path, const GripSource& source) : library_(path), preset_(source.preset) {
    const unsigned version = *static_cast<const unsigned*>(library_.symbol("slipbench_controller_abi"));
    if (version != SLIPBENCH_CONTROLLER_ABI) {
      refuse(library_.name() + " was built for version " + std::to_string(version) +
             " of the interface; allowed: " + std::to_string(SLIPBENCH_CONTROLLER_ABI));
    }
    const auto make =
        reinterpret_cast<decltype(&slipbench_make_controller)>(library_.symbol("slipbench_make_controller"));  // as POSIX has it
    std::vector<slipbench_channel> announced;
    for (const Channel& channel : source.channels) {
      announced.push_back({channel.name.c_str(), channel.unit.c_str(), channel.shape.data(), channel.shape.size()});
    }
    controller_ = guarded([&] { return make(announced.data(), announced.size()); });
    if (controller_.update == nullptr) {
      destroy();
      refuse(library_.name() + " makes no controller for this sensor; allowed: a sensor with channels that it can work with");
    }
  }

  Plugin(const Plugin&) = delete;  // owns what the library made
  Plugin& operator=(const Plugin&) = delete;
  ~Plugin() override { destroy(); }

  GripCommand update(const ControlInput& input) override {
    const slipbench_control_input handed{
        .slip_time = input.slip.time,
        .slip_latency = input.slip.latency,
        .slip_state = static_cast<int>(input.slip.state),
        .stuck_fraction = input.slip.stuck_fraction,
        .frame_time = input.frame.time,
        .values = input.frame.values.data(),
        .value_count = input.frame.values.size(),
        .status_time = input.gripper.time,
        .position = input.gripper.position,
        .moving = input.gripper.moving ? 1 : 0,
        .stopped = input.gripper.stopped ? 1 : 0,
        .preset = preset_,
    };
    const slipbench_grip_command command = guarded([&] { return controller_.update(controller_.self, &handed); });
    return {.position = command.position, .speed = command.speed, .force = command.force};
  }

 private:
  // What a library throws against the rule is its fault, not the program's.
  template <class Call>
  auto guarded(Call&& call) const -> decltype(call()) {
    try {
      return call();
    } catch (const std::exception& error) {
      throw InputError("controller plugin: " + library_.name() + " threw '" + error.what() + "'; allowed: no exceptions");
    } catch (...) {
      throw InputError("controller plugin: " + library_.name() + " threw an exception; allowed: none");
    }
  }

  void destroy() {
    if (controller_.destroy != nullptr) controller_.destroy(controller_.self);
  }

  Library library_;  // outlives the controller it made
  double preset_;    // N
  slipbench_controller controller_{};
};

}  // namespace

ControllerKind plugin() {
  return {
      {"plugin",
       "Your own controller, from a shared library.",
       "The library computes the command. It exports slipbench_controller_abi and slipbench_make_controller (controllers/plugin_abi.h; example: controllers/example).",
       "the library's author",
       {path_spec("library", no_library, "The shared library.", "free")}},
      [](const Parameters& p, const GripSource& source) -> std::unique_ptr<Controller> {
        if (p.path("library") == no_library) refuse("no library is named; allowed: the path of a shared library");
        return std::make_unique<Plugin>(p.path("library"), source);
      }};
}

}  // namespace slipbench::controllers
