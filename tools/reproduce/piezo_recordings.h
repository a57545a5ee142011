// Recordings of the piezoelectric skin's bench as networks learn from them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/learn/frames.h"
#include "tools/reproduce/catalogue.h"

namespace slipbench::reproduce {

// A recording, its signal already turned into frames.
struct PiezoRecording {
  double level = 0.0;                      // of the motors' vibration; NaN: the dataset does not say
  std::string tip;                         // what was swept but the motion; equal texts are equal tips
  bool motors_only = true;                 // nothing ever touches
  std::vector<float> features;             // [T,12] log_spectrogram
  std::vector<std::uint8_t> truth, paper;  // [T] 1: slip, by either label

  [[nodiscard]] learn::FrameSequence frames(learn::LabelRule rule) const {
    return {features, rule == learn::LabelRule::truth ? truth : paper};
  }
};

// Runs the published bench, scenes/piezo_skin/dataset.yaml, at each level: `recordings` of them, half with a slip and half of motors alone.
// Throws InputError, Interrupted.
std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const ReproduceOptions& options);

// The same from a dataset, whose levels are those that it swept. Throws InputError.
std::vector<PiezoRecording> read_recordings(const std::string& path);

// What a recording is for those above. `params`: JSON object of what was swept. Throws InputError when no sensor is a piezo_skin.
PiezoRecording make_recording(const TrialRecord& record, const std::string& params);

// A recording as bytes, and back, for a child process to hand over.
void pack(const PiezoRecording& recording, std::string& bytes);
std::vector<PiezoRecording> unpack(const std::string& bytes);

}  // namespace slipbench::reproduce
