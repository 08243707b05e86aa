// The seed of a random test: the same from run to run, or another one for a longer campaign.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>

namespace ivory::tools {

// Of IVORY_TEST_SEED, or the test's own; printed, so that a failure can be repeated.
inline std::uint64_t announced_seed(std::uint64_t by_default) {
    const char* given = std::getenv("IVORY_TEST_SEED");
    const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : by_default;
    std::cout << "IVORY_TEST_SEED=" << seed << '\n';
    return seed;
}

}  // namespace ivory::tools
