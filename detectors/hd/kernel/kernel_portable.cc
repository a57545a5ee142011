#include <cstddef>
#include <cstdint>

namespace {

// A word at a time.
struct Lanes {
  using V = std::uint64_t;
  using Count = std::size_t;
  static constexpr std::size_t words = 1;

  static V load(const V* p) { return *p; }
  static void store(V* p, V v) { *p = v; }
  static V zero() { return 0; }
  static V xor3(V a, V b, V c) { return a ^ b ^ c; }
  static V majority(V a, V b, V c) { return (a & b) | (c & (a | b)); }
  static void count(V v, Count& sum) { sum += static_cast<std::size_t>(__builtin_popcountll(v)); }
  static void totals(const Count sum[3], std::size_t total[3]) {
    for (int k = 0; k < 3; ++k) total[k] = sum[k];
  }
};

}  // namespace

#include "detectors/hd/kernel/kernel_body.h"

const slipbench::hd::kernel::Passes slipbench::hd::kernel::portable_passes = passes;
