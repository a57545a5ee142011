#include "sim/mujoco/pads/field_plugin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/mujoco_differences.h"
#include "sim/mujoco/pads/register_plugin.h"

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

// Runs `action` and reports its exceptions by mju_error, which does not return and may jump over
// the caller: at that point nothing needs a destructor. A simulation of this program gets the
// exception itself; for other callers the text names its origin.
template <class Action>
void report_errors(Action&& action) {
  thread_local std::array<char, 1024> message;
  message[0] = '\0';
  try {
    action();
  } catch (const std::exception& error) {
    std::snprintf(message.data(), message.size(), "slipbench: %s", error.what());
    carry_to_caller(std::current_exception());
  }
  if (message[0] != '\0') mju_error("%s", message.data());
}

// An instance in one mjData: the pad, and for the last pad of an mjData the group of all of them.
struct Slot {
  PadInstance pad;
  std::unique_ptr<PadGroup> group;
};

int make(const mjModel* model, mjData* data, int instance);

// The slots of every mjData, by its address. MuJoCo's plugin_data would hold a pointer, too, but
// Python's pickle writes that as a number: a loaded MjData then has the pointer of another MjData,
// or of another process.
class Slots {
 public:
  void add(const mjData* data, int instance, std::unique_ptr<Slot> slot) {
    const std::lock_guard lock(mutex_);
    slots_[{data, instance}] = std::move(slot);
    changes_.fetch_add(1, std::memory_order_release);
  }

  void remove(const mjData* data, int instance) {
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
  Slot& at(const mjData* data, int instance) {
    struct Seen {
      const mjData* data = nullptr;
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
  std::map<std::pair<const mjData*, int>, std::unique_ptr<Slot>> slots_;
  std::atomic<std::uint64_t> changes_{0};
};

Slots& slots() {
  // Never destroyed: an mjData may outlive the static objects of this library.
  static Slots& shared = *new Slots;
  return shared;
}

bool is_pad(const mjModel* model, int instance) {
  const mjpPlugin* plugin = mjp_getPluginAtSlot(model->plugin[instance]);
  return plugin != nullptr && plugin->init == &make;  // and not of another copy of this code
}

int last_pad(const mjModel* model) {
  int last = -1;
  for (int i = 0; i < static_cast<int>(model->nplugin); ++i) last = is_pad(model, i) ? i : last;
  return last;
}

int state_size(const mjModel* model, int instance) {
  int size = 0;
  report_errors(
      [&] { size = static_cast<int>(pad_state_size(model, read_pad_config(model, instance, catalogue()), catalogue())); });
  return size;
}

int sensor_size(const mjModel* model, int instance, int /*sensor*/) {
  int size = 0;
  report_errors([&] { size = static_cast<int>(pad_sensor_size(read_pad_config(model, instance, catalogue()), catalogue())); });
  return size;
}

int make(const mjModel* model, mjData* data, int instance) {
  report_errors([&] {
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
  });
  return 0;
}

void destroy(mjData* data, int instance) { slots().remove(data, instance); }

void copy(mjData* to, const mjModel* /*model*/, const mjData* from, int instance) {
  report_errors([&] {
    Slot& target = slots().at(to, instance);
    const Slot& source = slots().at(from, instance);
    target.pad.copy_from(source.pad);
    if (source.group) target.group->copy_from(*source.group);
  });
}

void reset(const mjModel* model, mjtNum* state, void* /*plugin_data*/, int instance) {
  mju_zero(state, model->plugin_statenum[instance]);
}

void compute(const mjModel* model, mjData* data, int instance, int capability) {
  report_errors([&] {
    Slot& slot = slots().at(data, instance);
    if (capability != mjPLUGIN_PASSIVE) {
      slot.pad.write_sensors(model, data);
      return;
    }
    if (!slot.pad.config().implicit) slot.pad.add_force(model, data);
    if (slot.group) slot.group->add_force(model, data);
  });
}

void advance(const mjModel* model, mjData* data, int instance) {
  report_errors([&] {
    Slot& slot = slots().at(data, instance);
    slot.pad.commit(model, data);
    if (slot.group) slot.group->finish(model, data);
  });
}

void visualize(const mjModel* model, mjData* data, const mjvOption* /*option*/, mjvScene* scene, int instance) {
  report_errors([&] { slots().at(data, instance).pad.draw(model, data, scene); });
}

void register_as(const char* name) {
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = name;
  plugin.capabilityflags = mjPLUGIN_PASSIVE | mjPLUGIN_SENSOR;
  plugin.needstage = mjSTAGE_VEL;
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
  mjp_registerPlugin(&plugin);
}

}  // namespace

void register_field_plugin(PadCatalogue pads) {
  if (!meet_mujoco()) return;
  catalogue() = std::move(pads);
  if (mjp_getPlugin(field_plugin_name, nullptr) == nullptr) register_as(field_plugin_name);
}

void register_bench_plugin(PadCatalogue pads) {
  register_field_plugin(std::move(pads));
  if (mj_version() == mjVERSION_HEADER) register_as(bench_plugin_name);
}

std::string describe_pads(const mjModel* model) {
  std::string text;
  for (int i = 0; i < static_cast<int>(model->nplugin); ++i) {
    if (!is_pad(model, i)) continue;
    const PadConfig config = read_pad_config(model, i, catalogue());
    const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue());
    text += fmt::format("{}\t{}\t{}\t{}\t{:d}\n", i, model->names + model->name_pluginadr[i], config.site,
                        sensor->layout().units.size(), config.truth);
    for (const Channel& channel : sensor->channels()) {
      text += fmt::format("\t{}\t{}\t{}\n", channel.name, channel.unit, fmt::join(channel.shape, " "));
    }
  }
  return text;
}

double longest_step(const mjModel* model, mjData* data) {
  const PadGroup* group = pad_group_of(model, data);
  return group == nullptr ? std::numeric_limits<double>::infinity() : group->longest_step(model, data);
}

PadInstance* pad_of(const mjModel* model, const mjData* data, int instance) {
  return is_pad(model, instance) ? &slots().at(data, instance).pad : nullptr;
}

PadGroup* pad_group_of(const mjModel* model, const mjData* data) {
  const int last = last_pad(model);
  return last < 0 ? nullptr : slots().at(data, last).group.get();
}

}  // namespace slipbench
