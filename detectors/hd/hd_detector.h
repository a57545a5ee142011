// The hyperdimensional classifier as a detector, on any engine. It takes frames of a PapillArray at
// the sensor's rate and returns states of the pad.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "detectors/hd/memory_files.h"
#include "sim/api/detector.h"
#include "sim/core/parameters.h"

namespace slipbench::hd {

// Result for one classified frame.
struct Classified {
  PadState state = PadState::no_contact;
  double latency = 0.0;  // s, that the engine took for the frame
};
// Classifies the displacements [9][3] in m of one frame, in C order. Called once per classified
// frame, in order of time.
using Classify = std::function<Classified(std::span<const float> displacement)>;

// Parameters: memories, rate, quantiser, compat, ties.
std::vector<ParameterSpec> detector_parameters();

// Returns the classifier named by the parameters: its folder, with the settings that they override.
// Throws SceneValueError if load() or shipped_memories() fails.
SavedModel detector_model(const Parameters& parameters);

// Returns the number of source frames per classified frame: the source's rate over `rate` [Hz].
// Throws SceneValueError if that is not a whole number.
std::size_t stride_of(double rate, const FrameSource& source);

// Classifies every k-th frame, starting with the first, with k = stride_of(rate, source); frames
// between them do not change the estimate. (The paper downsamples 1000 Hz recordings to 100 Hz
// without saying how; its hardware reads the sensor at 100 Hz, as here.) The state is no_contact
// until the engine has seen a whole window, then the nearest of three classes. This also holds
// without contact, because the classifier has no class for it and sees nine displacements of zero.
// `alarm` sets how many consecutive frames must be slip before the detector reports slip: non_slip
// until then, and the last class of slip while an alarm outlasts the frames of slip. Throws
// SceneValueError as stride_of() does, and if the source is not a PapillArray.
std::unique_ptr<Detector> make_detector(Classify classify, double rate, const network::Alarm& alarm, const FrameSource& source);

}  // namespace slipbench::hd
