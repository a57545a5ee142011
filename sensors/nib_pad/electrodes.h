// Which electrode of which nib a reading of the nib pad connects.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sensors/nib_pad/nib_capacitor.h"

namespace slipbench::nib_pad {

inline constexpr double pitch = 3.8e-3;  // m, from nib to nib
inline constexpr std::size_t rows = 6;   // of nibs, and as many columns
inline constexpr std::size_t nibs = rows * rows;
inline constexpr std::size_t taxels = 9;  // of 2x2 nibs
inline constexpr std::size_t sides = 4;   // electrodes of a taxel

// The values of a sample, in the order of its channels: si {9,4}, fl {2}, fr {2}.
inline constexpr std::size_t si_size = taxels * sides;
inline constexpr std::size_t fl_first = si_size;
inline constexpr std::size_t fr_first = fl_first + 2;
inline constexpr std::size_t value_count = fr_first + 2;

struct Electrode {
  std::size_t nib;
  Side side;
};

// Nib 6 row + column, taxel 3 row + column: rows from north to south, columns from west to east.
std::size_t taxel_of(std::size_t nib);

// The electrodes that value v of a sample connects. Of si, v = 4 taxel + side, those on one side of a taxel's four nibs. Of fl, those on
// the north side of all taxels, then those on the south side. Of fr, the tangential ones of the eight outer taxels, one of an edge, two of
// a corner: first those towards which nibs lean that are dragged counter-clockwise about +z, then the opposite ones.
std::vector<Electrode> electrodes_of(std::size_t v);

}  // namespace slipbench::nib_pad
