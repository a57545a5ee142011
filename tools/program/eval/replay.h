// What a detector would have seen in a loop, from the samples that a dataset holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "detectors/network/engine.h"
#include "sim/core/detector.h"
#include "sim/core/pad_state.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::eval {

// The feature that holds a probability of slip, 0 to 1, where a detector has one.
inline constexpr const char* probability_feature = "slip_probability";
// That which holds the number of the most probable class, where a network tells more than two.
inline constexpr const char* class_feature = "class";

// A row a sample of the sensor, [T] each.
struct Replayed {
  std::vector<PadState> seen;          // what is seen at the sample: an estimate is seen once its latency is over
  std::vector<double> seen_since;      // s, when the estimate that is seen was there; NaN before the first
  std::vector<double> stuck_fraction;  // of that estimate; NaN: not estimated
  std::vector<double>
      probability;            // of slip, in the first row that sees an estimate; NaN elsewhere, and where the detector has none
  std::vector<double> named;  // number of the class, likewise
};

// Feeds a trial's samples to a detector made for it (make_detector), as the loop does: all channels of its sensor in their order, those of a
// slow channel standing still between its rows, the samples of every sensor first to Detector::listener(), and finish() at the end. What a
// slow channel held before its first row is not recorded: that row takes its place. The scene's order of sensors is that of `sensors`, of
// which it reads number `sensor`. `seed` and `trial` are the dataset's. The trial lasts until its last sample.
// Throws InputError as make_detector() and the detector do, for a sensor without samples, for a probability that is none, and for samples that are not
// evenly_spaced() where the detector counts_frames(). The clock of a recording may be off by rate_tolerance.
Replayed replay(const DetectorScene& detector, std::span<const SensorRecord> sensors, std::size_t sensor, std::uint64_t seed,
                std::uint64_t trial);
// The same with a detector that was made for that sensor.
Replayed replay(std::unique_ptr<Detector> detector, std::span<const SensorRecord> sensors, std::size_t sensor);

// Which detector a command line means.
// `text`: a detector's name from the catalogue; else FILE.onnx, a network; else a folder of memories that `slipbench train` wrote, or the
// name of one that ships,
// for gst_hd. `parameters`: its parameters by name, as a scene writes them; paths are from the working folder. The same reader and messages as
// a scene's (sim/scene): unknown names with the nearest known one. Throws InputError.
DetectorScene chosen_detector(const std::string& text, const std::vector<Override>& parameters);

// The network that such a detector is, for what it says of itself; nullptr: it is none. Throws InputError: no file is named, or what
// network::load_engine() refuses.
std::unique_ptr<network::Engine> network_of(const DetectorScene& detector);

}  // namespace slipbench::eval
