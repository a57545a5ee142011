// Makes the engine plugin `slipbench.field` known to MuJoCo.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/core/sensor.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

// sim/ knows no sensor: whoever composes a program or the plugin's library hands them in.
struct PadCatalogue {
  Catalogues catalogues;
  // Throws InputError when the sensor cannot be as the scene says.
  std::unique_ptr<Sensor> (*make_sensor)(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) = nullptr;
};

inline constexpr const char* field_plugin_name = "slipbench.field";
// The same plugin in models that the program builds. A process may hold the program and the plugin's library, two copies of the same code, and
// MuJoCo takes a name once.
inline constexpr const char* bench_plugin_name = "slipbench.bench";

// Call once, before a model that uses the plugin is read. Leaves a `slipbench.field` alone that another copy has registered. Says so by
// mju_warning and does nothing when the MuJoCo that is loaded is not the version this was compiled for: MuJoCo's structures are not the same in
// any two.
void register_field_plugin(PadCatalogue catalogue);

// The same, and `slipbench.bench`. For programs that simulate scenes.
void register_bench_plugin(PadCatalogue catalogue);

// What the plugin's library tells others of a model's pads beside what MuJoCo asks for: Python's slipbench.mujoco calls it.

// One line for each pad, values separated by tabs: its instance's number, name, site's number, number of units, 1 with truth; then one for each
// channel of the sensor: "", name, unit and shape, as in "9 3". Throws InputError where the model's attributes are wrong.
[[nodiscard]] std::string describe_pads(const mjModel_* model);

// The longest step [s] that the explicit pads of the model bear, with all elements of every pad touching at once: each pad on that of its bodies on
// which it vibrates fastest, in the positions of `data`. Infinite without explicit pads. `data` is one of this model.
[[nodiscard]] double longest_step(const mjModel_* model, mjData_* data);

}  // namespace slipbench
