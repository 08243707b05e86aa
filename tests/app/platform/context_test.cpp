// OpenGL in memory: it opens, draws, reads back, and follows its size.
#include "app/platform/context.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "app/platform/embedded.h"
#include "core/scene/error.h"
#include "tests/app/platform/memory_contexts.h"

namespace ivory {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

class Contexts : public OnEachContext {};
IVORY_ON_EACH_CONTEXT(Contexts);

Pixel read_pixel(const MemoryContext& context, int x, int y) {
    Pixel pixel{};
    context.gl().BindFramebuffer(gl::framebuffer, context.framebuffer());
    context.gl().ReadPixels(x, y, 1, 1, gl::rgba, gl::unsigned_byte, pixel.data());
    return pixel;
}

void clear(const MemoryContext& context, float r, float g, float b) {
    context.gl().BindFramebuffer(gl::framebuffer, context.framebuffer());
    context.gl().ClearColor(r, g, b, 1);
    context.gl().Clear(gl::color_buffer_bit);
}

TEST_P(Contexts, OpensWithOpenGl33OrNewer) {
    const auto context = context_or_skip({64, 32});
    if (!context) return;
    EXPECT_STREQ(context->name(), GetParam());
    EXPECT_EQ(context->size(), (WindowSize{64, 32}));
    GlInt major = 0, minor = 0;
    context->gl().GetIntegerv(gl::major_version, &major);
    context->gl().GetIntegerv(gl::minor_version, &minor);
    EXPECT_GE(major * 10 + minor, 33);
}

TEST_P(Contexts, WhatIsDrawnIsReadBack) {
    const auto context = context_or_skip({64, 32});
    if (!context) return;
    clear(*context, 1, 0.2f, 0);
    EXPECT_EQ(read_pixel(*context, 0, 0), (Pixel{255, 51, 0, 255}));
    EXPECT_EQ(read_pixel(*context, 63, 31), (Pixel{255, 51, 0, 255}));
    EXPECT_EQ(context->gl().GetError(), gl::no_error);
}

TEST_P(Contexts, FollowsItsSize) {
    const auto context = context_or_skip({64, 32});
    if (!context) return;
    for (const WindowSize size : {WindowSize{200, 100}, WindowSize{1, 1}, WindowSize{64, 300}}) {
        context->resize(size);
        EXPECT_EQ(context->size(), size);
        context->gl().Viewport(0, 0, size.width, size.height);
        clear(*context, 0, 1, 0);
        EXPECT_EQ(read_pixel(*context, size.width - 1, size.height - 1), (Pixel{0, 255, 0, 255}));
    }
}

TEST_P(Contexts, ABrokenShaderIsNamed) {
    const auto context = context_or_skip({8, 8});
    if (!context) return;
    try {
        static_cast<void>(link_program(context->gl(), "test", "#version 330 core\nvoid main() {}",
                                       "#version 330 core\nvoid main() { nonsense; }"));
        FAIL() << "it compiled";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("shader test does not compile"), std::string::npos)
            << error.what();
    }
}

TEST_P(Contexts, SeveralOneAfterTheOther) {
    for (int i = 0; i < 3; ++i) {
        const auto context = context_or_skip({16, 16});
        if (!context) return;
        clear(*context, 0, 0, 1);
        EXPECT_EQ(read_pixel(*context, 8, 8), (Pixel{0, 0, 255, 255}));
    }
}

TEST(MemoryContext, TheEnvironmentChoosesAndIsChecked) {
    ASSERT_EQ(::setenv("IVORY_HEADLESS_CONTEXT", "vulkan", 1), 0);
    try {
        static_cast<void>(open_memory_context({8, 8}));
        FAIL() << "it opened";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "IVORY_HEADLESS_CONTEXT is \"vulkan\"; it may be osmesa or egl");
    }
    ::unsetenv("IVORY_HEADLESS_CONTEXT");
}

TEST(Embedded, FilesEndWithAZeroByte) {
    const std::string_view shader = embedded_file("shaders/frame.vert");
    EXPECT_TRUE(shader.starts_with("#version 330 core"));
    EXPECT_EQ(shader.data()[shader.size()], '\0');
    EXPECT_THROW(static_cast<void>(embedded_file("shaders/none")), std::logic_error);
}

}  // namespace
}  // namespace ivory
