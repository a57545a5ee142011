#include "sim/core/random.h"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>
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

// Philox4x32-10 of `blocks` counters from (first, stream) on; a block's two words one after the other. As Random123's, written so that the loop
// becomes vector code. `multipliers`: the generator's; a compiler that knew them would multiply by sums of shifts.
SLIPBENCH_DISPATCHED void philox(std::uint64_t first, std::uint64_t stream, std::array<std::uint32_t, 2> key,
                                 std::array<std::uint32_t, 2> multipliers, std::size_t blocks, std::uint64_t* words) {
  constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
  constexpr int rounds = 10;
  SLIPBENCH_VECTORISE
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint64_t counter = first + b;
    std::uint32_t c0 = low(counter), c1 = high(counter), c2 = low(stream), c3 = high(stream), k0 = key[0], k1 = key[1];
    for (int round = 0; round < rounds; ++round) {
      const std::uint64_t p0 = std::uint64_t{multipliers[0]} * c0, p1 = std::uint64_t{multipliers[1]} * c2;
      c0 = high(p1) ^ c1 ^ k0;
      c1 = low(p1);
      c2 = high(p0) ^ c3 ^ k1;
      c3 = low(p0);
      k0 += weyl_0;
      k1 += weyl_1;
    }
    words[2 * b] = join(c0, c1);
    words[2 * b + 1] = join(c2, c3);
  }
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t trial, std::string_view name) {
  // Philox is a bijection of its counter under every key: with the seed as key, no two pairs (trial, name) share a stream unless
  // their names collide in FNV-1a.
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

double RandomStream::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

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
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 - u is in (0, 1]: the logarithm is finite
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

std::uint64_t RandomStream::integer(std::uint64_t bound) {
  if (bound == 0) throw std::logic_error("RandomStream::integer: bound must be at least 1");
  // 2^64 mod bound: the draws below it would favour the small results.
  const std::uint64_t rejected = (0 - bound) % bound;
  std::uint64_t value = next();
  while (value < rejected) value = next();
  return value % bound;
}

void RandomStream::bits(std::span<std::uint64_t> draws) {
  if (used_ != 2 || draws.size() % 2 != 0) throw std::logic_error("RandomStream::bits: draws come in pairs");
  philox(counter_, stream_, key_, {PHILOX_M4x32_0, PHILOX_M4x32_1}, draws.size() / 2, draws.data());
  counter_ += draws.size() / 2;
}

void RandomStream::seek(std::uint64_t pairs) {
  counter_ = pairs;  // a block is two uniform draws, which make two normal ones
  used_ = 2;
  has_spare_ = false;
}

}  // namespace slipbench
