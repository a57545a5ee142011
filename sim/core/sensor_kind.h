// A sensor as the catalogue has it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// How pages and tables show what a sensor emits. The sensor says it, so that no page knows a sensor by its name.

// A spectrogram of a channel of one value, or of the difference of a channel's two.
struct SpectrumView {
  std::string of;  // what it is a spectrogram of: "FL, north minus south"
  double window;   // s
  double hop;      // s, from window to window
  double top;      // Hz, of the highest bin
};

// What a channel is called beside its key.
struct ChannelView {
  std::string channel;          // key: "fl"
  std::string name;             // "FL: clusters N and S"
  std::string note = {};        // the rest of the sentence, may be empty
  std::string difference = {};  // column of a table with the channel's first value less its second: "FL"; empty: none
  std::optional<SpectrumView> spectrum = {};
};

// A channel drawn behind the units: square cells, darker where values differ more from those at rest.
struct PadPicture {
  std::string channel;
  // Units around each cell's middle; empty: a cell on each unit. Four values a cell are drawn as triangles: W, N, E, S.
  std::vector<std::vector<std::size_t>> cells = {};
  double width = 1.0;               // of a cell, in distances between neighbouring units
  std::optional<double> rest = {};  // what values read without load; empty: what each reads first
  bool falls = false;               // load lowers the values
  std::string note = {};            // sentence beside the picture
};

// The default shows any sensor whose channels have a row a unit.
struct SensorView {
  std::string unit = "unit", units = "units";  // what a unit is called, one and several
  std::string letter = "U";                    // before a unit's number
  std::size_t first = 0;                       // number of the first unit
  // The pad is drawn as seen through the sensor, X to the right and Y up; else from the surface that it touches, Y to the right
  // and X up.
  bool from_behind = false;
  std::string orientation = {};            // of a pad from behind: "so that east is right and north is up"
  std::vector<ChannelView> channels = {};  // those that have more to show than their key
  std::optional<PadPicture> picture = {};

  // What is said of a channel; its key where nothing is.
  [[nodiscard]] ChannelView of(const std::string& channel) const {
    const auto found = std::ranges::find(channels, channel, &ChannelView::channel);
    return found == channels.end() ? ChannelView{.channel = channel, .name = channel} : *found;
  }
};

class Sensor;

struct SensorKind {
  Entry about;
  std::vector<Entry> electronics;  // the parts that it has
  // `parameters`: those of `about`, all present. `electronics`: applied in this order; empty: ideal. `seed` of the dataset and
  // `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor. Throws InputError for what the
  // sensor refuses.
  std::unique_ptr<Sensor> (*create)(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                                    std::uint64_t trial, const std::string& sensor_name);
  SensorView view = {};
};

}  // namespace slipbench
