// The kernel's passes over packed rows, compiled for each instruction set with bit-identical
// results.
#pragma once

#include <cstddef>
#include <cstdint>

namespace slipbench::hd::kernel {

using Word = std::uint64_t;

// Rows start on cache lines and are padded with zeros to a multiple of this many words. Passes
// leave zeros in the padding, or the bits that a permutation reads (see `slide`).
inline constexpr std::size_t block_words = 8;

// Rows of the tables that one frame selects.
struct FrameRows {
  const Word* pillar[9];  // CIM(f_p) * IM(p)
  const Word* corner[4];  // CIM(f_p)
  const Word* edge[4];    // CIM(f_p)
  const Word* centre;     // CIM(f_4) * IM(graph of the centre)
};

// IM of the two graphs that have edges.
struct GraphRows {
  const Word* corner;
  const Word* edge;
};

// A bit-sliced count needs bit_width(21 + 9 * 1,000) planes for the longest window.
inline constexpr unsigned most_planes = 14;

// The window of the published core: a ring of `frames` rows, starting at `oldest`, and the `planes`
// that count its vectors.
struct CoreWindow {
  const FrameRows* rows;
  std::size_t frames, oldest;
  unsigned planes;
};

struct Passes {
  // gs = [pillars].
  void (*bundle_pillars)(const FrameRows& rows, std::size_t words, Word* gs);

  // gs = [graphs + pillars], ties to `tie`.
  void (*bundle_graphs)(const FrameRows& rows, const GraphRows& graphs, bool tie, std::size_t words, Word* gs);

  // Row r of `gs`, `stride` words apart, = [graphs of frame r + pillars of the frames 0 to r].
  // Without `graphs` the pillars alone.
  void (*bundle_core)(const CoreWindow& window, const GraphRows* graphs, bool tie, std::size_t words, std::size_t stride,
                      Word* gs);

  // gst = rho(gst) * rho^shift(oldest) * gs. `gst` and `oldest` repeat their first bits after the
  // last, as many as are rotated.
  void (*slide)(const Word* oldest, std::size_t shift, const Word* gs, std::size_t words, Word* gst);

  // gst = gst * rho^shift(row).
  void (*bind_rotated)(const Word* row, std::size_t shift, std::size_t words, Word* gst);

  // Counts the bits of `mask` in which gst differs from each of three prototypes.
  void (*distances)(const Word* gst, const Word* mask, const Word* const prototypes[3], std::size_t words,
                    std::size_t distance[3]);
};

extern const Passes portable_passes;
#ifdef SLIPBENCH_HD_X86
extern const Passes avx2_passes;    // AVX2, POPCNT
extern const Passes avx512_passes;  // AVX-512 F and VPOPCNTDQ
#endif

}  // namespace slipbench::hd::kernel
