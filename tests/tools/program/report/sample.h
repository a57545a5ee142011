// A small trial with known answers.
#pragma once

#include <string>
#include <vector>

#include "tests/files.h"
#include "tests/tools/base/page/unpack.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::report {

// Two units (A at x = +7 mm, B at -7 mm), eight samples at 1 kHz:
//   sample          0  1  2  3  4  5  6  7
//   unit A          -  S  S  P  L  L  L  L      touches at 0.5 ms, micro-slip at 2.25 ms, slips at 3.5 ms
//   unit B          -  -  S  S  S  P  L  L      touches at 1.5 ms, micro-slip at 4.5 ms, slips at 5.75 ms
//   state strict    0  1  1  1  2  2  3  3
//   state micro     0  1  1  2  2  3  3  3
//   state paper     0  1  1  1  1  2  3  3
// with - detached, S stick, P partial, L slip. The body moves sideways from sample 2 on.
TrialRecord sample_trial(std::size_t trial, const std::string& params);

// The same as a grasp by "step_on_slip" on the oracle: from row 3 on the arm rises by 2 mm a row, the box by 1 mm from -20 mm, and the box turns
// about the vertical by 0.01 rad a row. The grip force is 0.5 N a row, 71 counts and more are commanded, 70 and more measured. Bodies: pad, arm, box.
TrialRecord sample_grasp(std::size_t trial);

// Writes a dataset of trials and returns its path.
std::string write_dataset(const std::string& name, const std::string& scene, const std::vector<TrialRecord>& trials);

using page::unpack;

void write_text(const std::string& path, const std::string& text);

}  // namespace slipbench::report
