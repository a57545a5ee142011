// Images of a Myrmex array as its public tools and its paper's training read them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "tools/base/record/trial_record.h"

namespace slipbench {

// A line an image, without a header: its counts, 0 to 4095, rounded, column by column, so that what reads it row by row (the public tools) sees
// the image transposed, as the hardware sends it. Throws InputError when the sensor is no myrmex or a value is no count.
std::string myrmex_csv(const SensorRecord& sensor);
// Whether a file that begins so is one: a first line of at least two whole numbers up to 4095 and nothing else. That of an array of a single taxel
// is told from no other file, and so is not written over.
bool begins_as_myrmex_csv(std::string_view text);

// The paper's augmentation (section 4): the image turned by 0 to 330 degrees in steps of 30, its innermost 12 x 12 taxels.
inline constexpr std::size_t rotations = 12;
inline constexpr std::size_t cropped = 12;
// One image of `rows` x `columns` taxels, at least 12 x 12, turned anticlockwise by `turn` * 30 degrees about its middle and cropped: [12 x 12].
// Bilinear; what lies beyond the outermost taxels has their counts (of 16 x 16 that is up to 0.013 taxels, at 30 degrees off an axis). Turns by
// 90 degrees are exact.
void turn_image(std::span<const float> image, std::size_t rows, std::size_t columns, std::size_t turn,
                std::span<float, cropped * cropped> out);

// The trial with `taxels` [T,12,12,12] (sample, turn, row, column) in the place of the images of every myrmex that is large enough, without the
// names of their values. Throws InputError when it has none.
TrialRecord turned_images(TrialRecord record);

}  // namespace slipbench
