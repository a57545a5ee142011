// Compares fields after equal steps.
#pragma once

#include <cstring>

#include <gtest/gtest.h>

#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field {

// Compares every accessor of field.h bit by bit, events included.
inline testing::AssertionResult same_bits(Field& a, Field& b) {
  const auto equal = [](const auto& x, const auto& y) { return std::memcmp(x.data(), y.data(), 3 * sizeof(double)) == 0; };
  const auto equal_numbers = [](double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  const auto differs = [](const char* what, std::size_t i) { return testing::AssertionFailure() << what << " of element " << i; };
  a.view_from_pad();
  b.view_from_pad();
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.state(i) != b.state(i) || a.state_before(i) != b.state_before(i)) return differs("state", i);
    if (!equal_numbers(a.normal_force(i), b.normal_force(i))) return differs("normal force", i);
    if (!equal_numbers(a.penetration(i), b.penetration(i))) return differs("penetration", i);
    if (!equal_numbers(a.stick_limit(i), b.stick_limit(i))) return differs("stick limit", i);
    if (!equal_numbers(a.slip_path(i), b.slip_path(i))) return differs("slip path", i);
    if (!equal(a.tangential_force(i), b.tangential_force(i))) return differs("tangential force", i);
    if (!equal(a.stretch(i), b.stretch(i))) return differs("stretch", i);
    if (!equal(a.slip_step(i), b.slip_step(i))) return differs("slip", i);
    if (!equal(a.normal(i), b.normal(i))) return differs("normal", i);
    if (!equal(a.contact_point(i), b.contact_point(i))) return differs("contact point", i);
    if (!equal(a.force_on_pad(i), b.force_on_pad(i))) return differs("force on the pad", i);
    if (!equal(a.deflection(i), b.deflection(i))) return differs("deflection", i);
    if (!equal(a.slip_in_pad(i), b.slip_in_pad(i))) return differs("slip in the pad", i);
  }
  if (a.events().size() != b.events().size()) return testing::AssertionFailure() << "number of events";
  for (std::size_t k = 0; k < a.events().size(); ++k) {
    const ElementEvent &x = a.events()[k], &y = b.events()[k];
    if (x.element != y.element || x.from != y.from || x.to != y.to || !equal_numbers(x.fraction, y.fraction))
      return differs("event", x.element);
  }
  return testing::AssertionSuccess();
}

}  // namespace slipbench::testing_field
