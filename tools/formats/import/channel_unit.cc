#include "tools/formats/import/channel_unit.h"

#include <map>
#include <stdexcept>

#include "sim/core/quantity.h"

namespace slipbench {

SiUnit si_unit_of(const std::string& unit) {
  constexpr double standard_gravity = 9.80665;  // m/s2, by definition
  // Units that scenes do not have. U+00B5 and U+03BC are both written for micro.
  static const std::map<std::string, SiUnit> further{{"uN", {"N", 1e-6}},
                                                     {"\u00b5N", {"N", 1e-6}},
                                                     {"\u03bcN", {"N", 1e-6}},
                                                     {"gf", {"N", 1e-3 * standard_gravity}},
                                                     {"kgf", {"N", standard_gravity}},
                                                     {"mV", {"V", 1e-3}},
                                                     {"uV", {"V", 1e-6}},
                                                     {"\u00b5V", {"V", 1e-6}},
                                                     {"\u03bcV", {"V", 1e-6}},
                                                     {"count", {"counts", 1.0}},
                                                     {"T", {"uT", 1e6}},
                                                     {"mT", {"uT", 1e3}},
                                                     {"\u00b5T", {"uT", 1.0}},
                                                     {"\u03bcT", {"uT", 1.0}},
                                                     {"nT", {"uT", 1e-3}}};
  if (const auto known = further.find(unit); known != further.end()) return known->second;
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
