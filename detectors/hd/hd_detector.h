// The hyperdimensional classifier as a detector, on any engine: frames of a PapillArray at the sensor's own rate in, states of the pad out.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "detectors/hd/memory_files.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench::hd {

// What one classified frame comes to.
struct Classified {
  PadState state = PadState::no_contact;
  double latency = 0.0;  // s, that the engine took for it
};
// Classifies the displacements [9][3] in m of one frame, in C order. Called once a classified frame, in order of time.
using Classify = std::function<Classified(std::span<const float> displacement)>;

// memories, rate, quantiser, compat, ties.
std::vector<ParameterSpec> detector_parameters();

// The classifier that these parameters name: its folder, with what they say differently. Throws SceneValueError where load() or
// shipped_memories() refuse it.
SavedModel detector_model(const Parameters& parameters);

// Frames of the source from one that is classified to the next: its rate over `rate` [Hz]. Throws SceneValueError where that is no
// whole number.
std::size_t stride_of(double rate, const FrameSource& source);

// Takes every k-th frame, the first one included, with k = stride_of(rate, source); the frames between leave the estimate as it is.
// (The paper downsamples 1000 Hz recordings to 100 Hz and does not say how; its hardware reads the sensor at 100 Hz, which is this.)
// The state is no_contact until the engine has seen its window. From then on it is the nearest of three classes, also while nothing
// touches: the classifier has no class for that, and sees nine displacements of zero. `alarm` says how many frames in a row have to be
// slip until that is said: non_slip before, and the last class of slip as long as an alarm outlasts it.
// Throws SceneValueError where stride_of() does and where the source is no PapillArray.
std::unique_ptr<Detector> make_detector(Classify classify, double rate, const network::Alarm& alarm, const FrameSource& source);

}  // namespace slipbench::hd
