// Descriptions and factories of the detectors that a scene can name.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/api/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Spacing of frames that a detector can read.
enum class FrameSpacing {
  any,     // each estimate depends on one frame alone
  evened,  // counts frames; those of a recording with jitter and gaps are resampled first (resampling.h)
  own,     // resamples them itself, to the rate that it reads
  even,    // counts frames as they are, and refuses others
};

// The file or folder with which a detector computes.
struct DetectorFile {
  enum class Content { network, memories, library };

  const char* parameter;  // path of the file
  Content content;
  bool is_required = false;  // slipbench contains no such file that the detector reads by default

  [[nodiscard]] bool is_trained() const { return content != Content::library; }
};

// A detector. The defaults are right for a detector without the property.
struct DetectorKind {
  Entry about;
  // `parameters`: all parameters that `about` declares. Throws SceneValueError at detector.sensor
  // if the sensor lacks the channels that the detector reads (z into the sensor), and at
  // detector.window if it is not a whole number of frames.
  std::unique_ptr<Detector> (*create)(const Parameters& parameters, const FrameSource& source);
  void (*check_run)(const Parameters& parameters, std::uint64_t trials) = nullptr;  // null: no requirements
  FrameSpacing spacing = FrameSpacing::even;
  // Third-party libraries that compute it, such as "FFTW": its results may differ between processors.
  std::vector<std::string> libraries = {};
  bool users_code = false;  // its code is not part of slipbench
  bool yardstick = false;   // a rule of one line, against which `eval` compares detectors
  std::optional<DetectorFile> file = {};
};

// Makes a detector from its parameters and source.
template <class Made>
std::unique_ptr<Detector> created(const Parameters& parameters, const FrameSource& source) {
  return std::make_unique<Made>(parameters, source);
}

// One estimate per frame, without latency or training.
DetectorKind force_ratio_detector();  // channel "force" {N,3} [N]; Coulomb's law inverted
DetectorKind shear_rate_detector();   // channel "force": a unit slips once its shear stops growing with load; stuck fraction

// One estimate per frame of a gel, from "displacement" {N,3} [m] and "pixel" {N,2}: how unequally
// the markers under the object move.
DetectorKind marker_deviation_detector();  // deviation from a rigid motion
DetectorKind marker_entropy_detector();    // entropy of the distances moved

// One estimate per frame, updated when a window is complete: power of the channel "signal" {1} in a
// frequency band, with threshold and hysteresis, without training. Refuses a band without a bin of
// the window's spectrum.
DetectorKind band_energy_detector();

// Yardsticks (detectors/yardstick): one estimate per frame from the sensor's first channel over the
// latest 0.5 s, no_contact before; feature "slip_probability". Each throws SceneValueError at
// detector.sensor for a sensor without values or with more than 2 MHz.
DetectorKind deviation_detector();           // mean standard deviation of all values
DetectorKind relative_deviation_detector();  // standard deviation of the shear over the normal level
DetectorKind shear_ratio_detector();         // shear of the whole pad over its normal level; refuses values without axes
DetectorKind sum_change_detector();          // change of the sum of all values

// One estimate per frame of a nib pad (detectors/nib/features.h), without latency, with the
// features of nib::handed_on().
DetectorKind nib_linear_slip_detector();  // no_contact, non_slip, and gross from detection until contact ends
DetectorKind nib_slip_kind_detector();    // no_contact, non_slip, gross; also the feature `kind`

// The software kernel of detectors/hd, without latency.
DetectorKind gst_hd_detector();

// Like gst_hd, but through the whole core of rtl/hd, with displacements in Q13.3. The latency of an
// estimate is the core's cycles for its frame over `clock`, or zero. The waveform spans the first
// classified frame at or after `waveform_from` to the last at or before `waveform_to`, in the trial
// `waveform_trial` only. Throws SceneValueError where gst_hd does, for a model that the core is not
// built for, for a clock below core_interval() cycles per classified frame, and for a waveform
// without a frame, without a folder, or whose file would replace something other than a file.
// check_run() throws it for a waveform of a trial that is not among the first `trials` (at least
// one).
DetectorKind gst_hd_rtl_detector();

// Value of the parameter `model` of `network` if no network is named.
inline constexpr const char* no_network = "none";

// A neural network from an ONNX file. One estimate per sample, updated when a frame is
// complete; no_contact until the network has run once. Feature "slip_probability". Throws
// SceneValueError at detector.model for a file that is not such a network (network::load_engine) or
// reads another sensor. update() throws InputError if the network returns a value that is not a
// number.
DetectorKind network_detector();

// A custom detector from a shared library: detectors/plugin_abi.h. `source.sensors` must hold all
// sensors of the scene. Throws SceneValueError at detector.library for an invalid library
// (PluginLibrary), one that makes no detector for this scene, or one whose rate is not the sensor's
// over a whole number, and at detector.parameters.<name> for a value that the library rejects.
// update() and finish() throw SceneValueError if the library crashes, throws or returns an invalid
// estimate.
DetectorKind plugin_detector();

}  // namespace slipbench
