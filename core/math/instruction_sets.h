// The instruction sets that SIMD code is built for: AVX-512, AVX2, SSE4 and what is left, or NEON.
// To be included before Highway.
#pragma once

#include <string_view>
#include <vector>

// Vectors without a fixed length are no members of structures; the others are of no use beside
// those above.
#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

namespace ivory {

// Those that this machine has, best first. The best one is used.
[[nodiscard]] std::vector<std::string_view> instruction_sets();

// From now on the best one is this one of them, to compare. Not while other threads compute.
// False: it is not one of them.
bool limit_instruction_set(std::string_view name);

// The one in use.
[[nodiscard]] std::string_view instruction_set();

}  // namespace ivory
