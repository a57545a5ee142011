// The samples of a PapillArray and their truth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "tools/base/dataset/reader.h"
#include "tools/program/samples/samples.h"

namespace slipbench {

inline constexpr std::size_t pillars = 9;
inline constexpr std::size_t middle_pillar = 4;

// One PapillArray's samples: force and displacement of every pillar, and the truth.
class PapillarraySamples {
 public:
  // `label_speed` [m/s]: for the rules that have one. Throws InputError when the sensor is no PapillArray with nine pillars.
  PapillarraySamples(const SensorRecord& record, SlipRule rule, double label_speed);

  [[nodiscard]] std::size_t size() const { return record_->time.size(); }
  [[nodiscard]] double time(std::size_t row) const { return record_->time[row]; }  // s
  [[nodiscard]] std::array<float, 3> force(std::size_t row, std::size_t pillar) const {
    return triple(*force_, row, pillar);
  }                                                                                             // N
  [[nodiscard]] std::array<float, 3> displacement(std::size_t row, std::size_t pillar) const {  // m
    return triple(*displacement_, row, pillar);
  }
  [[nodiscard]] bool touching(std::size_t row, std::size_t pillar) const { return state(row, pillar) != UnitState::detached; }
  // By the rule asked for.
  [[nodiscard]] bool slipping(std::size_t row, std::size_t pillar) const;
  // Of the pillars in contact none, some or all slip by that rule. `turning`: the motion turns the pad, and the centre pillar, which
  // stays where it is, is left out.
  [[nodiscard]] PadState pad_state(std::size_t row, bool turning) const;
  // True tangential force [N].
  [[nodiscard]] double tangential_force(std::size_t row, std::size_t pillar) const;
  // Undeformed tip in the pad frame [m].
  [[nodiscard]] std::array<double, 3> tip(std::size_t pillar) const;

 private:
  [[nodiscard]] UnitState state(std::size_t row, std::size_t pillar) const {
    return static_cast<UnitState>(record_->labels.unit_state[row * pillars + pillar]);
  }
  // Whether the tip of a touching pillar slides faster than the threshold in this sample.
  [[nodiscard]] bool fast(std::size_t row, std::size_t pillar) const;
  static std::array<float, 3> triple(const std::vector<float>& values, std::size_t row, std::size_t pillar) {
    const float* first = values.data() + (row * pillars + pillar) * 3;
    return {first[0], first[1], first[2]};
  }

  const SensorRecord* record_;
  const std::vector<float>* force_ = nullptr;
  const std::vector<float>* displacement_ = nullptr;
  SlipRule rule_;
  double label_speed_;
  std::vector<std::uint8_t> has_slipped_;  // [T,9] 1: fast now or before, and in contact since then; empty for other rules
};

// Names of the PapillArrays among a trial's sensors.
std::vector<std::string> papillarrays_of(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
