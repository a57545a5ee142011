#include "tools/formats/import/channel_unit.h"

#include <map>
#include <stdexcept>

#include "sim/core/quantity.h"

namespace slipbench {

SiUnit si_unit_of(const std::string& unit) {
  constexpr double standard_gravity = 9.80665;  // m/s2, by definition
  static const std::map<std::string, double> further_forces{
      {"uN", 1e-6}, {"gf", 1e-3 * standard_gravity}, {"kgf", standard_gravity}};
  if (const auto force = further_forces.find(unit); force != further_forces.end()) return {"N", force->second};
  try {
    const std::string one = "1 " + unit;
    const Quantity quantity = quantity_of(one);
    if (quantity != Quantity::none && quantity != Quantity::mass) {
      return {std::string(si_symbol(quantity)), parse_quantity(one, quantity)};
    }
  } catch (const std::invalid_argument&) {  // not a unit of scenes
  }
  return {unit, 1.0};
}

}  // namespace slipbench
