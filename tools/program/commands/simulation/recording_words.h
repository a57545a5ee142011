// The words of --record.
#pragma once

#include <array>

#include "detectors/hd/words.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

inline constexpr std::array recording_words{hd::Word<Recording>{"full", Recording::full},
                                            hd::Word<Recording>{"outcome", Recording::outcome}};

}  // namespace slipbench
