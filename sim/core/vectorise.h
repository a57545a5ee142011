// How a loop is compiled to vector code.
#pragma once

// A function is compiled for x86-64-v3 and for any x86-64, and the loader picks one by the CPU it finds. Sanitizers do not survive the
// loader's early calls, and other compilers lack the attribute: they get the portable version, which computes the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__OPTIMIZE__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SLIPBENCH_DISPATCHED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SLIPBENCH_DISPATCHED
#endif
// Before a loop whose iterations do not depend on one another.
#if defined(__clang__)
#define SLIPBENCH_VECTORISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define SLIPBENCH_VECTORISE _Pragma("GCC ivdep")
#endif
#define SLIPBENCH_INLINE inline __attribute__((always_inline))
