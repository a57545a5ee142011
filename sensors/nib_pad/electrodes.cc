#include "sensors/nib_pad/electrodes.h"

namespace slipbench::nib_pad {
namespace {

// Where a taxel is from the middle one: -1, 0 or 1 to the east and to the north.
struct Place {
  int east, north;
};
Place place_of(std::size_t taxel) { return {static_cast<int>(taxel % 3) - 1, 1 - static_cast<int>(taxel / 3)}; }

// Whether the electrode on `side` of a taxel is on the side to which a counter-clockwise turn (`turn` = 1; clockwise: -1) about the pad's
// middle drags it: the turn's velocity there is (-north, east).
bool is_ahead(std::size_t taxel, Side side, int turn) {
  const Place place = place_of(taxel);
  switch (side) {
    case Side::west: return turn * place.north > 0;
    case Side::north: return turn * place.east > 0;
    case Side::east: return turn * place.north < 0;
    case Side::south: return turn * place.east < 0;
  }
  return false;
}

bool connects(std::size_t v, std::size_t taxel, Side side) {
  if (v < si_size) return v == sides * taxel + static_cast<std::size_t>(side);
  if (v < fr_first) return side == (v == fl_first ? Side::north : Side::south);
  return is_ahead(taxel, side, v == fr_first ? 1 : -1);
}

}  // namespace

std::size_t taxel_of(std::size_t nib) { return 3 * (nib / rows / 2) + nib % rows / 2; }

std::vector<Electrode> electrodes_of(std::size_t v) {
  std::vector<Electrode> electrodes;
  for (std::size_t nib = 0; nib < nibs; ++nib) {
    for (const Side side : {Side::west, Side::north, Side::east, Side::south}) {
      if (connects(v, taxel_of(nib), side)) electrodes.push_back({nib, side});
    }
  }
  return electrodes;
}

}  // namespace slipbench::nib_pad
