#include "sim/core/parameters.h"

#include <charconv>
#include <cmath>
#include <iterator>

#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

constexpr double largest = std::numeric_limits<double>::max();
constexpr double least_size = 1e-60, greatest_size = 1e60;  // of a number other than 0, in SI

std::string_view type_name(ParameterType type) {
  switch (type) {
    case ParameterType::number: return "number";
    case ParameterType::integer: return "integer";
    case ParameterType::flag: return "flag";
    case ParameterType::choice: return "choice";
    case ParameterType::vector: return "vector";
    case ParameterType::path: return "path";
    case ParameterType::map: return "map";
    case ParameterType::table: return "table";
  }
  throw std::logic_error("no such parameter type");
}

template <class T>
const T& value_of(const std::map<std::string, Parameters::Value, std::less<>>& values, std::string_view name,
                  ParameterType type) {
  const auto found = values.find(name);
  if (found == values.end()) throw std::logic_error("parameter " + quote(name) + " was not declared");
  const T* value = std::get_if<T>(&found->second);
  if (value == nullptr) throw std::logic_error("parameter " + quote(name) + " is not a " + std::string(type_name(type)));
  return *value;
}

bool may_be_infinite(const ParameterSpec& spec) {
  return spec.range.infinite || spec.default_text.find("inf") != std::string::npos;
}

// Writes the range in the unit of `given`, the refused value.
std::string allowed_range(const ParameterSpec& spec, std::string_view given) {
  std::string text;
  if (spec.range.min >= -largest) {
    text = (spec.range.open_min ? "> " : ">= ") + bound_in_unit_of(given, spec.range.min, spec.quantity, Bound::lower);
  }
  if (spec.range.max <= largest) {
    text += (text.empty() ? "<= " : " and <= ") + bound_in_unit_of(given, spec.range.max, spec.quantity, Bound::upper);
  }
  return text;
}

void check_range(const ParameterSpec& spec, double value, std::string_view text) {
  if (std::isinf(value) && !may_be_infinite(spec)) {
    throw std::invalid_argument(quote(text) + " is infinite; allowed: a finite number");
  }
  const bool low = spec.range.open_min ? !(value > spec.range.min) : !(value >= spec.range.min);
  if (low || value > spec.range.max) {
    throw std::invalid_argument(quote(text) + " is out of range; allowed: " + allowed_range(spec, text));
  }
}

// Products and quotients of a few parameters must stay within the range of a double.
void check_size(const ParameterSpec& spec, double value, std::string_view text) {
  const double size = std::abs(value);
  if (size == 0.0 || std::isinf(value) || (size >= least_size && size <= greatest_size)) return;
  const bool small = size < least_size, or_zero = spec.range.min < 0.0 || (spec.range.min == 0.0 && !spec.range.open_min);
  throw std::invalid_argument(
      quote(text) + (small ? " is too small; allowed: a size of at least " : " is too large; allowed: a size of at most ") +
      bound_in_unit_of(text, small ? least_size : greatest_size, spec.quantity, small ? Bound::lower : Bound::upper) +
      (small && or_zero ? ", or 0" : ""));
}

std::int64_t parse_integer(const ParameterSpec& spec, std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) throw std::invalid_argument(quote(text) + " is beyond the range of 64 bits");
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw std::invalid_argument(quote(text) + " is not a whole number; allowed: digits, with a leading '-' if negative");
  }
  check_range(spec, static_cast<double>(value), text);
  return value;
}

bool parse_flag(std::string_view text) {
  if (text == "true") return true;
  if (text == "false") return false;
  throw std::invalid_argument(quote(text) + " is not a flag; allowed: true, false");
}

std::string parse_choice(const ParameterSpec& spec, std::string_view text) {
  for (const std::string& choice : spec.choices) {
    if (choice == text) return choice;
  }
  throw std::invalid_argument("unknown value " + quote(text) + allowed_names(text, spec.choices));
}

std::string parse_path(const ParameterSpec& spec, std::string_view text) {
  if (text.empty()) throw std::invalid_argument("the path is empty; allowed: a path, or " + spec.default_text);
  return std::string(text);
}

// Parses the entries of a default such as "[0 mm, 0 mm]".
Parameters::Value default_vector(const ParameterSpec& spec) {
  std::string_view rest = spec.default_text;
  if (rest.size() < 2 || rest.front() != '[' || rest.back() != ']') {
    throw std::invalid_argument(quote(rest) + " is not a vector; allowed: '[a, b, ...]'");
  }
  rest = rest.substr(1, rest.size() - 2);
  std::vector<double> entries;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    entries.push_back(std::get<double>(parse_scalar(spec, rest.substr(0, comma))));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  if (entries.size() != spec.size) throw std::invalid_argument(quote(spec.default_text) + " has the wrong number of entries");
  return entries;
}

ParameterSpec spec_of(ParameterType type, std::string name, std::string default_text, std::string doc, std::string source) {
  ParameterSpec spec;
  spec.name = std::move(name);
  spec.type = type;
  spec.default_text = std::move(default_text);
  spec.doc = std::move(doc);
  spec.source = std::move(source);
  return spec;
}

}  // namespace

ParameterSpec number_spec(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                          std::string source) {
  ParameterSpec spec =
      spec_of(ParameterType::number, std::move(name), std::move(default_text), std::move(doc), std::move(source));
  spec.quantity = quantity;
  spec.range = range;
  return spec;
}

ParameterSpec vector_spec(std::size_t size, std::string name, Quantity quantity, std::string default_text, Range range,
                          std::string doc, std::string source) {
  ParameterSpec spec = number_spec(std::move(name), quantity, std::move(default_text), range, std::move(doc), std::move(source));
  spec.type = ParameterType::vector;
  spec.size = size;
  return spec;
}

ParameterSpec integer_spec(std::string name, std::string default_text, Range range, std::string doc, std::string source) {
  ParameterSpec spec =
      spec_of(ParameterType::integer, std::move(name), std::move(default_text), std::move(doc), std::move(source));
  spec.range = range;
  return spec;
}

ParameterSpec flag_spec(std::string name, std::string default_text, std::string doc, std::string source) {
  return spec_of(ParameterType::flag, std::move(name), std::move(default_text), std::move(doc), std::move(source));
}

ParameterSpec choice_spec(std::string name, std::string default_text, std::vector<std::string> choices, std::string doc,
                          std::string source) {
  ParameterSpec spec =
      spec_of(ParameterType::choice, std::move(name), std::move(default_text), std::move(doc), std::move(source));
  spec.choices = std::move(choices);
  return spec;
}

ParameterSpec path_spec(std::string name, std::string default_text, std::string doc, std::string source,
                        std::vector<std::string> choices) {
  ParameterSpec spec = spec_of(ParameterType::path, std::move(name), std::move(default_text), std::move(doc), std::move(source));
  spec.choices = std::move(choices);
  return spec;
}

ParameterSpec map_spec(std::string name, std::string doc, std::string source, std::vector<std::string> choices) {
  ParameterSpec spec = spec_of(ParameterType::map, std::move(name), "{}", std::move(doc), std::move(source));
  spec.choices = std::move(choices);
  return spec;
}

ParameterSpec table_spec(std::size_t size, std::string name, std::vector<TableColumn> columns, std::string doc,
                         std::string source) {
  ParameterSpec spec = spec_of(ParameterType::table, std::move(name), "none", std::move(doc), std::move(source));
  spec.size = size;
  spec.columns = std::move(columns);
  return spec;
}

void check_times(const NumberTable& table, const std::string& key) {
  for (std::size_t k = 1; k < table.rows.size(); ++k) {
    const double time = table.rows[k].front(), before = table.rows[k - 1].front();
    if (time >= before) continue;
    throw SceneValueError(key, "row " + std::to_string(k + 1) + " is at " + format_quantity(time, Quantity::time) + ", row " +
                                   std::to_string(k) + " at " + format_quantity(before, Quantity::time) +
                                   "; allowed: times that do not decrease");
  }
}

bool is_identifier(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

std::vector<ParameterSpec> joined(std::vector<ParameterSpec> first, std::vector<ParameterSpec> second) {
  std::ranges::move(second, std::back_inserter(first));
  return first;
}

double Parameters::number(std::string_view name) const { return value_of<double>(values_, name, ParameterType::number); }

std::int64_t Parameters::integer(std::string_view name) const {
  return value_of<std::int64_t>(values_, name, ParameterType::integer);
}

bool Parameters::flag(std::string_view name) const { return value_of<bool>(values_, name, ParameterType::flag); }

const std::string& Parameters::choice(std::string_view name) const {
  return value_of<std::string>(values_, name, ParameterType::choice);
}

const std::string& Parameters::path(std::string_view name) const {
  return value_of<std::string>(values_, name, ParameterType::path);
}

const std::vector<double>& Parameters::vector(std::string_view name) const {
  return value_of<std::vector<double>>(values_, name, ParameterType::vector);
}

const ParameterMap& Parameters::map(std::string_view name) const {
  return value_of<ParameterMap>(values_, name, ParameterType::map);
}

const NumberTable& Parameters::table(std::string_view name) const {
  return value_of<NumberTable>(values_, name, ParameterType::table);
}

Parameters::Value parse_scalar(const ParameterSpec& spec, std::string_view text) {
  switch (spec.type) {
    case ParameterType::integer: return parse_integer(spec, text);
    case ParameterType::flag: return parse_flag(text);
    case ParameterType::choice: return parse_choice(spec, text);
    case ParameterType::path: return parse_path(spec, text);
    case ParameterType::map: throw std::invalid_argument(quote(text) + " is not a map; allowed: {name: value, ...}");
    case ParameterType::table: throw std::invalid_argument(quote(text) + " is not a table; allowed: [[a, b, ...], ...]");
    case ParameterType::number:
    case ParameterType::vector: {
      const double value = parse_quantity(text, spec.quantity);
      check_range(spec, value, text);
      check_size(spec, value, text);
      return value;
    }
  }
  throw std::logic_error("no such parameter type");
}

Parameters::Value default_of(const ParameterSpec& spec) {
  if (spec.type == ParameterType::map) return ParameterMap{};
  if (spec.type == ParameterType::table) return NumberTable{};
  try {
    return spec.type == ParameterType::vector ? default_vector(spec) : parse_scalar(spec, spec.default_text);
  } catch (const std::invalid_argument& error) {
    throw std::logic_error("default of parameter " + quote(spec.name) + ": " + error.what());
  }
}

Parameters defaults_of(const std::vector<ParameterSpec>& specs) {
  Parameters parameters;
  for (const ParameterSpec& spec : specs) parameters.set(spec.name, default_of(spec));
  return parameters;
}

}  // namespace slipbench
