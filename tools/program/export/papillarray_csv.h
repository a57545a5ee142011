// A PapillArray's samples in the layouts of others.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/program/samples/commanded_motion.h"
#include "tools/program/samples/papillarray_samples.h"

namespace slipbench {

// A length [m] in mm, in the fewest digits from which `slipbench import` makes the same float32 again.
std::string millimetres(float metres);

// The file's text in the vendor's layout, up to two sensors side by side. Throws InputError when their samples differ in time.
std::string vendor_csv(const std::vector<PapillarraySamples>& sensors);
// Whether a file that begins so is one.
bool begins_as_vendor_csv(std::string_view text);

// The text of a file of 73 columns. Throws InputError when the rate is not 1000 Hz.
std::string training_csv(const PapillarraySamples& samples, double rate);
// Whether a file that begins so is one: its first line is 73 numbers.
bool begins_as_training_csv(std::string_view text);

// The name that the published training code expects: "translation/demo_3-v_4.0-slip.csv" (README.md). `time`: of the pad's samples.
std::string training_file_name(std::size_t trial, const CommandedMotion& motion, const BodyRecord& pad,
                               const std::vector<double>& time);

}  // namespace slipbench
