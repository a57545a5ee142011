#include "sim/effects/effect_catalogue.h"

namespace slipbench {

EffectKind lean() {
  return {
      {"lean",
       "Elements are slender columns (nibs, pillars) that lean under shear: load softens them; beyond the buckling load they tip over.",
       "f_n = k_n (d - q^2/(2 length)), f_t = k_t q - f_n q/length + stop_stiffness max(0, q - stop)\n"
       "q: stretch of the element, d: its penetration. The buckling load is k_t length. A load beyond (k_t + stop_stiffness) length is an error. Not together with anisotropic_friction.",
       "a rigid column on a hinge, to second order in q/length (P-delta): Timoshenko and Gere, Theory of Elastic Stability (1961), sec. 2.1",
       {number_spec("length", Quantity::length, "3.65 mm", positive, "Distance from the hinge to the tip.",
                    "reconfigurable nib sensor: nib 2.1 mm and round tip 1.4 mm over the fabric, 0.15 mm of fabric assumed"),
        number_spec(
            "stop", Quantity::length, "0.55 mm", non_negative, "Stretch at which the column touches its stop.",
            "geometry: length x (gap of 0.254 mm minus its reduction by load) / 1.4 mm, the distance from the hinge to the edge that touches down"),
        number_spec("stop_stiffness", Quantity::stiffness, "1 N/mm", non_negative, "Stiffness that the stop adds.",
                    "assumed: five times the column's own")}},
      {Change::normal_force},
      [](const Parameters& p, const EffectContext&, FieldEffects& effects) {
        effects.lean = Lean{p.number("length"), p.number("stop"), p.number("stop_stiffness")};
      }};
}

}  // namespace slipbench
