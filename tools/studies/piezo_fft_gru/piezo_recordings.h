// Recordings of the piezoelectric skin's bench as networks learn from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/base/dataset/trial_record.h"
#include "tools/program/learn/frames.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

inline constexpr const char* piezo_bench_scene = "scenes/piezo_skin/dataset.yaml";

// Refuses a number of recordings a level that is odd or below `least`, in words that end with why it has to be that.
void check_recordings(std::size_t recordings, std::size_t least, const std::string& why);

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

// Runs the published bench, scenes/piezo_skin/dataset.yaml, at each level: `recordings` of them, half with a slip and half of
// motors alone. Throws InputError, Interrupted.
std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const ReproduceOptions& options);

// The same from a dataset, whose levels are those that it swept. Throws InputError.
std::vector<PiezoRecording> read_recordings(const std::string& path);

// What a recording is for those above. Throws InputError when no sensor is a piezo_skin.
PiezoRecording make_recording(const TrialRecord& record);

// A recording as bytes, and back, for a child process to hand over.
void pack(const PiezoRecording& recording, std::string& bytes);
std::vector<PiezoRecording> unpack(const std::string& bytes);

}  // namespace slipbench::reproduce
