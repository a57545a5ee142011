#include "sim/core/random.h"

#include <Random123/philox.h>
#include <sleef.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

// Fowler-Noll-Vo hash FNV-1a, 64 bits (Fowler, Noll, Vo and Eastlake, IETF draft-eastlake-fnv).
std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

constexpr std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
constexpr std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }
constexpr std::uint64_t join(std::uint32_t low_word, std::uint32_t high_word) {
  return static_cast<std::uint64_t>(high_word) << 32 | low_word;
}

constexpr int rounds = 10;

// Philox4x32-10, as in Random123, of `blocks` counters from (first, stream) on. Writes two words
// per block, one after the other.
SLIPBENCH_INLINE void philox_by_one(std::uint64_t first, std::uint64_t stream, std::array<std::uint32_t, 2> key,
                                    std::size_t blocks, std::uint64_t* words) {
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint64_t counter = first + b;
    std::uint32_t c0 = low(counter), c1 = high(counter), c2 = low(stream), c3 = high(stream), k0 = key[0], k1 = key[1];
    for (int round = 0; round < rounds; ++round) {
      const std::uint64_t p0 = std::uint64_t{PHILOX_M4x32_0} * c0, p1 = std::uint64_t{PHILOX_M4x32_1} * c2;
      c0 = high(p1) ^ c1 ^ k0;
      c1 = low(p1);
      c2 = high(p0) ^ c3 ^ k1;
      c3 = low(p0);
      k0 += PHILOX_W32_0;
      k1 += PHILOX_W32_1;
    }
    words[2 * b] = join(c0, c1);
    words[2 * b + 1] = join(c2, c3);
  }
}

#ifdef SLIPBENCH_DISPATCHES
// Four blocks at once: each 64-bit lane holds one 32-bit word, and the multiplication reads only
// its lower half and leaves the upper one undefined. The compiler does not vectorise a loop this
// way.
__attribute__((target("arch=x86-64-v3"))) void philox(std::uint64_t first, std::uint64_t stream, std::array<std::uint32_t, 2> key,
                                                      std::size_t blocks, std::uint64_t* words) {
  using Words __attribute__((vector_size(4 * sizeof(long long)))) = unsigned long long;
  using Halves __attribute__((vector_size(8 * sizeof(int)))) = int;
  constexpr Words none{}, lower = none + 0xFFFFFFFF;
  constexpr Words m0 = none + PHILOX_M4x32_0, m1 = none + PHILOX_M4x32_1;
  std::size_t b = 0;
  for (; b + 4 <= blocks; b += 4) {
    Words c0 = none + first + b + Words{0, 1, 2, 3}, c1 = c0 >> 32, c2 = none + stream, c3 = c2 >> 32;
    std::uint32_t k0 = key[0], k1 = key[1];
    for (int round = 0; round < rounds; ++round) {
      const auto p0 =
          reinterpret_cast<Words>(__builtin_ia32_pmuludq256(reinterpret_cast<Halves>(c0), reinterpret_cast<Halves>(m0)));
      const auto p1 =
          reinterpret_cast<Words>(__builtin_ia32_pmuludq256(reinterpret_cast<Halves>(c2), reinterpret_cast<Halves>(m1)));
      c0 = p1 >> 32 ^ c1 ^ k0;
      c1 = p1;
      c2 = p0 >> 32 ^ c3 ^ k1;
      c3 = p0;
      k0 += PHILOX_W32_0;
      k1 += PHILOX_W32_1;
    }
    const Words one = (c0 & lower) | c1 << 32, other = (c2 & lower) | c3 << 32;
    const Words start = __builtin_shufflevector(one, other, 0, 4, 1, 5), end = __builtin_shufflevector(one, other, 2, 6, 3, 7);
    std::memcpy(words + 2 * b, &start, sizeof start);
    std::memcpy(words + 2 * b + 4, &end, sizeof end);
  }
  philox_by_one(first + b, stream, key, blocks - b, words + 2 * b);
}
__attribute__((target("default")))
#endif
void philox(std::uint64_t first, std::uint64_t stream, std::array<std::uint32_t, 2> key, std::size_t blocks, std::uint64_t* words) {
  philox_by_one(first, stream, key, blocks, words);
}

double uniform_of(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

using Pair __attribute__((vector_size(2 * sizeof(double)))) = double;

// Box and Muller's two points on a circle, from one uniform() draw each for radius and angle; the
// two coordinates of a point are two normal draws. Uses SLEEF's deterministic functions with errors
// of up to 3.5 units in the last place, which random numbers do not show; they take half the time
// of those of math.h.
struct Points {
  Points(const Pair& first, const Pair& second) {
    // argument in (0, 1]: finite
    const Pair squared_radius = -2.0 * SLIPBENCH_SLEEF(logd2_u35)(1.0 - first);
    const auto turn = SLIPBENCH_SLEEF(sincosd2_u35)(2.0 * std::numbers::pi * second);
    const Pair radius{std::sqrt(squared_radius[0]), std::sqrt(squared_radius[1])};
    x = radius * turn.y;
    y = radius * turn.x;
  }

  Pair x, y;
};

// Draws of normal() computed at once.
constexpr std::size_t most_drawn = 64;

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t trial, std::string_view name) {
  // Philox is a bijection of its counter under every key: with the seed as key, no two pairs
  // (trial, name) share a stream unless their names collide in FNV-1a.
  const std::uint64_t hash = fnv1a(name);
  const r123::Philox4x32::ctr_type counter{{low(trial), high(trial), low(hash), high(hash)}};
  const r123::Philox4x32::key_type key{{low(seed), high(seed)}};
  const auto mixed = r123::Philox4x32{}(counter, key);
  key_ = {mixed[0], mixed[1]};
  stream_ = join(mixed[2], mixed[3]);
}

std::uint64_t RandomStream::next() {
  if (used_ == 2) {
    const r123::Philox4x32::ctr_type counter{{low(counter_), high(counter_), low(stream_), high(stream_)}};
    const r123::Philox4x32::key_type key{{key_[0], key_[1]}};
    const auto drawn = r123::Philox4x32{}(counter, key);
    block_ = {join(drawn[0], drawn[1]), join(drawn[2], drawn[3])};
    ++counter_;
    used_ = 0;
  }
  return block_[static_cast<std::size_t>(used_++)];
}

double RandomStream::uniform() { return uniform_of(next()); }

double RandomStream::uniform(double min, double max) {
  if (!(min <= max) || !std::isfinite(max - min)) throw std::logic_error("RandomStream::uniform: no such interval");
  if (min == max) return min;
  // The sum may round up to max, which the half-open interval excludes: draw again.
  double value = max;
  while (value >= max) value = min + (max - min) * uniform();
  return value;
}

double RandomStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double first = uniform(), second = uniform();
  const Points points(Pair{first, first}, Pair{second, second});
  spare_normal_ = points.y[0];
  has_spare_ = true;
  return points.x[0];
}

std::uint64_t RandomStream::integer(std::uint64_t bound) {
  if (bound == 0) throw std::logic_error("RandomStream::integer: bound must be at least 1");
  // 2^64 mod bound: draws below it would make small results more likely.
  const std::uint64_t rejected = (0 - bound) % bound;
  std::uint64_t value = next();
  while (value < rejected) value = next();
  return value % bound;
}

void RandomStream::bits(std::span<std::uint64_t> draws) {
  if (used_ != 2 || draws.size() % 2 != 0) throw std::logic_error("RandomStream::bits: draws come in pairs");
  philox(counter_, stream_, key_, draws.size() / 2, draws.data());
  counter_ += draws.size() / 2;
}

void RandomStream::normal(std::span<double> draws) {
  std::array<std::uint64_t, most_drawn> words{};
  while (!draws.empty()) {
    const std::size_t count = std::min(most_drawn, draws.size());
    bits(std::span(words).first(count));
    for (std::size_t k = 0; k < count; k += 4) {  // two points; an odd count drops the second
      const Points points(Pair{uniform_of(words[k]), uniform_of(words[k + 2])},
                          Pair{uniform_of(words[k + 1]), uniform_of(words[k + 3])});
      for (std::size_t point = 0; point < std::min<std::size_t>(2, (count - k) / 2); ++point) {
        draws[k + 2 * point] = points.x[point];
        draws[k + 2 * point + 1] = points.y[point];
      }
    }
    draws = draws.subspan(count);
  }
}

void RandomStream::seek(std::uint64_t pairs) {
  counter_ = pairs;  // one block: two uniform or two normal draws
  used_ = 2;
  has_spare_ = false;
}

std::vector<std::size_t> shuffled(std::size_t count, RandomStream random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  shuffle(order, random);
  return order;
}

}  // namespace slipbench
