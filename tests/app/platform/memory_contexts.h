// The contexts that a test of what is drawn runs on: each that this machine has.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "app/platform/context.h"
#include "core/scene/error.h"

namespace ivory {

// Sanitizers do not see into the OpenGL driver: its threads would be reported as races.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool opengl_can_be_tested = false;
#else
inline constexpr bool opengl_can_be_tested = true;
#endif

// By name, "OSMesa" or "EGL"; null, `why` saying so, where there is none. Where the name stands in
// IVORY_REQUIRE_OPENGL in the environment, as in CI, that is a failure.
inline std::unique_ptr<MemoryContext> open_context(const std::string& name, WindowSize size,
                                                   std::string& why) {
    if (!opengl_can_be_tested) {
        why = "not under the thread sanitizer";
        return nullptr;
    }
    try {
        return name == "EGL" ? open_egl_context(size) : open_osmesa_context(size);
    } catch (const Error& error) {
        why = error.what();
        const char* const required = std::getenv("IVORY_REQUIRE_OPENGL");
        if (required != nullptr && std::string_view(required).find(name) != std::string_view::npos)
            ADD_FAILURE() << why;
        return nullptr;
    }
}

// The tests of a suite run once on each context.
class OnEachContext : public testing::TestWithParam<const char*> {
  protected:
    // Null: the test has been skipped and has to return.
    std::unique_ptr<MemoryContext> context_or_skip(WindowSize size) {
        std::string why;
        std::unique_ptr<MemoryContext> context = open_context(GetParam(), size, why);
        if (!context) skip(why);
        return context;
    }

  private:
    static void skip(const std::string& why) { GTEST_SKIP() << why; }
};

inline std::string context_name(const testing::TestParamInfo<const char*>& info) {
    return info.param;
}

#define IVORY_ON_EACH_CONTEXT(suite) \
    INSTANTIATE_TEST_SUITE_P(In, suite, testing::Values("OSMesa", "EGL"), context_name)

}  // namespace ivory
