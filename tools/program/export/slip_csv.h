// The layout of the public slip recordings of a BioTac SP (yayaneath/BioTacSP-DoS): a folder a class, a file a recording.
#pragma once

#include <string>
#include <string_view>

#include "tools/base/dataset/reader.h"

namespace slipbench {

struct SlipRecording {
  std::string name;  // "n/acrylic12.csv": class, object and trial
  std::string text;  // header ff_e1,...,ff_e24, then a row of counts every 10 ms
};

// The class is the motion that the scene commands, by where the object goes as the finger sees it: n towards its root (the pad goes along its
// X axis), s towards its tip, e to its right as seen from the root with the skin down (the pad goes along Y), w to its left; cw where the pad
// turns the positive way about the normal (the object clockwise then, seen from the finger), aw the other way, t where it does neither.
// The object is the surface's material, and its shape where that is no plane. The published recordings are cut inside the motion: those of
// `rub` begin where it has come up to its speed, all others with the trial.
// `sensor` names a biotac_sp of 100 Hz. Throws InputError where it is none, or where the motion is none of these.
SlipRecording slip_csv(const DatasetReader& reader, std::size_t trial, const std::string& sensor);

bool begins_as_slip_csv(std::string_view text);

}  // namespace slipbench
