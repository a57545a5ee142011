// Replays a detector's loop on the samples of a dataset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "detectors/network/engine.h"
#include "sim/api/detector.h"
#include "sim/api/pad_state.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::eval {

// Feature with the probability of slip, 0 to 1, if a detector has one.
inline constexpr const char* probability_feature = "slip_probability";
// Feature with the number of the most probable class, for a network with more than two.
inline constexpr const char* class_feature = "class";

// One row per sample of the sensor, [T] each.
struct Replayed {
  std::vector<PadState> seen;          // state seen at the sample: an estimate is seen once its latency is over
  std::vector<double> seen_since;      // s, time at which that estimate was available; -inf before the first
  std::vector<double> stuck_fraction;  // of that estimate; NaN: none
  std::vector<double>
      probability;            // of slip, in the first row that sees an estimate; NaN elsewhere, and if the detector has none
  std::vector<double> named;  // number of the class, likewise
  std::string notice;         // Detector::notice(); recorded_trial() adds to it
};

// Feeds a trial's samples to a detector made for it (make_detector), as the loop does: all channels
// of its sensor in their order, a slow channel held between its rows, the samples of every sensor
// first to Detector::listener(), and finish() at the end. The value of a slow channel before its
// first row is not recorded: the first row replaces it. `sensors` are in the scene's order; the
// detector reads number `sensor`. `seed` and `trial` are the dataset's. The trial lasts until its
// last sample. Throws InputError as make_detector() and the detector do, for a sensor without
// samples, for an invalid probability, and for samples that are not evenly_spaced() if the detector
// has FrameSpacing::even. The clock of a recording may be off by rate_tolerance. `interpolate`: as in
// FrameSource.
Replayed replay(const DetectorScene& detector, std::span<const SensorRecord> sensors, std::size_t sensor, std::uint64_t seed,
                std::uint64_t trial, bool interpolate = false);
// As above with a detector made for that sensor.
Replayed replay(std::unique_ptr<Detector> detector, std::span<const SensorRecord> sensors, std::size_t sensor);

// Selects the detector of a command line. `text`: a detector's name from the catalogue; else
// FILE.onnx, a network; else, for gst_hd, a folder of memories that `slipbench train` wrote, or the
// name of memories that ship with the program. `parameters`: by name, as in a scene; paths are
// relative to the working folder. Parsing and messages are those of a scene (sim/scene): unknown
// names are reported with the nearest known one. Throws InputError.
DetectorScene chosen_detector(const std::string& text, const std::vector<Override>& parameters);

// The network of such a detector, for its description; nullptr for other detectors. Throws
// InputError if no file is named, and as network::load_engine() does.
std::unique_ptr<network::Engine> network_of(const DetectorScene& detector);

}  // namespace slipbench::eval
