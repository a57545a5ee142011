// Coulomb's law in the labels, as far as README.md says that it holds for a unit.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/verify/verification.h"

namespace slipbench::verify {

// Which parts of the law the labels of one sensor keep.
struct ConeLaw {
  bool margin = true;                      // stick and partial: margin >= 0
  bool stick = true;                       // stick and partial: f_t <= mu_static f_n
  bool margin_value = true;                // touching: margin = 1 - f_t/(mu_static f_n)
  bool slip_most = true;                   // slip: f_t <= mu_kinetic f_n
  bool slip_least = true;                  // slip: f_t >= mu_kinetic f_n
  std::vector<std::string> left_out = {};  // which parts do not hold, and why
};

// Of the sensor `index` of a trial's scene.
ConeLaw cone_law(const Scene& scene, std::size_t index);

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
