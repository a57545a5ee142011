// Compiled with -mavx2 -mpopcnt.
#include <cstddef>
#include <cstdint>

namespace {

// Four words at a time.
struct Lanes {
  using V [[gnu::vector_size(32)]] = std::uint64_t;
  using Count = std::size_t;
  static constexpr std::size_t words = 4;

  static V load(const std::uint64_t* p) {
    V v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
  }
  static void store(std::uint64_t* p, V v) { __builtin_memcpy(p, &v, sizeof v); }
  static V zero() { return V{}; }
  static V xor3(V a, V b, V c) { return a ^ b ^ c; }
  static V majority(V a, V b, V c) { return (a & b) | (c & (a | b)); }
  static void count(V v, Count& sum) {
    for (std::size_t i = 0; i < words; ++i) sum += static_cast<std::size_t>(__builtin_popcountll(v[i]));
  }
  static void totals(const Count sum[3], std::size_t total[3]) {
    for (int k = 0; k < 3; ++k) total[k] = sum[k];
  }
};

}  // namespace

#include "detectors/hd/kernel/kernel_body.h"

const slipbench::hd::kernel::Passes slipbench::hd::kernel::avx2_passes = passes;
