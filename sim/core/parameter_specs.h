// Declarations of parameters, in short.
#pragma once

#include <cstddef>
#include <string>

#include "sim/core/parameters.h"

namespace slipbench {

// A number, and a vector of `size` numbers that share quantity and range. The rest as the members of ParameterSpec.
ParameterSpec number_spec(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                          std::string source);
ParameterSpec vector_spec(std::size_t size, std::string name, Quantity quantity, std::string default_text, Range range,
                          std::string doc, std::string source);

}  // namespace slipbench
