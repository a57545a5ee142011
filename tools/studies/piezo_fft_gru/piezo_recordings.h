// Recordings of the piezoelectric skin's bench as networks learn from them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "detectors/network/description.h"
#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/workers/child_process.h"
#include "tools/program/train/network/examples.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

inline constexpr const char* piezo_bench_scene = "scenes/piezo_skin/dataset.yaml";

// Refuses a number of recordings a level that is odd or below `least`, in words that end with why it has to be that.
void check_recordings(std::size_t recordings, std::size_t least, const std::string& why);

// The frames of a recording, and what each is by either label.
struct PiezoFrames {
  std::vector<float> features;             // [T, F]
  std::vector<std::uint8_t> truth, paper;  // [T] 1: slip

  [[nodiscard]] train::FrameSequence by(train::LabelRule rule) const {
    return {features, rule == train::LabelRule::micro ? truth : paper};
  }
};

// A recording, its signal already turned into frames.
struct PiezoRecording {
  double level = 0.0;                                            // of the motors' vibration; NaN: the dataset does not say
  std::string tip;                                               // what was swept but the motion; equal texts are equal tips
  bool motors_only = true;                                       // nothing ever touches
  double slip_time = std::numeric_limits<double>::quiet_NaN();   // s, the true first slip of a part; NaN: none
  double label_time = std::numeric_limits<double>::quiet_NaN();  // s, the first sample that slips by the position; NaN: none
  std::vector<PiezoFrames> inputs;                               // of each kind that was asked for
  // Of the frames of the first kind, [T]: what no network is shown.
  std::vector<double> time;           // s, of the last sample
  std::vector<std::uint8_t> contact;  // 1: something touches then
  std::vector<float> motors;          // m/s, the sum of the speeds of all axes whose motors run then
};

// What the tables' networks eat: the published band, the whole spectrum cut to a band [Hz], the signal at 100 Hz.
network::Input published_spectra();
network::Input spectra_of(double low, double high);
network::Input signal_at_100_hz();

// Which motors run: in half of the scene's recordings one that does not move the tip, or in none.
enum class Motors { others_too, of_the_tip };

// Runs the published bench, scenes/piezo_skin/dataset.yaml, at each level: `recordings` of them, half with a slip and half of
// motors alone. Throws InputError, Interrupted.
std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const std::vector<network::Input>& inputs, const ReproduceOptions& options,
                                           Motors motors = Motors::others_too);

// The same from a dataset, whose levels are those that it swept. Throws InputError.
std::vector<PiezoRecording> read_recordings(const std::string& path, const std::vector<network::Input>& inputs);

// What a recording is for those above. Throws InputError when no sensor is a piezo_skin.
PiezoRecording make_recording(const TrialRecord& record, const std::vector<network::Input>& inputs);

// What a shortcut is told of each frame.
struct Told {
  bool time = false, contact = false, motors = false, kind = false;  // kind: whether the recording is of motors alone

  [[nodiscard]] std::size_t values() const {
    return std::size_t{time} + std::size_t{contact} + std::size_t{motors} + std::size_t{kind};
  }
};
// [T, told.values()]
std::vector<float> told_features(const PiezoRecording& recording, const Told& told);

// A recording as bytes, and back, for a child process to hand over.
void pack(const PiezoRecording& recording, Packed& bytes);
std::vector<PiezoRecording> unpack(Packed bytes);

// Frames of the piezoelectric skin's signal: how loud each is, and what happens within it.

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
