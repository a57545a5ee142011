// Counter-based random numbers: a draw depends only on its key, never on threads, shards or other
// effects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace slipbench {

// A stream of random numbers keyed by (dataset seed, trial, stream name). Generator: Philox4x32-10
// [salmon2011]. One block under the key `seed`, with the counter (trial, hash of the name), gives
// the stream's own key and the upper half of its counter; the lower half counts the blocks drawn.
// Streams with different keys are independent; the same key always gives the same numbers.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t trial, std::string_view name);

  double uniform();                        // in [0, 1), 53 bits
  double uniform(double min, double max);  // in [min, max); min where both are equal
  double normal();                         // mean 0, standard deviation 1 (Box-Muller)
  double normal(double mean, double sd) { return mean + sd * normal(); }
  std::uint64_t integer(std::uint64_t bound);  // in [0, bound), bound >= 1

  // Fills `draws` with the 64 random bits behind the next draws of uniform(), each of which is
  // (draw >> 11) 2^-53. Many at once are cheaper. Throws std::logic_error after an odd number of
  // draws, and for an odd number of them.
  void bits(std::span<std::uint64_t> draws);
  // Fills `draws` with the next draws of normal(). Restricted like bits().
  void normal(std::span<double> draws);

  // Moves to the draw after the first `pairs` pairs of normal() or uniform() draws, counted from
  // the start of the stream, which must draw nothing else.
  void seek(std::uint64_t pairs);

 private:
  std::uint64_t next();

  std::array<std::uint32_t, 2> key_;
  std::uint64_t stream_;       // upper half of the counter
  std::uint64_t counter_ = 0;  // lower half: blocks drawn
  std::array<std::uint64_t, 2> block_{};
  int used_ = 2;
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

// Shuffles the items (Fisher-Yates).
template <class Items>
void shuffle(Items& items, RandomStream& random) {
  for (std::size_t left = items.size(); left > 1; --left) std::swap(items[left - 1], items[random.integer(left)]);
}
// Returns the numbers 0 to count - 1 in a random order.
std::vector<std::size_t> shuffled(std::size_t count, RandomStream random);

}  // namespace slipbench
