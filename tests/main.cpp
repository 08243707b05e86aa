// GoogleTest's main, on the instruction set that IVORY_TEST_INSTRUCTIONS names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/instruction_sets.h"

namespace {

// No test may leave the others on another instruction set than theirs.
class SameInstructionSet : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo&) override {
        EXPECT_EQ(ivory::instruction_set(), ours_);
    }
    const std::string ours_{ivory::instruction_set()};
};

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (const char* const wanted = std::getenv("IVORY_TEST_INSTRUCTIONS")) {
        constexpr int skipped = 77;  // ctest's SKIP_RETURN_CODE
        const std::vector<std::string_view> all = ivory::instruction_sets();
        if (std::find(all.begin(), all.end(), wanted) == all.end()) {
            std::cout << "skipped: this machine does not have " << wanted << '\n';
            return skipped;
        }
        if (all.front() == wanted) {
            std::cout << "skipped: the tests run on " << wanted << " without being asked\n";
            return skipped;
        }
        ivory::limit_instruction_set(wanted);
    }
    testing::UnitTest::GetInstance()->listeners().Append(new SameInstructionSet);
    return RUN_ALL_TESTS();
}
