// Random input for the engines.
#pragma once

#include <vector>

#include "detectors/hd/engine.h"
#include "sim/core/random.h"

namespace slipbench::hd {

inline std::vector<Frame> random_frames(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, 0, "hd test frames");
  std::vector<Frame> frames(count);
  for (Frame& frame : frames) {
    for (std::uint8_t& level : frame.level) level = static_cast<std::uint8_t>(random.integer(level_count));
    frame.context = static_cast<std::uint8_t>(random.integer(context_count));
  }
  return frames;
}

// Memories without any order, so that nothing cancels by chance.
inline Memories random_memories(const Model& model, std::uint64_t seed) {
  RandomStream random(seed, 0, "hd test memories");
  const auto rows = [&](std::size_t count) {
    std::vector<Hypervector> memory(count, Hypervector(model.dimension));
    for (Hypervector& vector : memory) {
      for (std::size_t i = 0; i < model.dimension; ++i) vector.set(i, random.integer(2) == 1);
    }
    return memory;
  };
  return {rows(item_count), rows(level_count), rows(context_count), rows(class_count)};
}

}  // namespace slipbench::hd
