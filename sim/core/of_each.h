// A list made of another one.
#pragma once

#include <functional>
#include <iterator>
#include <type_traits>
#include <vector>

namespace slipbench {

// What `make`, a function or a member, makes of each value of `range`, in its order: of_each(channels, &Channel::name). `Value`: the list's type,
// where it is not what `make` returns.
template <class Value = void, class Range, class Make>
auto of_each(Range&& range, const Make& make) {
  using Made = std::remove_cvref_t<std::invoke_result_t<const Make&, decltype(*std::begin(range))>>;
  std::vector<std::conditional_t<std::is_void_v<Value>, Made, Value>> made;
  for (auto&& one : range) made.emplace_back(std::invoke(make, one));
  return made;
}

}  // namespace slipbench
