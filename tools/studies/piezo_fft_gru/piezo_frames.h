// Frames of the piezoelectric skin's signal: how loud each is, and what happens within it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

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

}  // namespace slipbench::reproduce
