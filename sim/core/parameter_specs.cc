#include "sim/core/parameter_specs.h"

#include <utility>

namespace slipbench {

ParameterSpec number_spec(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                          std::string source) {
  return {.name = std::move(name),
          .type = ParameterType::number,
          .quantity = quantity,
          .default_text = std::move(default_text),
          .range = range,
          .choices = {},
          .size = 1,
          .doc = std::move(doc),
          .source = std::move(source)};
}

ParameterSpec vector_spec(std::size_t size, std::string name, Quantity quantity, std::string default_text, Range range,
                          std::string doc, std::string source) {
  ParameterSpec spec = number_spec(std::move(name), quantity, std::move(default_text), range, std::move(doc), std::move(source));
  spec.type = ParameterType::vector;
  spec.size = size;
  return spec;
}

}  // namespace slipbench
