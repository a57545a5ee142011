// The detectors that a scene may name: what describes each, and what makes it.
#pragma once

#include <cstdint>
#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

struct DetectorKind {
  Entry about;
  // `parameters`: those of `about`, all present. Throws SceneValueError at detector.sensor where the sensor has not the channels that are read,
  // z into the sensor, and at detector.window where that is no whole number of frames.
  std::unique_ptr<Detector> (*create)(const Parameters& parameters, const FrameSource& source);
  void (*check_run)(const Parameters& parameters, std::uint64_t trials) = nullptr;  // none: it asks nothing of the run
  bool counts_frames = true;  // takes frames as evenly spaced; false: an estimate is of one frame, whenever that comes
};

// What makes a detector that takes parameters and source as they are.
template <class Made>
std::unique_ptr<Detector> created(const Parameters& parameters, const FrameSource& source) {
  return std::make_unique<Made>(parameters, source);
}

// An estimate a frame, without latency, without training.
DetectorKind force_ratio_detector();  // of the channel "force" {N,3} [N]: Coulomb's law read backwards
DetectorKind
stuck_fraction_detector();  // and "displacement" {N,3} [m]: which pillars stick, by the speeds of their tips; the stuck fraction, too
DetectorKind
shear_rate_detector();  // of "force": a unit slips when its shear no longer grows with the load; the stuck fraction, too

// An estimate a frame of a gel, of "displacement" {N,3} [m] and "pixel" {N,2}: how unequally the markers under the object move.
DetectorKind marker_deviation_detector();  // from a rigid motion
DetectorKind marker_entropy_detector();    // entropy of the distances

// An estimate a frame; it changes when a window is complete. The power of the channel "signal" {1} in a band of frequencies: a threshold with
// hysteresis, without training. Refuses a band without a bin of the window's spectrum.
DetectorKind band_energy_detector();

// An estimate a frame of a nib pad (detectors/nib/features.h), without latency; they hand on the features of nib::handed_on().
DetectorKind nib_linear_slip_detector();  // no_contact, non_slip, and gross from the detection on until the pad touches nothing
DetectorKind nib_slip_kind_detector();    // no_contact, non_slip, gross; `kind` is handed on, too

// The software kernel of detectors/hd, without latency.
DetectorKind gst_hd_detector();

// As gst_hd, through the whole core of rtl/hd, displacements in Q13.3 included. An estimate's latency is the core's cycles for that frame over
// `clock`, or zero. The waveform begins with the first classified frame at or after `waveform_from` and ends with the last at or before
// `waveform_to`, in the trial `waveform_trial` alone. Throws SceneValueError where gst_hd does, for a model that the core is not built
// for, for a clock below core_interval() cycles a classified frame, and for a waveform that has no frame, has no folder or would
// replace a file that is none; check_run() for a waveform of a trial that is not among the first `trials`, at least one.
DetectorKind gst_hd_rtl_detector();

// What the parameter `model` of `network` says where no network is named.
inline constexpr const char* no_network = "none";

// A neural network from an ONNX file. An estimate a sample; it changes when a frame is complete, and says no_contact before the network has been
// fed for the first time. Feature "slip_probability". Throws SceneValueError at detector.model for a file that is no such network
// (network::load_engine) and one that reads another sensor. update() throws InputError where the network says no number.
DetectorKind network_detector();

// One's own, from a shared library: detectors/plugin_abi.h. `source.sensors` must hold all sensors of the scene. Throws
// SceneValueError at detector.library for a library that is not one (PluginLibrary), that makes no detector for this scene, or
// whose rate is not that of the sensor over a whole number, and at detector.parameters.<name> for a value that the library does
// not take. update() and finish() throw SceneValueError where the library crashes, throws or says what no estimate is.
DetectorKind plugin_detector();

}  // namespace slipbench
