// Checks the labels of a dataset against Coulomb's law.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/verify/verification.h"

namespace slipbench::verify {

// Properties of the labels of one sensor on which parts of Coulomb's law depend.
struct ConeLaw {
  bool exact = true;                       // friction is computed exactly, not by MuJoCo's solver
  bool one_plane = true;                   // all elements of a unit touch faces of the same direction
  bool limit = true;                       // mu_static f_n limits the friction of a sticking unit
  bool slip_limit = true;                  // the same limit holds for slipping and partly slipping units
  bool slip_most = true;                   // the friction of a slipping unit is at most mu_kinetic f_n
  bool slip_least = true;                  // it is at least mu_kinetic f_n
  bool stuck_force = true;                 // f_t of a sticking unit is its friction
  bool moving_force = true;                // likewise of a slipping or partly slipping unit; detached: f_t = 0
  std::vector<std::string> left_out = {};  // parts of the law that cannot be checked, and why
};

// The law for sensor `index` of a trial's scene, by what the entries of its effects declare
// (sim/effects/effect_catalogue.h).
ConeLaw cone_law(const Scene& scene, std::size_t index);

// Checks the parts of `law` in every sample of every unit. The tolerance is the rounding of the
// labels to float32, and the friction over the shortest slip that the field distinguishes from
// rest.
void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
