// What a MuJoCo model says of one pad: the attributes of a `slipbench.field` plugin instance, read and checked.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/core/sensor.h"
#include "sim/field/field.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The attributes in the order in which MuJoCo hands them over. All but `pad`, `touch` and one of `sensor` and
// `elements` have defaults.
//   pad       site whose frame is the pad frame P: +Z from the touched object into the pad, origin at the undeformed tips
//   touch     what is touched, with blanks between: names of geoms, body:NAME, which are the geoms of a body that can collide (all, where none
//             can), subtree:NAME, the same of a body and all below it, group:N, the geoms of a group but those that move with the pad. A pad may
//             touch several geoms at once or in turn
//   sensor    {type: papillarray, ...} as under `sensors` in a scene, electronics included
//   elements  [[x, y, z, k_n, k_t], ...]: tip [m] in P and stiffness [N/m] of each element, and its axis in three more columns
//             [ax, ay, az] where it is not -Z
//   units     [6, 6, ...]: how many elements each unit of `elements` has; default: one
//   element_truth  true: the contact of the pad also tells of each element (PadLayout::element_truth), for who reads it in C++; read: so do
//             two more channels of `elements`, depth [E] m and shear [3, E] m
//   material, friction, effects, seed  as in a scene
//   trial     keys the random draws together with the seed; default 0
//   damping   time tau of a dashpot tau*k beside each spring; default 1 ms (assumed)
//   truth     true: the sensor's values are followed by the truth (pad_instance.h)
//   solver    explicit or implicit
//   unloaded  what margin of units that do not touch and stuck_fraction without contact are: 1 (default) or nan
//   check     what a mistake is (pad_misuse.h): error (default), warn, which prints it once, or off, as in models that the
//             program builds: it has checks of its own, and MuJoCo's compiler takes a step before bodies are where the scene has them
//   name      the instance's name before MjSpec.attach gave it a prefix or a suffix: pad and touch are then looked for with the same ones first.
//             Without it, a name that is not there is looked for with each beginning of the instance's name before it
inline constexpr const char* pad_attributes[] = {"pad",     "touch",    "sensor", "element_truth", "material", "friction",
                                                 "effects", "seed",     "trial",  "damping",       "truth",    "solver",
                                                 "units",   "elements", "name",   "check",         "unloaded"};

struct PadConfig {
  std::string name;  // of the instance
  int site = -1;
  std::vector<int> geoms;
  std::vector<PadLayout> table;  // one layout, where `elements` gives it
  bool reads_elements = false;   // its depth and shear are channels
  SensorScene sensor;            // else
  Friction friction;
  std::vector<Named> effects;
  std::uint64_t seed = 0, trial = 0;
  double damping = 0.0;  // s
  bool truth = false;
  bool implicit = false;
  double unloaded = 1.0;
  bool warn = false;       // of mistakes
  bool unchecked = false;  // nor that

  // Throws InputError, or where the model says so prints by mju_warning: "plugin 'left': " and `mistake`.
  void report(const std::string& mistake) const;

  [[nodiscard]] std::unique_ptr<Sensor> make_sensor(const PadCatalogue& catalogue) const;
};

// Throws InputError: "plugin 'left' effects=...: unknown effect 'agein'; did you mean 'ageing'? allowed: ...".
PadConfig read_pad_config(const mjModel* model, int instance, const PadCatalogue& catalogue);

}  // namespace slipbench
