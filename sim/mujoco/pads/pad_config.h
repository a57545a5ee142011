// The settings of one pad in a MuJoCo model: the attributes of a `slipbench.field` plugin instance,
// read and checked.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/api/pad_layout.h"
#include "sim/api/sensor.h"
#include "sim/contact/field.h"
#include "sim/core/parameters.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "sim/mujoco/releases/mujoco_library.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The attributes in the order in which MuJoCo passes them. All except `pad`, `touch` and one of
// `sensor` and `elements` have defaults.
//   pad       site whose frame is the pad frame P: +Z from the touched object into the pad, origin
//             at the undeformed tips
//   touch     touched geoms, separated by blanks: names of geoms; body:NAME, the geoms of a body
//             that can collide (all, if none can); subtree:NAME, the same for a body and all bodies
//             below it; group:N, the geoms of a group except those that move with the pad. A pad
//             may touch several geoms at once or in turn
//   sensor    {type: papillarray, ...} as under `sensors` in a scene, electronics included
//   elements  [[x, y, z, k_n, k_t], ...]: tip [m] in P and stiffness [N/m] of each element, and its
//             axis in three more columns [ax, ay, az] if it is not -Z. In models that the program
//             builds: a name by LayoutsInMemory, which includes units and element_truth
//   units     [6, 6, ...]: number of elements of each unit of `elements`; default: one
//   element_truth  true: the pad's contact also has each element's values
//             (PadLayout::element_truth), for readers in C++; read: also two more channels of
//             `elements`, depth [E] m and shear [3, E] m
//   material, friction, effects, seed  as in a scene
//   trial     keys the random draws together with the seed; default 0
//   damping   time tau of a dashpot tau*k parallel to each spring; default 1 ms (assumed)
//   truth     true: the sensor's values are followed by the truth (pad_readout.h)
//   solver    explicit or implicit
//   unloaded  margin of separated units, and stuck_fraction without contact: 1 (default) or nan
//   check     treatment of a mistake (possible_contact): error (default), warn, which prints it
//             once, or off, as in models that the program builds: it has its own checks, and
//             MuJoCo's compiler takes a step before bodies are where the scene has them
//   name      the instance's name before MjSpec.attach added a prefix or a suffix: pad and touch
//             are then looked up with the same ones first. Without it, a missing name is looked up
//             with each beginning of the instance's name as prefix
inline constexpr const char* pad_attributes[] = {"pad",     "touch",    "sensor", "element_truth", "material", "friction",
                                                 "effects", "seed",     "trial",  "damping",       "truth",    "solver",
                                                 "units",   "elements", "name",   "check",         "unloaded"};

struct PadConfig {
  const MujocoLibrary* mujoco = nullptr;  // of the model
  std::string name;                       // of the instance
  int site = -1;
  std::vector<int> geoms;
  std::vector<PadLayout> table;  // one layout, if given by `elements`
  bool reads_elements = false;   // its depth and shear are channels
  SensorScene sensor;            // otherwise
  Friction friction;
  std::vector<Named> effects;
  std::uint64_t seed = 0, trial = 0;
  double damping = 0.0;  // s
  bool truth = false;
  bool implicit = false;
  double unloaded = 1.0;
  bool warn = false;       // of mistakes
  bool unchecked = false;  // no warning either

  // Throws InputError, or prints by mju_warning if the model asks for it: "plugin 'left': " and
  // `mistake`.
  void report(const std::string& mistake) const;

  [[nodiscard]] std::unique_ptr<Sensor> make_sensor(const PadCatalogue& catalogue) const;
};

// Layouts that a program passes to the pads of its own models in memory, since writing and reading
// an element table would take longer than a trial.
class LayoutsInMemory {
 public:
  LayoutsInMemory() = default;
  LayoutsInMemory(const LayoutsInMemory&) = delete;
  LayoutsInMemory& operator=(const LayoutsInMemory&) = delete;
  ~LayoutsInMemory();

  // Returns the value of the attribute `elements` for a pad of this layout, in models that are
  // compiled, and data made, while the object lives.
  std::string add(PadLayout layout);

 private:
  std::vector<std::string> names_;
};

// Throws InputError: "plugin 'left' effects=...: unknown effect 'agein'; did you mean 'ageing'?
// allowed: ...".
PadConfig read_pad_config(ModelView model, int instance, const PadCatalogue& catalogue);

}  // namespace slipbench
