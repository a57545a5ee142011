// What Tables I and III of the paper, its offline evaluation, share and are made of.
#pragma once

#include <cstddef>

#include "tools/base/page/json.h"

namespace slipbench::reproduce {

inline constexpr const char* hexapod_scene = "scenes/papillarray/hexapod.yaml";  // the published protocol

// What Table III says of a detector, out of what `slipbench eval` found.
struct GruFigures {
  std::size_t trials = 0, slipping = 0, seen = 0, early = 0, missed = 0, false_alarms = 0;  // of the trials that judge
  double balanced = 0.0, auc = 0.0;                                                         // of frames, slip or not, 0 to 1
  double delay = 0.0, delay_10 = 0.0, delay_90 = 0.0;                                       // s, of the trials seen; NaN: none
  double false_alarms_a_minute = 0.0;

  // Share of trials that are told: slip seen in time, or not called where there is none; `early_counts`: an early alarm is right, too.
  [[nodiscard]] double right(bool early_counts) const;
};

// Of eval::evaluate()'s result.
GruFigures gru_figures(const Json& result);

}  // namespace slipbench::reproduce
