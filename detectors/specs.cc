#include "detectors/specs.h"

namespace slipbench {

ParameterSpec touch_spec() {
  return number_spec("touch", Quantity::force, "0.05 N", positive, "Normal force from which on a unit counts as touching.",
                     "the force resolution of the PapillArray: less is noise, whose ratio means nothing");
}

ParameterSpec least_friction_spec() {
  return number_spec(
      "least_friction", Quantity::none, "0.2", non_negative,
      "Ratio f_t/f_n below which a unit sticks, whatever else it does: the fingers' own bending shears a pad that closes, far from any friction.",
      "assumed: below the friction of every material of the catalogue but the soaped one");
}

}  // namespace slipbench
