#include "sim/core/random.h"

#include <Random123/philox.h>

#include <algorithm>
#include <bit>
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

// Philox4x32-10 of `blocks` counters from (first, stream) on; a block's two words one after the other. As Random123's.
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
// Four blocks at once, a word of each in a lane of 64 bits, whose upper half is whatever the multiplication leaves: it reads the lower one. No
// loop of the compiler's multiplies so.
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

// Box and Muller's pair is the point on a circle of this radius, squared, and angle, from a draw of uniform() each.
double squared_radius_of(double draw) { return -2.0 * std::log(1.0 - draw); }  // 1 - u is in (0, 1]: the logarithm is finite
double angle_of(double draw) { return 2.0 * std::numbers::pi * draw; }

// Draws of normal() that are worked out at once, and the pairs that they are.
constexpr std::size_t most_drawn = 64, most_pairs = most_drawn / 2;

constexpr double above(std::uint64_t upper_half) { return std::bit_cast<double>((upper_half + 1) << 32); }

// Cosine and sine of angles in [0, 2 pi), by the argument reduction and the polynomials of
// FreeBSD's msun: the angle less n quarter turns in two parts, and a polynomial of each. Angles
// that are nearly whole quarter turns, where that takes more parts, are left to the scalar
// functions.
SLIPBENCH_DISPATCHED void put_on_circle(const double* angles, std::size_t count, double* cosines, double* sines) {
  using Bits = decltype(Quad{} < Quad{});
  constexpr double quarter = 0x1.921fb544p+0, rest_of_quarter = 0x1.0b4611a626331p-34;
  for (std::size_t i = 0; i < count; i += quad) {
    const Quad none{}, one = none + 1.0, angle = vector_at<Quad>(angles + i);
    Quad n = none;
    for (const std::uint64_t bound : {0x3FE921FBU, 0x4002D97CU, 0x400F6A7AU, 0x4015FDBCU})
      n += angle >= above(bound) ? one : none;
    const Quad z = angle - n * quarter, tail = n * rest_of_quarter, x = z - tail, y = (z - x) - tail;
    const Quad x2 = x * x, x4 = x2 * x2, x3 = x2 * x;
    const Quad r = 0x1.111111110f8a6p-7 + x2 * (-0x1.a01a019c161d5p-13 + x2 * 0x1.71de357b1fe7dp-19) +
                   x2 * x4 * (-0x1.ae5e68a2b9cebp-26 + x2 * 0x1.5d93a5acfd57cp-33);
    constexpr double s1 = -0x1.5555555555549p-3;
    const Quad sine = n == none ? x + x3 * (s1 + x2 * r) : x - ((x2 * (0.5 * y - x3 * r) - y) - x3 * s1);
    const Quad q = x2 * (0x1.555555555554cp-5 + x2 * (-0x1.6c16c16c15177p-10 + x2 * 0x1.a01a019cb159p-16)) +
                   x4 * x4 * (-0x1.27e4f809c52adp-22 + x2 * (0x1.1ee9ebdb4b1c4p-29 + x2 * -0x1.8fae9be8838d4p-37));
    const Quad half = 0.5 * x2, w = one - half, cosine = w + (((one - w) - half) + (x2 * q - x * y));
    const auto odd = (n == 1.0) | (n == 3.0);
    const Quad of_x = odd ? sine : cosine, of_y = odd ? cosine : sine;
    put_vector(cosines + i, (n == 1.0) | (n == 2.0) ? -of_x : of_x);
    put_vector(sines + i, (n == 2.0) | (n == 3.0) ? -of_y : of_y);
    const Bits upper = vector_at<Bits>(angles + i) >> 32;
    const Bits left =
        (upper < 0x3E46A09E) | (upper == 0x3FF921FB) | (upper == 0x400921FB) | (upper == 0x4012D97C) | (upper == 0x401921FB);
    if (!any(left)) continue;
    for (std::size_t k = i; k < i + quad; ++k) {
      cosines[k] = std::cos(angles[k]);
      sines[k] = std::sin(angles[k]);
    }
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
  const double radius = std::sqrt(squared_radius_of(uniform()));
  // As of many: a draw does not depend on how many are drawn at once.
  std::array<double, quad> angles, cosines, sines;
  angles.fill(angle_of(uniform()));
  put_on_circle(angles.data(), quad, cosines.data(), sines.data());
  spare_normal_ = radius * sines.front();
  has_spare_ = true;
  return radius * cosines.front();
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
  philox(counter_, stream_, key_, draws.size() / 2, draws.data());
  counter_ += draws.size() / 2;
}

void RandomStream::normal(std::span<double> draws) {
  std::array<std::uint64_t, most_drawn> words;
  std::array<double, most_pairs> angles, cosines, sines;
  angles.fill(1.0);
  while (!draws.empty()) {
    const std::span<std::uint64_t> drawn = std::span(words).first(std::min(words.size(), draws.size()));
    const std::size_t pairs = drawn.size() / 2;
    bits(drawn);
    // Apart, so that no root waits for its logarithm.
    for (std::size_t k = 0; k < pairs; ++k) {
      draws[2 * k] = squared_radius_of(uniform_of(drawn[2 * k]));
      angles[k] = angle_of(uniform_of(drawn[2 * k + 1]));
    }
    put_on_circle(angles.data(), (pairs + quad - 1) / quad * quad, cosines.data(), sines.data());
    for (std::size_t k = 0; k < pairs; ++k) {
      const double radius = std::sqrt(draws[2 * k]);
      draws[2 * k] = radius * cosines[k];
      draws[2 * k + 1] = radius * sines[k];
    }
    draws = draws.subspan(drawn.size());
  }
}

void RandomStream::seek(std::uint64_t pairs) {
  counter_ = pairs;  // a block is two uniform draws, which make two normal ones
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
