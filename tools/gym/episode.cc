#include "tools/gym/episode.h"

#include <numeric>

#include "sim/core/random.h"

namespace slipbench {
namespace {

// Steps through all cells, each far from the one before: the golden section of their number, or
// the next number without a common divisor.
std::uint64_t stride_of(std::uint64_t cells) {
  constexpr double golden_section = 0.6180339887498949;
  auto stride = static_cast<std::uint64_t>(golden_section * static_cast<double>(cells));
  while (std::gcd(stride, cells) != 1) ++stride;
  return stride;
}

}  // namespace

std::size_t trial_of_episode(std::size_t cells, std::size_t draws, std::uint64_t seed, std::uint64_t episode) {
  const std::uint64_t shift = RandomStream(seed / cells, 0, "episode.cell").integer(cells);
  const std::uint64_t position = (seed % cells + shift + episode % cells) % cells;
  return position * stride_of(cells) % cells * draws + episode / cells % draws;
}

}  // namespace slipbench
