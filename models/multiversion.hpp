// Marks a numeric loop that is compiled twice, for any x86-64 and for processors with AVX2; which one runs is found out
// at program start. Both do the same operations in the same order (no fused multiply-add, no reordered sums), so the
// bits that come out are the same.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define STILLCUT_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#else
#define STILLCUT_MULTIVERSION
#endif
