// The state of an element of the field, and its changes.
#pragma once

#include <cstdint>

namespace slipbench {

// State of one element.
enum class ElementState : std::uint8_t { detached = 0, stick = 1, slip = 2 };

// A change of an element's state inside the last step.
struct ElementEvent {
  double fraction;  // of the step, in [0, 1]
  std::uint32_t element;
  ElementState from, to;
};

}  // namespace slipbench
