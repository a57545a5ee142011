#include "sim/mujoco/pads/field_plugin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "sim/mujoco/releases/mujoco_library.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace slipbench {
namespace {

PadCatalogue& catalogue() {
  static PadCatalogue shared;
  return shared;
}

void (*carry_error)(std::exception_ptr) = nullptr;

// Runs `action` and reports its exceptions by mju_error, which does not return and may jump over
// the caller: at that point nothing needs a destructor. A simulation of this program gets the
// exception itself; for other callers the text names its origin.
template <class Action>
void report_errors(const MujocoLibrary& mujoco, Action&& action) {
  thread_local std::array<char, 1024> message;
  message[0] = '\0';
  try {
    action();
  } catch (const std::exception& error) {
    std::snprintf(message.data(), message.size(), "slipbench: %s", error.what());
    if (carry_error != nullptr) carry_error(std::current_exception());
  }
  if (message[0] != '\0') mujoco.mju_error("%s", message.data());
}

// An instance in one mjData: the pad, and for the last pad of an mjData the group of all of them.
struct Slot {
  PadInstance pad;
  std::unique_ptr<PadGroup> group;
};

// The slots of every mjData, by its address. MuJoCo's plugin_data would hold a pointer, too, but
// Python's pickle writes that as a number: a loaded MjData then has the pointer of another MjData,
// or of another process.
class Slots {
 public:
  void add(const mjData_* data, int instance, std::unique_ptr<Slot> slot) {
    const std::lock_guard lock(mutex_);
    slots_[{data, instance}] = std::move(slot);
    changes_.fetch_add(1, std::memory_order_release);
  }

  void remove(const mjData_* data, int instance) {
    std::unique_ptr<Slot> removed;  // deleted after the lock is released
    const std::lock_guard lock(mutex_);
    const auto found = slots_.find({data, instance});
    if (found == slots_.end()) return;
    removed = std::move(found->second);
    slots_.erase(found);
    changes_.fetch_add(1, std::memory_order_release);
  }

  // Throws InputError for data without a slot. Takes no lock if the thread has found the slot before
  // and no slot has been added or removed since.
  Slot& at(const mjData_* data, int instance) {
    struct Seen {
      const mjData_* data = nullptr;
      int instance = 0;
      std::uint64_t changes = 0;
      Slot* slot = nullptr;
    };
    constexpr std::size_t kept = 64, alignment = 64;
    thread_local std::array<Seen, kept> seen;
    Seen& last = seen[(reinterpret_cast<std::uintptr_t>(data) / alignment + static_cast<std::size_t>(instance)) % kept];
    const std::uint64_t changes = changes_.load(std::memory_order_acquire);
    if (last.data != data || last.instance != instance || last.changes != changes) {
      const std::lock_guard lock(mutex_);
      const auto found = slots_.find({data, instance});
      if (found == slots_.end()) throw InputError("this mjData has no pads; make it by mj_makeData or mj_copyData");
      last = {data, instance, changes, found->second.get()};
    }
    return *last.slot;
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<const mjData_*, int>, std::unique_ptr<Slot>> slots_;
  std::atomic<std::uint64_t> changes_{0};
};

Slots& slots() {
  // Never destroyed: an mjData may outlive the static objects of this library.
  static Slots& shared = *new Slots;
  return shared;
}

// The callbacks of MuJoCo number N in this process; a process may contain several MuJoCos, of
// different releases.
template <int N>
struct Callbacks {
  inline static const MujocoLibrary* mujoco = nullptr;

  static int state_size(const mjModel_* model, int instance);
  static int sensor_size(const mjModel_* model, int instance, int sensor);
  static int make(const mjModel_* model, mjData_* data, int instance);
  static void destroy(mjData_* data, int instance);
  static void copy(mjData_* to, const mjModel_* model, const mjData_* from, int instance);
  static void reset(const mjModel_* model, double* state, void* plugin_data, int instance);
  static void compute(const mjModel_* model, mjData_* data, int instance, int capability);
  static void advance(const mjModel_* model, mjData_* data, int instance);
  static void visualize(const mjModel_* model, mjData_* data, const mjvOption_* option, mjvScene_* scene, int instance);
  static void register_as(const char* name);
};

constexpr int most_mujocos = 4;

// Calls action.operator()<N>() for every number.
template <class Action>
void for_each_number(const Action& action) {
  [&]<int... n>(std::integer_sequence<int, n...>) { (action.template operator()<n>(), ...); }
  (std::make_integer_sequence<int, most_mujocos>());
}

bool is_pad(ModelView model, int instance) {
  const auto* plugin = reinterpret_cast<const SlipbenchPlugin*>(model.mujoco().mjp_getPluginAtSlot(model.plugin()[instance]));
  bool ours = false;  // and not of another copy of this code
  for_each_number([&]<int n>() { ours = ours || (plugin != nullptr && plugin->init == &Callbacks<n>::make); });
  return ours;
}

int last_pad(ModelView model) {
  int last = -1;
  for (int i = 0; i < model.nplugin(); ++i) last = is_pad(model, i) ? i : last;
  return last;
}

void make_slot(ModelView model, const mjData_* data, int instance) {
  auto slot = std::make_unique<Slot>(
      Slot{PadInstance(model, instance, read_pad_config(model, instance, catalogue()), catalogue()), nullptr});
  if (instance == last_pad(model)) {
    std::vector<PadInstance*> pads;
    for (int i = 0; i < instance; ++i) {
      if (is_pad(model, i)) pads.push_back(&slots().at(data, i).pad);
    }
    pads.push_back(&slot->pad);
    slot->group = std::make_unique<PadGroup>(model, pads);
  }
  slots().add(data, instance, std::move(slot));
}

template <int N>
int Callbacks<N>::state_size(const mjModel_* m, int instance) {
  int size = 0;
  report_errors(*mujoco, [&] {
    const ModelView model(m, *mujoco);
    size = static_cast<int>(pad_state_size(model, read_pad_config(model, instance, catalogue()), catalogue()));
  });
  return size;
}

template <int N>
int Callbacks<N>::sensor_size(const mjModel_* model, int instance, int /*sensor*/) {
  int size = 0;
  report_errors(*mujoco, [&] {
    size = static_cast<int>(pad_sensor_size(read_pad_config({model, *mujoco}, instance, catalogue()), catalogue()));
  });
  return size;
}

template <int N>
int Callbacks<N>::make(const mjModel_* model, mjData_* data, int instance) {
  report_errors(*mujoco, [&] { make_slot({model, *mujoco}, data, instance); });
  return 0;
}

template <int N>
void Callbacks<N>::destroy(mjData_* data, int instance) {
  slots().remove(data, instance);
}

template <int N>
void Callbacks<N>::copy(mjData_* to, const mjModel_* /*model*/, const mjData_* from, int instance) {
  report_errors(*mujoco, [&] {
    Slot& target = slots().at(to, instance);
    const Slot& source = slots().at(from, instance);
    target.pad.copy_from(source.pad);
    if (source.group) target.group->copy_from(*source.group);
  });
}

template <int N>
void Callbacks<N>::reset(const mjModel_* model, double* state, void* /*plugin_data*/, int instance) {
  std::fill_n(state, ModelView(model, *mujoco).plugin_statenum()[instance], 0.0);
}

template <int N>
void Callbacks<N>::compute(const mjModel_* m, mjData_* d, int instance, int capability) {
  report_errors(*mujoco, [&] {
    const ModelView model(m, *mujoco);
    const DataView data(d, *mujoco);
    Slot& slot = slots().at(d, instance);
    if (capability != mj::passive_plugin) {
      slot.pad.write_sensors(model, data);
      return;
    }
    if (!slot.pad.config().implicit) slot.pad.add_force(model, data);
    if (slot.group) slot.group->add_force(model, data);
  });
}

template <int N>
void Callbacks<N>::advance(const mjModel_* m, mjData_* d, int instance) {
  report_errors(*mujoco, [&] {
    const ModelView model(m, *mujoco);
    const DataView data(d, *mujoco);
    Slot& slot = slots().at(d, instance);
    slot.pad.commit(model, data);
    if (slot.group) slot.group->finish(model, data);
  });
}

template <int N>
void Callbacks<N>::visualize(const mjModel_* model, mjData_* data, const mjvOption_* /*option*/, mjvScene_* scene, int instance) {
  report_errors(*mujoco, [&] {
    slots().at(data, instance).pad.draw({model, *mujoco}, {data, *mujoco}, reinterpret_cast<SlipbenchScene*>(scene));
  });
}

template <int N>
void Callbacks<N>::register_as(const char* name) {
  SlipbenchPlugin plugin{};
  plugin.name = name;
  plugin.capabilityflags = mj::passive_plugin | mj::sensor_plugin;
  plugin.needstage = mj::velocity_stage;
  plugin.nattribute = static_cast<int>(std::size(pad_attributes));
  plugin.attributes = pad_attributes;
  plugin.nstate = &state_size;
  plugin.nsensordata = &sensor_size;
  plugin.init = &make;
  plugin.destroy = &destroy;
  plugin.copy = &copy;
  plugin.reset = &reset;
  plugin.compute = &compute;
  plugin.advance = &advance;
  plugin.visualize = &visualize;
  mujoco->mjp_registerPlugin(reinterpret_cast<const mjpPlugin_*>(&plugin));
}

}  // namespace

bool register_plugin(const MujocoLibrary& mujoco, const char* name, PadCatalogue pads, void (*carry)(std::exception_ptr)) {
  catalogue() = std::move(pads);
  carry_error = carry;
  bool registered = mujoco.mjp_getPlugin(name, nullptr) != nullptr;
  for_each_number([&]<int n>() {
    if (registered || (Callbacks<n>::mujoco != nullptr && Callbacks<n>::mujoco != &mujoco)) return;
    Callbacks<n>::mujoco = &mujoco;
    Callbacks<n>::register_as(name);
    registered = true;
  });
  return registered;
}

std::string describe_pads(ModelView model) {
  std::string text;
  for (int i = 0; i < static_cast<int>(model.nplugin()); ++i) {
    if (!is_pad(model, i)) continue;
    const PadConfig config = read_pad_config(model, i, catalogue());
    const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue());
    text += fmt::format("{}\t{}\t{}\t{}\t{:d}\n", i, model.names() + model.name_pluginadr()[i], config.site,
                        sensor->layout().units.size(), config.truth);
    for (const Channel& channel : sensor->channels()) {
      text += fmt::format("\t{}\t{}\t{}\n", channel.name, channel.unit, fmt::join(channel.shape, " "));
    }
  }
  return text;
}

double longest_step(ModelView model, DataView data) {
  const PadGroup* group = pad_group_of(model, data);
  return group == nullptr ? std::numeric_limits<double>::infinity() : group->longest_step(model, data);
}

PadInstance* pad_of(ModelView model, DataView data, int instance) {
  return is_pad(model, instance) ? &slots().at(data.get(), instance).pad : nullptr;
}

PadGroup* pad_group_of(ModelView model, DataView data) {
  const int last = last_pad(model);
  return last < 0 ? nullptr : slots().at(data.get(), last).group.get();
}

}  // namespace slipbench
