#include "core/math/instruction_sets.h"

#include <gtest/gtest.h>

#include <string>

namespace ivory {
namespace {

// Each that a machine has is one of those that ctest asks for, but for the best.
TEST(InstructionSets, AllThatThisMachineHasAreTested) {
    const std::string tested = std::string(" ") + IVORY_TESTED_INSTRUCTION_SETS + ' ';
    const std::vector<std::string_view> all = instruction_sets();
    for (std::size_t n = 1; n < all.size(); ++n) {
        EXPECT_NE(tested.find(' ' + std::string(all[n]) + ' '), std::string::npos) << all[n];
    }
}

}  // namespace
}  // namespace ivory
