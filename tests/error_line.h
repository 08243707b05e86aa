// What a user would read: the message of the Error that a call throws.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/scene/error.h"

namespace ivory::tests {

// Fails the test, and answers nothing, where `call` throws no Error.
template <class Call>
std::string error_line(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no Error was thrown";
    return "";
}

}  // namespace ivory::tests
