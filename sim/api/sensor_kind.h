// A sensor's entry in the catalogue.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// Presentation of a sensor's output in pages and tables. The sensor declares it, so that no page
// has code for a particular sensor.

// A spectrogram of a channel with one value, or of the difference between a channel's two values.
struct SpectrumView {
  std::string title;  // title of the spectrogram: "FL, north minus south"
  double window;      // s
  double hop;         // s, between windows
  double top;         // Hz, of the highest bin
};

// The texts for a channel, besides its key.
struct ChannelView {
  std::string channel;    // key: "fl"
  std::string name;       // "FL: clusters N and S"
  std::string note = {};  // rest of the sentence, may be empty
  // Title of a table column with the channel's first value minus its second, "FL"; empty: no
  // column.
  std::string difference = {};
  std::optional<SpectrumView> spectrum = {};
  std::string unit =
      {};              // physical unit, if no parameter of the sensor changes it; "N" of force and "m" of displacement are known
  bool image = false;  // one value for each unit, which viewers show as a picture
};

// A channel drawn behind the units as square cells, darker where values differ more from their
// values at rest.
struct PadPicture {
  std::string channel;
  // Units around each cell's centre; empty: one cell on each unit. Four values per cell are drawn
  // as triangles: W, N, E, S.
  std::vector<std::vector<std::size_t>> cells = {};
  double width = 1.0;               // of a cell, in distances between neighbouring units
  std::optional<double> rest = {};  // value without load; empty: each cell's first value
  bool falls = false;               // load lowers the values
  std::string note = {};            // sentence beside the picture
};

// The default suits any sensor whose channels have one row per unit.
struct SensorView {
  std::string unit = "unit", units = "units";  // name of a unit, singular and plural
  std::string letter = "U";                    // before a unit's number
  std::size_t first = 0;                       // number of the first unit
  // True: the pad is drawn as seen through the sensor, X to the right and Y up. False: as seen from
  // the surface that it touches, Y to the right and X up.
  bool from_behind = false;
  std::string orientation = {};  // for a pad from behind: "so that east is right and north is up"
  // channels that have more texts than their key
  std::vector<ChannelView> channels = {};
  std::optional<PadPicture> picture = {};

  // Returns the texts for a channel; by default its key is its name.
  [[nodiscard]] ChannelView channel_view(const std::string& channel) const {
    const auto found = std::ranges::find(channels, channel, &ChannelView::channel);
    return found == channels.end() ? ChannelView{.channel = channel, .name = channel} : *found;
  }
};

class Sensor;

// A device's disturbances of the readings of one unit, before the factors `scale` of its electronics.
// Its channels are force, then displacement, with x, y and z of each unit.
struct UnitDisturbance {
  std::array<double, 3> gain_sd;   // standard deviation of the gains along x, y, z about 1
  std::array<double, 6> noise_sd;  // of the force [N], then of the displacement [m], along x, y, z
};

// A sensor. The defaults are right for a sensor without the property.
struct SensorKind {
  Entry about;
  std::vector<Entry> electronics;  // available parts
  // Makes the sensor. `parameters`: all parameters that `about` declares. `electronics`: applied in
  // this order; empty: ideal. The random streams are keyed by the `seed` of the dataset, `trial`
  // and `sensor_name`, the scene's name for the sensor. Throws InputError for parameters that the
  // sensor refuses.
  std::unique_ptr<Sensor> (*create)(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                                    std::uint64_t trial, const std::string& sensor_name) = nullptr;
  SensorView view = {};
  // Third-party libraries that compute it, such as "FFTW": its results may differ between processors.
  std::vector<std::string> libraries = {};
  bool users_code = false;  // its code is not part of slipbench
  // Returns the disturbances of a unit of this stiffness [N/m] at this rate [Hz], so that calibration can find
  // the factors of the parts coupling, gain and noise. Null: the sensor lacks these parts.
  UnitDisturbance (*disturbance)(double k_normal, double k_tangential, double rate) = nullptr;
};

}  // namespace slipbench
