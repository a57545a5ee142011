// How a slip detector's classes compare with the truth, as text.
#pragma once

#include <string>

#include "tools/program/cli/terminal.h"
#include "tools/program/train/train_hd.h"

namespace slipbench {

// A table of figures, the most telling first: mean and standard deviation over the draws that make them, by sequence and by frame.
std::string draws_text(const HdSummary& summary, const Style& style);
// Counts by true and by called class.
std::string confusion_text(const Confusion& confusion, const Style& style);
// Two lines: the delays, and how the sequences were seen.
std::string delays_text(const Delays& delays);

}  // namespace slipbench
