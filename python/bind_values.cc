// Random streams and quantities: scripts draw and parse numbers exactly as the program does.
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "python/arrays.h"
#include "python/module.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/random.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

template <class Draw>
nb::ndarray<nb::numpy, double> drawn(std::size_t count, const Draw& draw) {
  std::vector<double> values(count);
  for (double& value : values) value = draw();
  return array_of(std::move(values));
}

nb::ndarray<nb::numpy, std::int64_t> permutation(RandomStream& stream, std::size_t count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  shuffle(numbers, stream);
  return array_of(std::move(numbers));
}

constexpr std::array quantities{
    Quantity::none,         Quantity::length,  Quantity::time,          Quantity::speed,
    Quantity::acceleration, Quantity::angle,   Quantity::angular_speed, Quantity::angular_acceleration,
    Quantity::frequency,    Quantity::force,   Quantity::mass,          Quantity::stiffness,
    Quantity::damping,      Quantity::pressure};

Quantity quantity_in(const std::string& unit) {
  std::string allowed;
  for (const Quantity quantity : quantities) {
    for (const Unit& one : units_of(quantity)) {
      if (one.symbol == unit) return quantity;
    }
    if (quantity != Quantity::none) allowed += (allowed.empty() ? "" : ", ") + std::string(si_symbol(quantity));
  }
  throw InputError("unit " + quote(unit) + " is not a unit of any quantity; allowed: " + allowed + ", and the quantity of each");
}

// Value in SI. `unit`: a unit of the required quantity; empty: any quantity.
double parsed_quantity(const std::string& text, const std::optional<std::string>& unit) {
  try {
    return parse_quantity(text, unit ? quantity_in(*unit) : quantity_of(text));
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace

void bind_values(nb::module_& module) {
  nb::class_<RandomStream>(module, "RandomStream")
      .def("__init__", [](RandomStream* made, std::uint64_t seed, std::uint64_t trial,
                          const std::string& name) { new (made) RandomStream(seed, trial, name); })
      .def("uniform", [](RandomStream& stream, double low, double high) { return stream.uniform(low, high); })
      .def("normal", [](RandomStream& stream, double mean, double sd) { return stream.normal(mean, sd); })
      .def("uniforms", [](RandomStream& stream, double low, double high,
                          std::size_t count) { return drawn(count, [&] { return stream.uniform(low, high); }); })
      .def("normals", [](RandomStream& stream, double mean, double sd,
                         std::size_t count) { return drawn(count, [&] { return stream.normal(mean, sd); }); })
      .def("integer", [](RandomStream& stream, std::uint64_t bound) { return stream.integer(bound); })
      .def("permutation", &permutation)
      .def("copy", [](const RandomStream& stream) { return RandomStream(stream); });
  module.def("printable", [](const std::string& text, bool lines) { return printable(text, lines); });
  module.def("parse_quantity", &parsed_quantity, nb::arg("text"), nb::arg("unit").none());
}

}  // namespace slipbench::python
