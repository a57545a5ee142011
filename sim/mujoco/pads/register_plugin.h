// Makes the engine plugin `slipbench.field` known to MuJoCo.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <string>

#include "sim/api/sensor.h"
#include "sim/mujoco/releases/mujoco_library.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// sim/ depends on no sensor: the code that composes a program, or the plugin's library, passes them
// in.
struct PadCatalogue {
  Catalogues catalogues;
  // Throws InputError if the sensor is not possible as given by the scene.
  std::unique_ptr<Sensor> (*make_sensor)(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) = nullptr;
};

inline constexpr const char* field_plugin_name = "slipbench.field";
// The same plugin in models that the program builds. A process may contain the program and the
// plugin's library, two copies of the same code, and MuJoCo accepts a name only once.
inline constexpr const char* bench_plugin_name = "slipbench.bench";

// Registers the plugin under `name` in a MuJoCo that stays loaded, before a model that uses it is
// read. Does not replace a plugin of this name that another copy has registered. `carry`: called
// with each exception before it is reported by mju_error, or null. Returns false if the process
// already contains as many MuJoCos with pads as are supported, four.
bool register_plugin(const MujocoLibrary& mujoco, const char* name, PadCatalogue catalogue, void (*carry)(std::exception_ptr));

// The same in the MuJoCo that the program links: `slipbench.field`. Call once. If the loaded MuJoCo
// is not the version for which the program was compiled, warns by mju_warning and does nothing:
// MuJoCo's structures differ between versions.
void register_field_plugin(PadCatalogue catalogue);

// The same, and `slipbench.bench`. For programs that simulate scenes.
void register_bench_plugin(PadCatalogue catalogue);

// Further functions of the plugin's library about a model's pads: Python's slipbench.mujoco calls
// them.

// Returns one line for each pad, values separated by tabs: its instance's number, name, site's
// number, number of units, 1 with truth; then one for each channel of the sensor: "", name, unit
// and shape, as in "9 3". Throws InputError if the model's attributes are invalid.
[[nodiscard]] std::string describe_pads(ModelView model);

// Returns the longest step [s] for the explicit pads of the model, with all elements of every pad
// touching at once: each pad on the body on which it vibrates fastest, at the positions of `data`,
// which must be made from this model. Infinite without explicit pads.
[[nodiscard]] double longest_step(ModelView model, DataView data);

}  // namespace slipbench
