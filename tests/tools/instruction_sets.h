// Tests on another instruction set than theirs.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "core/math/instruction_sets.h"

namespace ivory::tools {

// As long as this lives; afterwards on the one before, which need not be the best.
class OnInstructionSet {
  public:
    explicit OnInstructionSet(std::string_view name) : before_(instruction_set()) {
        EXPECT_TRUE(limit_instruction_set(name));
        EXPECT_EQ(instruction_set(), name);
    }
    ~OnInstructionSet() { EXPECT_TRUE(limit_instruction_set(before_)); }
    OnInstructionSet(const OnInstructionSet&) = delete;
    OnInstructionSet& operator=(const OnInstructionSet&) = delete;

  private:
    std::string before_;
};

}  // namespace ivory::tools
