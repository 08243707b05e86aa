// The instruction sets that SIMD code is built for: SSE2, SSE4, AVX2 and AVX-512, or NEON. To be
// included before Highway.
#pragma once

// Vectors without a fixed length are no members of structures; the others are of no use beside
// those above.
#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
