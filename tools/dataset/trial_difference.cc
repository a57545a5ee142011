#include "tools/dataset/trial_difference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/dataset/record/encoder.h"

namespace slipbench {
namespace {

using Json = nlohmann::json;

struct Values {
  ElementType type;
  std::vector<std::size_t> shape;
  std::vector<std::uint8_t> bytes;
};

std::map<std::string, Values> values_of(const TrialRecord& trial) {
  std::map<std::string, Values> arrays;
  for (const ArrayView& view : arrays_of(trial)) {
    arrays[view.path] = {view.type, view.shape, {view.bytes, view.bytes + view.size_bytes()}};
  }
  return arrays;
}

template <class Number>
std::vector<double> numbers_in(const Values& values) {
  std::vector<Number> numbers(values.bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), values.bytes.data(), values.bytes.size());
  return {numbers.begin(), numbers.end()};
}

double largest_of(const std::vector<double>& numbers) {
  double largest = 0.0;
  for (const double number : numbers) {
    if (std::isfinite(number)) largest = std::max(largest, std::abs(number));
  }
  return largest;
}

// Index of the first number that does not agree; empty if all do. `turn`: period modulo which
// numbers are compared; 0: not periodic.
std::optional<std::size_t> first_difference(const std::vector<double>& one, const std::vector<double>& other, double last_place,
                                            double turn) {
  const double scale = std::max(largest_of(one), largest_of(other));
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double apart = one[i] - other[i];
    if (turn > 0.0 && std::abs(apart - turn * std::round(apart / turn)) <= (library_rounding + last_place) * scale) continue;
    if (!agree(one[i], other[i], scale, last_place)) return i;
  }
  return std::nullopt;
}

std::string array_difference(const std::string& path, const Values& one, const Values& other) {
  if (one.type != other.type || one.shape != other.shape) return path + " has another type or shape";
  const auto at = [&]() -> std::optional<std::size_t> {
    if (one.bytes == other.bytes) return std::nullopt;
    if (one.type == ElementType::f64) return first_difference(numbers_in<double>(one), numbers_in<double>(other), 0.0, 0.0);
    if (one.type != ElementType::f32) return 0;  // codes and counts
    const double turn = path.ends_with("/slip_direction") ? 2.0 * std::numbers::pi : 0.0;
    return first_difference(numbers_in<float>(one), numbers_in<float>(other), std::numeric_limits<float>::epsilon(), turn);
  }();
  return at ? fmt::format("{} differs from value {} on", path, *at) : "";
}

bool texts_agree(const std::string& one, const std::string& other) {
  const Json a = Json::parse(one, nullptr, false), b = Json::parse(other, nullptr, false);
  if (a.is_discarded() || b.is_discarded()) return one == other;
  const Json flat = a.flatten(), others = b.flatten();
  return std::ranges::equal(flat.items(), others.items(), [](const auto& x, const auto& y) {
    if (x.key() != y.key()) return false;
    if (!x.value().is_number() || !y.value().is_number()) return x.value() == y.value();
    return agree(x.value().template get<double>(), y.value().template get<double>(), 0.0);
  });
}

bool attributes_agree(const EncodedAttribute& one, const EncodedAttribute& other) {
  if (one.path != other.path || one.name != other.name || one.value.index() != other.value.index()) return false;
  if (const auto* number = std::get_if<double>(&one.value)) return agree(*number, std::get<double>(other.value), 0.0);
  if (const auto* text = std::get_if<std::string>(&one.value)) return texts_agree(*text, std::get<std::string>(other.value));
  if (const auto* matrix = std::get_if<EncodedAttribute::Doubles>(&one.value)) {
    const auto& second = std::get<EncodedAttribute::Doubles>(other.value);
    return matrix->shape == second.shape && !first_difference(matrix->values, second.values, 0.0, 0.0);
  }
  if (const auto* count = std::get_if<std::uint64_t>(&one.value)) return *count == std::get<std::uint64_t>(other.value);
  return std::get<std::vector<std::string>>(one.value) == std::get<std::vector<std::string>>(other.value);
}

}  // namespace

bool agree(double one, double other, double scale, double last_place) {
  if (one == other || (std::isnan(one) && std::isnan(other))) return true;
  if (!std::isfinite(one) || !std::isfinite(other)) return false;
  const double larger = std::max(std::abs(one), std::abs(other));
  return std::abs(one - other) <= library_rounding * std::max(larger, scale) + last_place * larger;
}

std::string trial_difference(const TrialRecord& one, const TrialRecord& other) {
  if (one.libraries.empty() || other.libraries.empty()) return "their digests differ";
  const std::map<std::string, Values> arrays = values_of(one), others = values_of(other);
  if (arrays.size() != others.size()) return "they have different arrays";
  for (const auto& [path, values] : arrays) {
    const auto second = others.find(path);
    if (second == others.end()) return "they have different arrays";
    if (std::string difference = array_difference(path, values, second->second); !difference.empty()) return difference;
  }
  const std::vector<EncodedAttribute> attributes = attributes_of(one), second = attributes_of(other);
  if (attributes.size() != second.size()) return "they have different attributes";
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    if (!attributes_agree(attributes[i], second[i]))
      return fmt::format("attribute {} of '{}' differs", attributes[i].name, attributes[i].path);
  }
  return {};
}

}  // namespace slipbench
