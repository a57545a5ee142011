// A list made of another one.
#pragma once

#include <cstddef>
#include <functional>
#include <iterator>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipbench {

// What `make`, a function or a member, makes of each value of `range` of which `chosen` is true, in its order; without `make` the values themselves:
// of_those(sensors, [](const Sensor& s) { return s.rate > 0.0; }, &Sensor::name). `Value`: the list's type, where it is not what `make` returns.
template <class Value = void, class Range, class Chosen, class Make = std::identity>
auto of_those(Range&& range, const Chosen& chosen, const Make& make = {}) {
  using Made = std::remove_cvref_t<std::invoke_result_t<const Make&, decltype(*std::begin(range))>>;
  std::vector<std::conditional_t<std::is_void_v<Value>, Made, Value>> made;
  for (auto&& one : range) {
    if (std::invoke(chosen, std::as_const(one))) made.emplace_back(std::invoke(make, one));
  }
  return made;
}

// Of all of them: of_each(channels, &Channel::name).
template <class Value = void, class Range, class Make>
auto of_each(Range&& range, const Make& make) {
  return of_those<Value>(
      range, [](const auto&) { return true; }, make);
}

// Of 0 to `count` - 1; without `make` these numbers.
template <class Value = void, class Make = std::identity>
auto of_numbers(std::size_t count, const Make& make = {}) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return of_each<Value>(numbers, make);
}

}  // namespace slipbench
