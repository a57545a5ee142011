// Path that the object slips over a pad.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Returns the path [rows] in m that the object has slipped over the pad since the beginning of the
// record: the sum over time of the mean slip of the touching units. It never decreases: a unit that
// detaches, or one that starts to touch, does not change it, and without contact it is constant.
// Empty for labels without slip distances, such as imported ones. `rows`: number of samples.
std::vector<double> slip_path(const LabelRecord& labels, std::size_t rows);

}  // namespace slipbench
