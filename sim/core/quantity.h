// Physical quantities: the dimensions a scene value can have, and text such as "4 mm/s" turned into
// SI numbers.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace slipbench {

// The dimension of a number. A bare number in a scene is in the SI unit of its quantity.
enum class Quantity {
  none,                  // dimensionless
  length,                // m
  time,                  // s
  speed,                 // m/s
  acceleration,          // m/s^2
  angle,                 // rad
  angular_speed,         // rad/s
  angular_acceleration,  // rad/s^2
  frequency,             // Hz
  force,                 // N
  mass,                  // kg
  stiffness,             // N/m
  damping,               // N s/m
  pressure,              // Pa
};

// A unit that text may carry, and the factor that turns a value in it into SI.
struct Unit {
  std::string_view symbol;
  double factor;
};

// The SI symbol of a quantity ("m/s"); empty for Quantity::none.
std::string_view si_symbol(Quantity quantity);

// Returns all units accepted for a quantity, the SI unit first (for Quantity::none: the empty
// symbol). Text may also write "s^2" for "s2", "µm" for "um" and "Ns/m" for "N s/m".
std::span<const Unit> units_of(Quantity quantity);

// Parses "4 mm/s", "4mm/s", "0.004" or "inf" as a value of `quantity` and returns it in SI. A
// decimal unit is exact: "9 mm" and "0.009" are the same double. NaN is refused. Throws
// std::invalid_argument with a text that says what was found and which units are allowed.
double parse_quantity(std::string_view text, Quantity quantity);

// Returns the quantity to which the unit of `text` belongs; Quantity::none for a bare number.
// Throws std::invalid_argument if `text` is not a number or its unit is unknown.
Quantity quantity_of(std::string_view text);

// The shortest decimal text that reads back as the same double: "0.004", "1e-09", "inf".
std::string format_number(double value);

// Writes an SI value in the most readable accepted unit, such as "4 mm/s". The text reads back as
// the same double.
std::string format_quantity(double value, Quantity quantity);

}  // namespace slipbench
