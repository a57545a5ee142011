// A scene whose recorded trial is replayed to the detector of its loop.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"

namespace slipbench::eval::testing {

inline std::vector<std::uint8_t> codes(const std::vector<PadState>& states) {
  std::vector<std::uint8_t> codes;
  for (const PadState state : states) codes.push_back(static_cast<std::uint8_t>(state));
  return codes;
}

// Expects the replay of the record to equal the loop's estimates in a trial of the scene. Returns
// the replay.
inline Replayed expect_same_as_loop(const Scene& scene, const TrialRecord& record) {
  Replayed replayed = replay(*scene.detector, record.sensors, scene.detector->sensor, scene.seed, record.trial);
  EXPECT_EQ(codes(replayed.seen), record.control.value().detector_class);
  return replayed;
}

}  // namespace slipbench::eval::testing
