// Images of a Myrmex array in the layouts of its public tools and of its paper's training.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// One line per image, without a header: counts from 0 to 4095, rounded, column by column. A reader
// that expects rows (the public tools) thus sees the image transposed, as the hardware sends it.
// Throws InputError if the sensor is not a myrmex or a value is not a count.
std::string myrmex_csv(const SensorRecord& sensor);
// True if a file that begins with `text` is such a file: the first line holds at least two whole
// numbers up to 4095 and nothing else. A file of a single taxel cannot be distinguished from other
// files, and so is not overwritten.
bool begins_as_myrmex_csv(std::string_view text);

// The paper's augmentation (section 4): the image turned by 0 to 330 degrees in steps of 30, its
// innermost 12 x 12 taxels.
inline constexpr std::size_t rotations = 12;
inline constexpr std::size_t cropped = 12;
// Turns one image of `rows` x `columns` taxels, at least 12 x 12, anticlockwise by `turn` * 30
// degrees about its middle and crops it to [12 x 12]. Bilinear interpolation; points beyond the
// outermost taxels take their counts (for 16 x 16 up to 0.013 taxels, at 30 degrees off an axis).
// Turns by 90 degrees are exact.
void turn_image(std::span<const float> image, std::size_t rows, std::size_t columns, std::size_t turn,
                std::span<float, cropped * cropped> out);

// Returns the trial with `taxels` [T,12,12,12] (sample, turn, row, column) instead of the images
// of every myrmex that is large enough, without value names. Throws InputError if there is no such
// sensor.
TrialRecord turned_images(TrialRecord record);

}  // namespace slipbench
