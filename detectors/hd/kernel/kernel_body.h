// The passes, written once for `Lanes`: a vector of words with the best operations of the
// instruction set. Each kernel_*.cc includes this file after defining Lanes. All code here and
// there is in an unnamed namespace and calls nothing from the standard library, because code
// compiled for one instruction set must never be linked in place of another's.
#pragma once

#include "detectors/hd/kernel/kernel_passes.h"

namespace slipbench::hd::kernel {
namespace {

using V = Lanes::V;

struct Sum {
  V sum, carry;
};

// Full adder of three bits of equal weight.
inline Sum add(V a, V b, V c) { return {Lanes::xor3(a, b, c), Lanes::majority(a, b, c)}; }

// Number of the nine pillars that are +1: one + 2 (two_a + two_b) + 4 four.
struct PillarCount {
  V one, two_a, two_b, four;
};

inline PillarCount count_pillars(const FrameRows& rows, std::size_t i) {
  const auto at = [&](int p) { return Lanes::load(rows.pillar[p] + i); };
  const Sum a = add(at(0), at(1), at(2));
  const Sum b = add(at(3), at(4), at(5));
  const Sum c = add(at(6), at(7), at(8));
  const Sum ones = add(a.sum, b.sum, c.sum);
  const Sum twos = add(a.carry, b.carry, c.carry);
  return {ones.sum, ones.carry, twos.sum, twos.carry};
}

// The vertices and edges of a complete graph of four depend only on the number n of vertices that
// are +1. Of the ten vectors, bound with the graph's name (`name`: +1 or -1), 2 h are +1:
//     n     0  1  2  3  4
//     +1    3  2  2  3  5
//     -1    2  3  3  2  0
//     -1    2  3  3  2  0
struct GraphCount {
  V h1, h2, h4;  // bits of h
};

inline GraphCount count_graph(const Word* const vertices[4], const Word* name_row, std::size_t i) {
  const V a = Lanes::load(vertices[0] + i), b = Lanes::load(vertices[1] + i);
  const V c = Lanes::load(vertices[2] + i), d = Lanes::load(vertices[3] + i);
  const V name = Lanes::load(name_row + i);
  const V all = a & b & c & d;
  const V some = a | b | c | d;
  const V most = (a & b & (c | d)) | (c & d & (a | b));  // three or four
  return {name ^ (some & ~most), ~all, all & name};
}

void bundle_pillars(const FrameRows& rows, std::size_t words, Word* gs) {
  for (std::size_t i = 0; i < words; i += Lanes::words) {
    // Five or more of nine means at least three twos, or two twos and the one: a majority in which
    // `four` counts for two.
    const PillarCount pillars = count_pillars(rows, i);
    const Sum rest = add(pillars.one, pillars.two_a, pillars.two_b);
    Lanes::store(gs + i, Lanes::majority(rest.carry, pillars.four, rest.sum));
  }
}

void bundle_graphs(const FrameRows& rows, const GraphRows& graphs, bool tie, std::size_t words, Word* gs) {
  for (std::size_t i = 0; i < words; i += Lanes::words) {
    // Majority of 30 vectors: at least 16, or 15 if ties count as one. With a tie counted as one
    // more vector the result is bit 4 of the sum.
    const PillarCount pillars = count_pillars(rows, i);
    const GraphCount corner = count_graph(rows.corner, graphs.corner, i);
    const GraphCount edge = count_graph(rows.edge, graphs.edge, i);
    const V centre = Lanes::load(rows.centre + i);
    const V two_c = tie ? pillars.one | centre : pillars.one & centre;
    const Sum a = add(pillars.two_a, pillars.two_b, two_c);          // weight 2
    const V two_carry = Lanes::majority(a.sum, corner.h1, edge.h1);  // the sum's own bit is below the threshold's
    const Sum b = add(pillars.four, a.carry, two_carry);             // weight 4
    const V four_carry = Lanes::majority(b.sum, corner.h2, edge.h2);
    const Sum eights = add(b.carry, four_carry, corner.h4);  // weight 8: two of four are 16
    Lanes::store(gs + i, eights.carry | (eights.sum & edge.h4));
  }
}

void bundle_core(const CoreWindow& window, const GraphRows* graphs, bool tie, std::size_t words, std::size_t stride, Word* gs) {
  const V none = Lanes::zero();
  for (std::size_t i = 0; i < words; i += Lanes::words) {
    V count[most_planes];  // of the pillars so far, bit-sliced
    for (unsigned plane = 0; plane < window.planes; ++plane) count[plane] = none;
    for (std::size_t r = 0; r < window.frames; ++r) {
      const std::size_t slot = window.oldest + r < window.frames ? window.oldest + r : window.oldest + r - window.frames;
      const FrameRows& rows = window.rows[slot];

      const PillarCount pillars = count_pillars(rows, i);
      const V four_carry = pillars.two_a & pillars.two_b;
      const V nine[4] = {pillars.one, pillars.two_a ^ pillars.two_b, pillars.four ^ four_carry, pillars.four & four_carry};
      V carry = none;
      for (unsigned plane = 0; plane < window.planes; ++plane) {
        const Sum sum = add(count[plane], plane < 4 ? nine[plane] : none, carry);
        count[plane] = sum.sum;
        carry = sum.carry;
      }

      V graph[5] = {none, none, none, none, none};  // of the graphs' 21 vectors
      if (graphs != nullptr) {
        const GraphCount corner = count_graph(rows.corner, graphs->corner, i);
        const GraphCount edge = count_graph(rows.edge, graphs->edge, i);
        const Sum fours = add(corner.h2, edge.h2, corner.h1 & edge.h1);
        const Sum eights = add(corner.h4, edge.h4, fours.carry);
        graph[0] = Lanes::load(rows.centre + i);
        graph[1] = corner.h1 ^ edge.h1;
        graph[2] = fours.sum;
        graph[3] = eights.sum;
        graph[4] = eights.carry;
      }

      // Adding 2^planes - threshold carries out of the last plane once the threshold is reached.
      const std::size_t vectors = (graphs != nullptr ? 21 : 0) + 9 * (r + 1);
      const std::size_t threshold = tie ? (vectors + 1) / 2 : vectors / 2 + 1;
      const std::size_t complement = (std::size_t{1} << window.planes) - threshold;
      V reached = none;
      carry = none;
      for (unsigned plane = 0; plane < window.planes; ++plane) {
        const Sum sum = add(count[plane], plane < 5 ? graph[plane] : none, carry);
        carry = sum.carry;
        reached = (complement >> plane & 1) != 0 ? reached | sum.sum : reached & sum.sum;
      }
      Lanes::store(gs + r * stride + i, reached);
    }
  }
}

// Returns words i to i + Lanes::words of rho^shift(row).
inline V rotated(const Word* row, std::size_t shift, std::size_t i) {
  const Word* const from = row + shift / 64 + i;
  const unsigned bits = shift % 64;
  return (Lanes::load(from) >> bits) | (Lanes::load(from + 1) << 1 << (63 - bits));
}

void slide(const Word* oldest, std::size_t shift, const Word* gs, std::size_t words, Word* gst) {
  for (std::size_t i = 0; i < words; i += Lanes::words) {
    Lanes::store(gst + i, Lanes::xor3(rotated(gst, 1, i), rotated(oldest, shift, i), Lanes::load(gs + i)));
  }
}

void bind_rotated(const Word* row, std::size_t shift, std::size_t words, Word* gst) {
  for (std::size_t i = 0; i < words; i += Lanes::words) Lanes::store(gst + i, ~(Lanes::load(gst + i) ^ rotated(row, shift, i)));
}

void distances(const Word* gst, const Word* mask, const Word* const prototypes[3], std::size_t words, std::size_t distance[3]) {
  Lanes::Count count[3] = {};
  for (std::size_t i = 0; i < words; i += Lanes::words) {
    const V query = Lanes::load(gst + i), used = Lanes::load(mask + i);
    for (int k = 0; k < 3; ++k) Lanes::count((query ^ Lanes::load(prototypes[k] + i)) & used, count[k]);
  }
  Lanes::totals(count, distance);
}

constexpr Passes passes{bundle_pillars, bundle_graphs, bundle_core, slide, bind_rotated, distances};

}  // namespace
}  // namespace slipbench::hd::kernel
