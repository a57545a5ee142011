// The SI unit in which a dataset stores a recorded channel.
#pragma once

#include <string>

namespace slipbench {

struct SiUnit {
  std::string symbol;  // "N"
  double factor;       // from a value in the recorded unit to one in `symbol`
};

// Returns the SI unit of the quantity to which `unit` belongs: "N" and 1e-3 for "mN". Knows the
// units of scenes, and uN, gf and kgf. A `count` is stored in `counts` and a magnetic field in uT,
// as the simulated sensors have them. A unit that it does not know remains with the factor 1. So does
// a unit of mass or a percentage: `g` may mean the mass, the force or the acceleration.
SiUnit si_unit_of(const std::string& unit);

}  // namespace slipbench
