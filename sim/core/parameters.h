// Parameters: one declaration serves the scene parser, the error messages and `slipbench describe`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "sim/core/quantity.h"

namespace slipbench {

// Type of a parameter's value.
enum class ParameterType {
  number,
  integer,
  flag,
  choice,
  vector,
  // of a file or folder, relative to the folder of the scene, by --set to the current folder; a
  // word such as the default is kept as it is
  path,
  map,    // names and values that another part, such as a plugin's library, declares; default: none
  table,  // rows of numbers, written in the scene or in a CSV file; default: none
};

// Allowed interval of a number (or of each entry of a vector), in SI. Bounds are included unless
// `open_min` is set. Infinity is refused unless `infinite` is set or the parameter's own default is
// inf: elsewhere it would end as NaN.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;
  bool infinite = false;  // inf has a meaning here: "never", "no limit"
};

inline constexpr Range any_value{};
inline constexpr Range positive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range positive_or_infinite{0.0, std::numeric_limits<double>::infinity(), true, true};
inline constexpr Range non_negative{0.0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range fraction{0.0, 1.0, false};
constexpr Range positive_up_to(double max) { return {0.0, max, true}; }

// A column of ParameterType::table.
struct TableColumn {
  std::string name;  // in the header of a CSV file
  Quantity quantity = Quantity::none;
};

// The declaration of one parameter.
struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::number;
  Quantity quantity = Quantity::none;
  std::string default_text;  // as a scene would write it: "1 mm", "[0 mm, 0 mm]", "true", "gripper"
  Range range = any_value;
  // Allowed values of a choice; of each value of a map (empty: any text); for a path, words besides
  // the default that are not paths.
  std::vector<std::string> choices;
  std::size_t size = 1;  // entries of a vector; required columns of a table
  // Columns of a table, in the order of a row; empty: numbers without header or unit.
  std::vector<TableColumn> columns;
  std::string doc;     // one sentence: what the parameter does
  std::string source;  // source of the default: a paper, a data sheet, "assumed", or "set for each scene"
};

// One function per type, with the members of ParameterSpec as arguments, so that a list of
// specifications reads as a table. The entries of a vector share quantity and range.
ParameterSpec number_spec(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                          std::string source);
ParameterSpec vector_spec(std::size_t size, std::string name, Quantity quantity, std::string default_text, Range range,
                          std::string doc, std::string source);
ParameterSpec integer_spec(std::string name, std::string default_text, Range range, std::string doc, std::string source);
ParameterSpec flag_spec(std::string name, std::string default_text, std::string doc, std::string source);
ParameterSpec choice_spec(std::string name, std::string default_text, std::vector<std::string> choices, std::string doc,
                          std::string source);
ParameterSpec path_spec(std::string name, std::string default_text, std::string doc, std::string source,
                        std::vector<std::string> choices = {});
// `choices`: the allowed values; empty: any text.
ParameterSpec map_spec(std::string name, std::string doc, std::string source, std::vector<std::string> choices = {});
// The first `size` columns are required.
ParameterSpec table_spec(std::size_t size, std::string name, std::vector<TableColumn> columns, std::string doc,
                         std::string source);

// Returns both lists, one after the other.
std::vector<ParameterSpec> joined(std::vector<ParameterSpec> first, std::vector<ParameterSpec> second);

// ParameterType::map: each name in the scene's order, with its value as the scene writes it, "4
// mm/s".
using ParameterMap = std::vector<std::pair<std::string, std::string>>;

// ParameterType::table: all rows have the same length, that of the declared columns if there are
// any.
struct NumberTable {
  std::string path;                       // of the CSV file; "" if the rows stand in the scene
  std::vector<std::vector<double>> rows;  // SI; NaN in an omitted column

  friend bool operator==(const NumberTable&, const NumberTable&) = default;
};

// Throws SceneValueError at `key` where the time of a row, its first value [s], is earlier than
// that of the row before.
void check_times(const NumberTable& table, const std::string& key);

// True if `name` is a valid identifier of a scene: letters, digits and '_', no digit first.
bool is_identifier(std::string_view name);

// Values of a set of parameters, all present: the reader fills in defaults. An accessor throws
// std::logic_error for a name or type that was not declared: that is a bug, not bad input.
class Parameters {
 public:
  using Value = std::variant<double, std::int64_t, bool, std::string, std::vector<double>, ParameterMap, NumberTable>;

  void set(std::string name, Value value) { values_.insert_or_assign(std::move(name), std::move(value)); }

  [[nodiscard]] double number(std::string_view name) const;  // SI
  [[nodiscard]] std::int64_t integer(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const;
  [[nodiscard]] const std::string& choice(std::string_view name) const;
  [[nodiscard]] const std::string& path(std::string_view name) const;
  [[nodiscard]] const std::vector<double>& vector(std::string_view name) const;  // SI
  [[nodiscard]] const ParameterMap& map(std::string_view name) const;
  [[nodiscard]] const NumberTable& table(std::string_view name) const;
  [[nodiscard]] const std::map<std::string, Value, std::less<>>& values() const { return values_; }

 private:
  std::map<std::string, Value, std::less<>> values_;
};

// The declared default of one parameter. Throws std::logic_error when it does not fit its own
// declaration.
Parameters::Value default_of(const ParameterSpec& spec);

// All parameters of `specs` at their declared defaults. Throws std::logic_error when a default does
// not fit its own declaration.
Parameters defaults_of(const std::vector<ParameterSpec>& specs);

// Parses the text of one scalar into a value of `spec`'s type and checks range and choices. Vectors
// are read entry by entry with this function; maps and tables are refused. Throws
// std::invalid_argument: what was found, what is allowed, the nearest known choice.
Parameters::Value parse_scalar(const ParameterSpec& spec, std::string_view text);

// A catalogue entry named by a scene, with the values of its parameters.
struct Named {
  std::string name;
  Parameters parameters;
};

// A catalogue's description of an entry: an effect, a sensor, a motion, a surface, a part of the
// electronics, a detector.
struct Entry {
  std::string name;
  std::string summary;  // one line
  std::string law;      // the equation with its symbols, may have several lines; may be empty
  std::string source;   // paper, data sheet or "assumed"
  std::vector<ParameterSpec> parameters;
};

}  // namespace slipbench
