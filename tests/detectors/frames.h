// Artificial sensor frames for tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "sim/api/detector.h"
#include "tests/expect.h"

namespace slipbench {

// Channels {units, 3} in N or m, as in a PapillArray.
inline FrameSource vector_source(const std::vector<std::string>& channels, std::size_t units, double rate) {
  FrameSource source{"pad", "papillarray", rate, {}};
  for (const std::string& name : channels) {
    source.channels.push_back({name, name == "force" ? "N" : "m", {units, 3}, {}});
  }
  return source;
}

// Units as springs with a Coulomb cone, on a surface that moves along x. Frames hold "force", then
// "displacement".
struct CoulombPad {
  std::vector<double> normal;  // N, of each unit
  double stiffness = 4e3;      // N/m, tangential
  double friction = 0.5;

  // The frame after the surface has moved one way by `path` [m] from the unloaded state.
  [[nodiscard]] std::vector<float> after(double path) const {
    std::vector<float> values(6 * normal.size());
    for (std::size_t i = 0; i < normal.size(); ++i) {
      const double tip = std::min(path, friction * normal[i] / stiffness);
      values[3 * i] = static_cast<float>(stiffness * tip);
      values[3 * i + 2] = static_cast<float>(normal[i]);
      values[3 * (normal.size() + i)] = static_cast<float>(tip);
    }
    return values;
  }

  [[nodiscard]] FrameSource source(double rate) const { return vector_source({"force", "displacement"}, normal.size(), rate); }
};

// Feeds a detector with frames at 1 kHz.
class EstimateReader {
 public:
  explicit EstimateReader(Detector& detector) : detector_(detector) {}

  SlipEstimate next(const std::vector<float>& values) { return detector_.update({1e-3 * ++tick_, values}); }
  // The state after `ticks` frames of the same values.
  PadState after(int ticks, const std::vector<float>& values) {
    PadState state{};
    for (int k = 0; k < ticks; ++k) state = next(values).state;
    return state;
  }

 private:
  Detector& detector_;
  int tick_ = 0;
};

// Three units slip one after the other on a surface at 5 mm/s: the k-th slip is reported
// `reported_at[k]` [ms] after the beginning, and the last is gross.
inline void expect_slips_reported(Detector& detector, const CoulombPad& pad, const std::array<int, 3>& reported_at) {
  EstimateReader reader(detector);
  for (int tick = 1; tick <= 250; ++tick) {
    const SlipEstimate estimate = reader.next(pad.after(5e-6 * tick));
    const auto slipping = std::ranges::count_if(reported_at, [tick](int at) { return at <= tick; });
    const PadState state = slipping == 0 ? PadState::non_slip : slipping == 3 ? PadState::gross : PadState::incipient;
    ASSERT_EQ(estimate.stuck_fraction, static_cast<double>(3 - slipping) / 3.0) << tick << " ms";
    ASSERT_EQ(estimate.state, state) << tick << " ms";
    EXPECT_EQ(estimate.time, 1e-3 * tick);
    EXPECT_EQ(estimate.latency, 0.0);
  }
}

}  // namespace slipbench
