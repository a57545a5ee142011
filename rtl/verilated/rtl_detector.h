// The register-level core as a detector: what detectors/hd/hd_detector.h does in software, with the core's own latency.
#pragma once

#include <cstdint>
#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry gst_hd_rtl_entry();

// As gst_hd, through the whole core, displacements in Q13.3 included. An estimate's latency is the core's cycles for that frame over
// `clock`, or zero. The waveform begins with the first classified frame at or after `waveform_from` and ends with the last at or before
// `waveform_to`, in the trial `waveform_trial` alone. Throws SceneValueError where gst_hd does, for a model that the core is not built
// for, for a clock below core_interval() cycles a classified frame, and for a waveform that has no frame, has no folder or would
// replace a file that is none.
std::unique_ptr<Detector> make_gst_hd_rtl(const Parameters& parameters, const FrameSource& source);

// Throws SceneValueError for a waveform of a trial that is not among the first `trials`, at least one.
void check_waveform_trial(const Parameters& parameters, std::uint64_t trials);

}  // namespace slipbench
