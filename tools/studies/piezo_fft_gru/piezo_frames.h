// Frames of the piezoelectric skin's signal: how loud each is, and what happens within it.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/roc.h"

namespace slipbench::reproduce {

// How a frame of 20 ms becomes a spectrum. Its mean is taken off first.
enum class FrameSpectrum {
  plain,      // as the paper says: "FFT on the mean-subtracted signal", no taper named
  detrended,  // its straight line of least squares is taken off, too
  hann,       // tapered by Hann's window
};
inline constexpr std::size_t frame_spectra = 3;

// Of the samples of a frame. Slip is that a part of the contact slips (rule micro).
struct SkinFrame {
  std::array<double, frame_spectra> power{};  // counts^2 within 50 to 600 Hz, by FrameSpectrum
  bool contact = false;                       // at its last sample, as the next three
  bool slips = false;
  bool slips_by_position = false;  // by the paper's label, the 100 Hz position
  bool at_speed = false;           // the bench slides at nine tenths of its speed or more
  bool one_label = false;          // all samples are alike: no contact, hold, or slip
  bool slipped = false;            // at any sample
  bool pressed = false;            // the bench moves along the normal at any sample
  bool slid = false;               // the bench moves along the surface at any sample
  double still = 0.0;              // s, from the last motion of the bench to the end; infinite: it has not moved
};

struct SkinRecording {
  double force = 0.0;  // N, k_normal times compression
  double speed = 0.0;  // m/s, of the slide
  std::vector<SkinFrame> frames;
};

// The frames of 20 ms every 10 ms of a scene's recording, whose one sensor is a piezo_skin at 10 kHz on a stage.
SkinRecording skin_recording(const Scene& scene, const TrialRecord& record);

// Slip told from hold by the loudness of one frame of the piezoelectric skin: areas under the curve, and frames that are mistaken.
inline constexpr double settling_time = 3.0 / (2.0 * std::numbers::pi * 3.0);  // s, three time constants of the amplifier's 3 Hz

using SkinRecordings = std::vector<SkinRecording>;

// What makes slip and hold of a frame, and its loudness.
struct FrameReading {
  std::string name, text;
  FrameSpectrum spectrum = FrameSpectrum::plain;
  bool by_position = false, one_label = false;

  [[nodiscard]] bool slips(const SkinFrame& frame) const { return by_position ? frame.slips_by_position : frame.slips; }
  [[nodiscard]] bool counts(const SkinFrame& frame) const { return frame.one_label || !one_label; }
};
// The paper's spectrum first, then the others by FrameSpectrum, then other labels.
const std::vector<FrameReading>& frame_readings();

// Slip against all hold, hold in contact alone, and hold in the air alone. Empty: there are no frames of one kind.
struct Separations {
  std::optional<Auc> pooled, contact, air;
};
Separations separations(const SkinRecordings& recordings, const FrameReading& reading);

// Frames of a kind. Of a list of causes a frame has the first that fits.
struct FrameCause {
  std::string name, text;
  std::function<bool(const SkinRecording&, const SkinFrame&)> fits;
};
const std::vector<FrameCause>& hold_causes();
const std::vector<FrameCause>& slip_causes();

// The frames in contact that have a cause, against all frames in contact of the other class. By FrameSpectrum: the area, and what
// they add to what the area of all causes lacks of 1, as a share of it: an area is a mean over frames, so that the shares sum up
// to 1.
struct CauseFigures {
  std::size_t frames = 0;
  double share = 0.0;  // of the frames of all causes
  double rms = 0.0;    // counts, median, by the plain spectrum; NaN of none
  std::array<std::optional<Auc>, frame_spectra> area;
  std::array<double, frame_spectra> share_of_missing{};
};
// Of each cause, in their order; `of_slip`: causes of slip, else of hold.
std::vector<CauseFigures> figures_of(const SkinRecordings& recordings, const std::vector<FrameCause>& causes, bool of_slip);

}  // namespace slipbench::reproduce
