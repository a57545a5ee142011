// Reports invalid input in one call.
#pragma once

#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

// Throws InputError with a message formatted as by fmt::format.
template <class... Values>
[[noreturn]] void reject(fmt::format_string<Values...> message, Values&&... values) {
  throw InputError(fmt::format(message, std::forward<Values>(values)...));
}

}  // namespace slipbench
