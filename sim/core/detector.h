// A detector: from a sensor's frames to an estimate of slip. Its signature keeps the truth out: neither this header nor a
// detector may include sim/core/contact_frame.h or sim/core/sensor.h, which tests/style checks.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/pad_state.h"
#include "sim/core/sensor_frame.h"

namespace slipbench {

// A number that a detector works with and hands on, beside the class that it says: a magnitude in a band, a force that it has
// calibrated.
struct Feature {
  std::string name;  // "fr_0_6"
  std::string unit;  // "counts"
};

// What a detector makes of the frames so far.
struct SlipEstimate {
  double time = 0.0;                      // s, of the frame it was made from
  double latency = 0.0;                   // s, from that frame until the estimate is there; the loop sees it no earlier
  PadState state = PadState::no_contact;  // no_contact: nothing touches, or the detector has seen too little to say
  double stuck_fraction = std::numeric_limits<double>::quiet_NaN();  // touching units that stick, 0 to 1; NaN: not estimated
  std::vector<double> features{};  // one value for each of Detector::features(), in that order; NaN: not known yet
};

// Whose frames a detector gets.
struct FrameSource {
  std::string sensor;                                         // the scene's name for it: "pad"
  std::string type;                                           // "papillarray"
  double rate = 0.0;                                          // Hz, of the frames
  std::vector<Channel> channels;                              // what a frame holds
  std::uint64_t trial = 0;                                    // of the dataset
  double duration = std::numeric_limits<double>::infinity();  // s, of the trial
  std::uint64_t seed = 0;                                     // of the dataset
  std::vector<SensorSource> sensors{};                        // all of the scene in its order, this one among them
  // Share by which lengths in frames may miss a whole number: the rounding of decimals; of a recording what its clock is off.
  double rate_rounding = 1e-9;
};

// What a scene names as its detector to get the truth in a detector's place (tools/program/catalogue/program_catalogues.h). Wherever a person
// reads, it is called an oracle.
inline constexpr std::string_view oracle_type = "truth";

class Detector {
 public:
  virtual ~Detector() = default;

  // Takes the next frame of its sensor, in order of time, at the sensor's own rate. Valid until the next update().
  virtual const SlipEstimate& update(const SensorFrame& frame) = 0;
  // What SlipEstimate::features holds from the first update() on; the same as long as the detector lives. Empty: it hands on
  // none. Before that first estimate whoever listens sees none at all.
  [[nodiscard]] virtual const std::vector<Feature>& features() const {
    static const std::vector<Feature> none;
    return none;
  }
  // Who has to be handed the samples of all sensors, before the update() of the same instant; the detector's own part. Null,
  // which most say: nobody.
  [[nodiscard]] virtual SampleListener* listener() { return nullptr; }
  // Once after the last update(). Throws InputError where what stands behind the detector fails as it ends.
  virtual void finish() {}
};

}  // namespace slipbench
