#include "sim/core/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

constexpr Unit no_units[] = {{"", 1.0}, {"%", 1e-2}};
constexpr Unit lengths[] = {{"m", 1.0}, {"mm", 1e-3}, {"um", 1e-6}, {"cm", 1e-2}, {"nm", 1e-9}};
constexpr Unit times[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60.0}};
constexpr Unit speeds[] = {{"m/s", 1.0}, {"mm/s", 1e-3}, {"cm/s", 1e-2}, {"um/s", 1e-6}};
constexpr Unit accelerations[] = {{"m/s2", 1.0}, {"mm/s2", 1e-3}, {"cm/s2", 1e-2}};
constexpr Unit angles[] = {{"rad", 1.0}, {"deg", degree}};
constexpr Unit angular_speeds[] = {{"rad/s", 1.0}, {"deg/s", degree}};
constexpr Unit angular_accelerations[] = {{"rad/s2", 1.0}, {"deg/s2", degree}};
constexpr Unit frequencies[] = {{"Hz", 1.0}, {"kHz", 1e3}, {"MHz", 1e6}};
constexpr Unit forces[] = {{"N", 1.0}, {"mN", 1e-3}, {"kN", 1e3}};
constexpr Unit masses[] = {{"kg", 1.0}, {"g", 1e-3}};
constexpr Unit stiffnesses[] = {{"N/m", 1.0}, {"N/mm", 1e3}, {"kN/m", 1e3}};
constexpr Unit dampings[] = {{"N s/m", 1.0}};
constexpr Unit pressures[] = {{"Pa", 1.0}, {"kPa", 1e3}, {"MPa", 1e6}};

struct QuantityInfo {
  std::string_view noun;  // with its article, for messages
  std::span<const Unit> units;
  // the units that format_quantity chooses from, preferred first
  std::vector<std::string_view> written;
};

// In the order of enum Quantity.
const std::array<QuantityInfo, 14>& table() {
  static const std::array<QuantityInfo, 14> infos{{
      {"a number", no_units, {""}},
      {"a length", lengths, {"m", "mm", "um", "nm"}},
      {"a time", times, {"s", "ms", "us"}},
      {"a speed", speeds, {"m/s", "mm/s", "um/s"}},
      {"an acceleration", accelerations, {"m/s2", "mm/s2"}},
      {"an angle", angles, {"deg", "rad"}},
      {"an angular speed", angular_speeds, {"deg/s", "rad/s"}},
      {"an angular acceleration", angular_accelerations, {"deg/s2", "rad/s2"}},
      {"a frequency", frequencies, {"Hz", "kHz", "MHz"}},
      {"a force", forces, {"N", "mN", "kN"}},
      {"a mass", masses, {"kg", "g"}},
      {"a stiffness", stiffnesses, {"N/m", "N/mm"}},
      {"a damping", dampings, {"N s/m"}},
      {"a pressure", pressures, {"Pa", "kPa", "MPa"}},
  }};
  return infos;
}

const QuantityInfo& info(Quantity quantity) { return table().at(static_cast<std::size_t>(quantity)); }

std::vector<std::string_view> unit_names(Quantity quantity) {
  std::vector<std::string_view> names;
  for (const Unit& unit : units_of(quantity)) {
    if (!unit.symbol.empty()) names.push_back(unit.symbol);
  }
  return names;
}

bool is_space(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// Converts the accepted spellings of a unit to those of the tables.
std::string canonical_unit(std::string_view unit) {
  std::string result;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit.substr(i, 2) == "\u00b5" || unit.substr(i, 2) == "\u03bc") {
      result += 'u';
      ++i;
    } else if (unit[i] == '^' && unit.substr(i + 1) == "2") {
      continue;
    } else {
      result += unit[i];
    }
  }
  return result == "Ns/m" ? "N s/m" : result;
}

// Text split into a decimal number and a unit.
struct NumberText {
  bool negative = false;
  bool infinite = false;
  std::string digits;  // mantissa without sign or exponent: "4", "0.5"
  int exponent = 0;
  std::string unit;  // canonical
};

// Returns the length of the decimal number at the front of `text`, or 0.
std::size_t mantissa_length(std::string_view text) {
  std::size_t length = 0;
  bool any_digit = false;
  bool point = false;
  for (; length < text.size(); ++length) {
    if (is_digit(text[length])) {
      any_digit = true;
    } else if (text[length] == '.' && !point) {
      point = true;
    } else {
      break;
    }
  }
  return any_digit ? length : 0;
}

std::optional<NumberText> split(std::string_view text) {
  NumberText number;
  text = trimmed(text);
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    number.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  if (text == "inf" || text == ".inf") {
    number.infinite = true;
    return number;
  }
  const std::size_t length = mantissa_length(text);
  if (length == 0) return std::nullopt;
  number.digits = text.substr(0, length);
  text.remove_prefix(length);
  if (text.size() >= 2 && (text[0] == 'e' || text[0] == 'E')) {
    const std::size_t sign = text[1] == '-' || text[1] == '+' ? 1 : 0;
    const char* first = text.data() + 1 + (text[1] == '+' ? 1 : 0);
    if (text.size() > 1 + sign && is_digit(text[1 + sign])) {
      const auto [end, error] = std::from_chars(first, text.data() + text.size(), number.exponent);
      // Beyond any double. Clamped so that the sum with a unit's shift in shifted() cannot
      // overflow; that function refuses the number.
      constexpr int beyond = 100000;
      if (error != std::errc{} || std::abs(number.exponent) > beyond) number.exponent = text[1] == '-' ? -beyond : beyond;
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
  }
  number.unit = canonical_unit(trimmed(text));
  return number;
}

// Returns the exponent of a factor that is a power of ten.
std::optional<int> decimal_shift(double factor) {
  const int exponent = static_cast<int>(std::lround(math::log10(factor)));
  const std::string text = "1e" + std::to_string(exponent);
  double power = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), power);
  return power == factor ? std::optional(exponent) : std::nullopt;
}

// Returns the number with its decimal point shifted; empty beyond the range of a double.
std::optional<double> shifted(const NumberText& number, int shift) {
  const std::string decimal = number.digits + "e" + std::to_string(number.exponent + shift);
  double value = 0.0;
  const auto [end, error] = std::from_chars(decimal.data(), decimal.data() + decimal.size(), value);
  if (error != std::errc{} || end != decimal.data() + decimal.size()) return std::nullopt;
  return number.negative ? -value : value;
}

[[noreturn]] void not_a_number(std::string_view text, Quantity quantity) {
  const std::string_view si = si_symbol(quantity);
  std::string message = quote(text) + " is not " + std::string(info(quantity).noun) + "; allowed: a number" +
                        (si.empty() ? "" : " in " + std::string(si)) + ", or one with a unit: ";
  const char* separator = "";
  for (const std::string_view name : unit_names(quantity)) {
    message += separator;
    message += name;
    separator = ", ";
  }
  throw std::invalid_argument(message);
}

// Converts the number from `unit` to SI; empty beyond the range of a double.
std::optional<double> value_in(const NumberText& number, const Unit& unit) {
  if (const auto shift = decimal_shift(unit.factor)) return shifted(number, *shift);
  const std::optional<double> value = shifted(number, 0);
  return value && std::isfinite(*value * unit.factor) ? std::optional(*value * unit.factor) : std::nullopt;
}

double checked(const std::optional<double>& value, std::string_view text) {
  if (!value) throw std::invalid_argument(quote(text) + " is beyond the range of a double");
  return *value;
}

// Returns the shortest text of `value` in `unit` that reads back as the same double. Empty if no
// text does, such as in a unit in which the value is beyond the range of a double.
std::string text_in(double value, const Unit& unit) {
  const double scaled = value / unit.factor;
  if (!std::isfinite(scaled)) return "";
  std::string suffix(unit.symbol);
  if (!suffix.empty()) suffix.insert(suffix.begin(), ' ');
  for (int digits = 0; digits < std::numeric_limits<double>::max_digits10; ++digits) {
    std::array<char, 32> buffer{};
    const auto result =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), scaled, std::chars_format::scientific, digits);
    double rounded = 0.0;
    // Rounding up to few digits may leave the range of a double.
    if (std::from_chars(buffer.data(), result.ptr, rounded).ec != std::errc{}) continue;
    const std::string number = format_number(rounded);
    if (value_in(*split(number), unit) == value) return number + suffix;
  }
  return "";
}

}  // namespace

std::string_view si_symbol(Quantity quantity) { return info(quantity).units.front().symbol; }

std::span<const Unit> units_of(Quantity quantity) { return info(quantity).units; }

double parse_quantity(std::string_view text, Quantity quantity) {
  const std::optional<NumberText> number = split(text);
  if (!number) not_a_number(text, quantity);
  if (number->infinite) {
    const double infinity = std::numeric_limits<double>::infinity();
    return number->negative ? -infinity : infinity;
  }
  if (number->unit.empty()) return checked(shifted(*number, 0), text);
  for (const Unit& unit : units_of(quantity)) {
    if (unit.symbol == number->unit) return checked(value_in(*number, unit), text);
  }
  throw std::invalid_argument("unknown unit " + quote(number->unit) + " of " + std::string(info(quantity).noun) + " in " +
                              quote(text) + allowed_names(number->unit, unit_names(quantity)));
}

Quantity quantity_of(std::string_view text) {
  const std::optional<NumberText> number = split(text);
  if (!number) not_a_number(text, Quantity::none);
  if (number->unit.empty()) return Quantity::none;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < table().size(); ++i) {
    for (const Unit& unit : table()[i].units) {
      if (unit.symbol == number->unit) return static_cast<Quantity>(i);
      if (!unit.symbol.empty()) names.push_back(unit.symbol);
    }
  }
  throw std::invalid_argument("unknown unit " + quote(number->unit) + " in " + quote(text) + allowed_names(number->unit, names));
}

std::string format_number(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string format_quantity(double value, Quantity quantity) {
  if (!std::isfinite(value)) return format_number(value);
  std::string best;
  std::size_t best_length = std::string::npos;
  for (const std::string_view symbol : info(quantity).written) {
    for (const Unit& unit : units_of(quantity)) {
      if (unit.symbol != symbol) continue;
      const std::string text = text_in(value, unit);
      // Only the number's length counts: a long symbol is as readable as a short one.
      const std::size_t length = text.empty() ? std::string::npos : text.size() - symbol.size();
      if (length < best_length) {
        best_length = length;
        best = text;
      }
    }
  }
  return best;
}

}  // namespace slipbench
