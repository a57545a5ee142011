// Settings of a hyperdimensional classifier. All are from the paper "Ultra-Fast Lightweight
// Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor",
// section III, and table I for the ablations.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slipbench::hd {

inline constexpr std::size_t pillar_count = 9;
inline constexpr std::size_t level_count = 21;  // of the feature of a pillar
inline constexpr std::size_t context_count = 4;
inline constexpr std::size_t class_count = 3;  // non-slip, incipient, gross

// Pillars of one height form a complete graph: the four corners, the four edges, and the centre
// alone.
inline constexpr std::size_t graph_count = 3;
inline constexpr std::array<std::size_t, 4> corner_pillars{0, 2, 6, 8};
inline constexpr std::array<std::size_t, 4> edge_pillars{1, 3, 5, 7};
inline constexpr std::size_t centre_pillar = 4;

// One row of the item memory per pillar, then one per graph.
inline constexpr std::size_t item_count = pillar_count + graph_count;

// Encoding of frames before they are compared (table I).
enum class Encoding : std::uint8_t {
  spatial,                 // sHDC: GS of one frame from the pillars alone
  spatial_temporal,        // stHDC: the same over a window
  graph_spatial_temporal,  // gstHDC: pillars and graphs over a window
};

// Value of a bit whose bundle sums to zero. The rule belongs to the model: it decides one bit in
// seven of a frame.
enum class Ties : std::uint8_t { one, zero };

// Bundling rule. The published gripper core does not clear the counts of the pillars between the
// frames of a window: its frame r (0 is the oldest) adds its graphs to the pillars of frames 0 to
// r, 21 + 9 (r + 1) vectors in all. The published associative memory was trained that way.
enum class Compat : std::uint8_t { paper, published_core };

struct Model {
  std::size_t dimension = 1000;  // D, bits of a hypervector: 8 to 65,535
  std::size_t window = 15;       // N, frames: 1 to 1,000. sHDC always uses one frame
  Encoding encoding = Encoding::graph_spatial_temporal;
  bool context_driven = true;  // "CL-": prototypes are bound with the context of the frame
  Ties ties = Ties::one;
  Compat compat = Compat::paper;

  bool operator==(const Model&) const = default;

  // Frames per decision.
  [[nodiscard]] std::size_t frames() const { return encoding == Encoding::spatial ? 1 : window; }
};

// Throws InputError if dimension or window is out of range.
void check(const Model& model);

}  // namespace slipbench::hd
