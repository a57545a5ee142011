// A foreign program with the installed libraries: presses one pillar, slides it, and reads when it
// slips. Exit status 0: at mu f_n/(k_t v), as expected.
#include <cmath>

#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/core/quantity.h"

int main() {
  const double speed = slipbench::parse_quantity("4 mm/s", slipbench::Quantity::speed);
  slipbench::PadLayout pad;
  pad.elements.push_back({.k_normal = 7100.0, .k_tangential = 3900.0});
  pad.units.push_back({0, 1});
  slipbench::Field field(pad, slipbench::Plane{}, {0.5, 0.5});
  slipbench::ContactLabels labels(field.layout());
  for (int tick = 0; tick < 1000; ++tick) {
    slipbench::Pose pose;
    pose.position = {speed * 1e-3 * tick, 0.0, -1e-3};
    field.step(pose, 1e-3);
    for (const slipbench::ContactEvent& event : labels.update({&field, 1}, 1e-3 * tick, 1e-3).events) {
      if (event.kind != slipbench::EventKind::slip) continue;
      const double exact = 0.5 * 7100.0 * 1e-3 / (3900.0 * speed);
      return std::abs(event.time - exact) < 1e-9 ? 0 : 1;
    }
  }
  return 1;
}
