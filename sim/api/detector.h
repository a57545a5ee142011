// A detector estimates slip from a sensor's frames. Its interface gives no access to the truth:
// neither this header nor a detector may include sim/api/contact_frame.h or sim/api/sensor.h,
// which tests/style checks.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/api/pad_state.h"
#include "sim/api/sensor_frame.h"

namespace slipbench {

// A number that a detector computes and publishes besides the class, such as the magnitude in a
// band or a calibrated force.
struct Feature {
  std::string name;  // "fr_0_6"
  std::string unit;  // "counts"
};

// A detector's estimate from the frames so far.
struct SlipEstimate {
  // s, of the newest frame used; -inf before the first, since a recording may begin at any time
  double time = -std::numeric_limits<double>::infinity();
  double latency = 0.0;  // s, from that frame until the estimate is available to the loop
  // no_contact: nothing touches, or too little seen to decide
  PadState state = PadState::no_contact;
  // share of the touching units that stick, 0 to 1; NaN: not estimated
  double stuck_fraction = std::numeric_limits<double>::quiet_NaN();
  // one value per Detector::features(), in that order; NaN: unknown yet
  std::vector<double> features{};
};

// The source of a detector's frames.
struct FrameSource {
  std::string sensor;             // the scene's name for it: "pad"
  std::string type;               // "papillarray"
  double rate = 0.0;              // Hz, of the frames
  std::vector<Channel> channels;  // what a frame holds
  std::uint64_t trial = 0;        // of the dataset
  // s, of the trial
  double duration = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 0;               // of the dataset
  std::vector<SensorSource> sensors{};  // all of the scene in its order, this one included
  // Relative tolerance within which a duration counts as a whole number of frames: the rounding of
  // decimals, or the clock error of a recording.
  double rate_rounding = 1e-9;
  // s, stamps of all frames of a recording that are not evenly spaced; empty: they are.
  std::span<const double> uneven_times{};
  // The user accepts estimates of interpolated frames, at a rate below the detector's and in gaps of
  // any length.
  bool interpolate = false;
};

// Name of the detector in a scene that stands for the truth
// (tools/registry/program_catalogues.h). Texts for users call it the oracle.
inline constexpr std::string_view oracle_type = "truth";

class Detector {
 public:
  virtual ~Detector() = default;

  // Takes the next frame of its sensor, in order of time, at the sensor's own rate. The result is
  // valid until the next update().
  virtual const SlipEstimate& update(const SensorFrame& frame) = 0;
  // Returns the entries of SlipEstimate::features from the first update() on; they never change.
  // Empty: the detector has none. Before the first estimate a listener sees no features.
  [[nodiscard]] virtual const std::vector<Feature>& features() const {
    static const std::vector<Feature> none;
    return none;
  }
  // Returns the part of the detector that receives the samples of all sensors, before the update()
  // of the same instant. Null (the usual case): no part does.
  [[nodiscard]] virtual SampleListener* listener() { return nullptr; }
  // Returns one sentence for the user if the detector reads other frames than its sensor's, such as
  // resampled ones, or has a threshold for another sensor; empty: neither. Never changes.
  [[nodiscard]] virtual std::string notice() const { return {}; }
  // Called once after the last update(). Throws InputError if the detector's backend fails as it
  // ends.
  virtual void finish() {}
};

}  // namespace slipbench
