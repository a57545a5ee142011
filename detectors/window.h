// Rates of change, from frames that lie one window apart.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Takes `size` values a frame. A longer window tells smaller rates from noise and tells them later: a rate that ends at once falls off in a
// straight line over one window.
class Window {
 public:
  // `length` [s], of a whole number of the source's frames; SceneValueError at detector.window otherwise, with `detector` as who asks.
  Window(double length, std::size_t size, const FrameSource& source, const std::string& detector);

  // (values now - values one window ago) / length, [size]; all 0 until one window has passed. `values` must hold `size`. Valid until the next
  // call.
  std::span<const double> rates(std::span<const double> values);

 private:
  double length_;  // s
  std::size_t frames_;
  std::vector<double> past_;  // [frames, size], a ring
  std::vector<double> rates_;
  std::size_t seen_ = 0;
};

// The declaration of such a length, "window".
ParameterSpec window_spec();

}  // namespace slipbench
