// Locates the values that a detector reads in a frame.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/api/detector.h"
#include "sim/core/math.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Returns the end of a message about a channel that a sensor has in the physical unit `found`, and a
// reader needs in `needed`.
inline std::string other_unit_remedy(std::string_view found, std::string_view needed) {
  if (found == "counts")
    return "; the key scale of the map of `import` states what one count is, for example scale: 0.01 " + std::string(needed);
  return "; the keys unit and scale of the map of `import` convert recordings to SI units";
}

// Values of one channel inside a frame.
struct ChannelPlace {
  std::size_t first = 0;  // index into SensorFrame::values
  std::size_t units = 0;  // extent of the channel's first axis
};

// Returns the place of the channel `name` of `source`, which must hold `axes` (2 or 3) values per
// unit, in the physical `unit`: extents {N, axes}. `detector`: name of the detector, for errors.
// Throws SceneValueError at detector.sensor if the sensor has no such channel, or has it in another
// physical unit.
ChannelPlace vector_channel(const FrameSource& source, std::string_view name, std::string_view unit, const std::string& detector,
                            std::size_t axes = 3);

// Returns the index into SensorFrame::values of the channel `name`, which must hold one value:
// extents {1}. `detector`: name of the detector, for errors. Throws SceneValueError at
// detector.sensor if the sensor has no such channel.
std::size_t scalar_channel(const FrameSource& source, std::string_view name, const std::string& detector);

// Returns the end of a message about a `length` [s] of `samples` sampling times, which is not a whole
// number of them: "; at 950 Hz or 1 kHz it is one; `import --rate` resamples a recording".
std::string even_rates_text(double length, double samples);

// Returns the three values (x, y, z of the pad frame) of `unit` in `frame`.
inline std::span<const float, 3> vector_at(const SensorFrame& frame, const ChannelPlace& place, std::size_t unit) {
  return frame.values.subspan(place.first + 3 * unit).first<3>();
}

// A unit's force [N].
struct UnitForce {
  double normal;
  double tangential;  // length of x and y
};

inline UnitForce force_at(const SensorFrame& frame, const ChannelPlace& force, std::size_t unit) {
  const auto f = vector_at(frame, force, unit);
  return {f[2], math::hypot(double{f[0]}, double{f[1]})};
}

// Estimates for the pad from the states of its units.

// Numbers of units, as a detector sees them.
struct UnitCounts {
  std::size_t touching = 0;
  std::size_t slipping = 0;  // among the touching ones

  [[nodiscard]] PadState state() const { return pad_state(touching, slipping); }

  // Share of the touching units that stick; NaN without a touching unit.
  [[nodiscard]] double stuck_fraction() const {
    if (touching == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(touching - slipping) / static_cast<double>(touching);
  }
};

// The estimate that the counts give for the frame at `time` [s], without latency.
inline SlipEstimate estimate_of(const UnitCounts& counts, double time) {
  return {.time = time, .latency = 0.0, .state = counts.state(), .stuck_fraction = counts.stuck_fraction()};
}

// Declarations of the thresholds "touch" [N] and "least_friction".
inline ParameterSpec touch_spec() {
  return number_spec("touch", Quantity::force, "0.05 N", positive, "Normal force above which a unit counts as touching.",
                     "the force resolution of the PapillArray: less is noise, whose ratio is meaningless");
}

inline ParameterSpec least_friction_spec() {
  return number_spec(
      "least_friction", Quantity::none, "0.2", non_negative,
      "Ratio f_t/f_n below which a unit always counts as sticking: the bending of the fingers shears a closing pad slightly.",
      "assumed: below the friction of every material of the catalogue except the soaped one");
}

// Rates of change over a window of frames.

// Takes `size` values per frame. A longer window resolves smaller rates but responds later: when a
// rate drops to zero, its estimate falls linearly over one window.
class Window {
 public:
  // `length` [s] must be a whole number of the source's frames; otherwise throws SceneValueError at
  // detector.window. `detector`: name of the detector, for errors.
  Window(double length, std::size_t size, const FrameSource& source, const std::string& detector);

  // Returns (values now - values one window ago) / length, [size]; all 0 until one window has
  // passed. `values` must hold `size` numbers. Valid until the next call.
  std::span<const double> rates(std::span<const double> values);

 private:
  double length_;  // s
  std::size_t frames_;
  std::vector<double> past_;  // [frames, size], a ring
  std::vector<double> rates_;
  std::size_t seen_ = 0;
};

// Declaration of the parameter "window".
ParameterSpec window_spec();

}  // namespace slipbench
