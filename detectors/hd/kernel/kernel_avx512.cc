// Compiled with -mavx512f -mavx512vpopcntdq.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

namespace {

// Eight words at a time; any function of three bits is one instruction.
struct Lanes {
  using V [[gnu::vector_size(64)]] = std::uint64_t;
  using Count = V;
  static constexpr std::size_t words = 8;

  static V load(const std::uint64_t* p) {
    V v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
  }
  static void store(std::uint64_t* p, V v) { __builtin_memcpy(p, &v, sizeof v); }
  static V zero() { return V{}; }
  static V xor3(V a, V b, V c) { return ternary<0x96>(a, b, c); }
  static V majority(V a, V b, V c) { return ternary<0xe8>(a, b, c); }
  static void count(V v, Count& sum) { sum += reinterpret_cast<V>(_mm512_popcnt_epi64(reinterpret_cast<__m512i>(v))); }
  // Sums all three across the lanes at once: none exceeds 2^16.
  static void totals(const Count sum[3], std::size_t total[3]) {
    const V packed = sum[0] | sum[1] << 20 | sum[2] << 40;
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < words; ++i) all += packed[i];
    for (int k = 0; k < 3; ++k) total[k] = all >> (20 * k) & 0xfffff;
  }

 private:
  template <int kTable>
  static V ternary(V a, V b, V c) {
    return reinterpret_cast<V>(_mm512_ternarylogic_epi64(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b),
                                                         reinterpret_cast<__m512i>(c), kTable));
  }
};

}  // namespace

#include "detectors/hd/kernel/kernel_body.h"

const slipbench::hd::kernel::Passes slipbench::hd::kernel::avx512_passes = passes;
