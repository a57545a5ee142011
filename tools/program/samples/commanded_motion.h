// How a trial's pad was told to move.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// A corner pillar's distance from the centre [m]: where a PapillArray's rotation is given as a speed.
inline constexpr double corner_radius = 9.9e-3;

struct CommandedMotion {
  double speed = 0.0;        // m/s, motion.speed
  double rotation = 0.0;     // rad/s, motion.rotation
  double compression = 0.0;  // m, motion.compression
};

// Takes the values from what was swept, else from the overrides and the scene that the dataset carries, else the motion's defaults.
// Throws InputError when the scene cannot be read or its motion has no such values.
CommandedMotion commanded_motion(const DatasetReader& reader, std::size_t trial);

// One number of the motion, taken from there; empty: this kind of motion has none of that name. Throws InputError as commanded_motion().
std::optional<double> commanded_number(const DatasetReader& reader, std::size_t trial, const std::string& name);

// A word of the scene, such as that at "surface.material", as it was swept or written; "" where it is neither. Throws InputError where the scene
// cannot be read.
std::string commanded_word(const DatasetReader& reader, std::size_t trial, const std::string& path);

}  // namespace slipbench
