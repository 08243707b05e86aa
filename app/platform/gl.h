// The OpenGL 3.3 functions that Ivory calls, as one table of pointers: nothing links libGL, libOpenGL or
// libOSMesa, and two of them in one process cannot be mixed up. Types and constants: Khronos registry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#ifdef _WIN32
#define IVORY_GL_CALL __stdcall
#else
#define IVORY_GL_CALL
#endif

namespace ivory {

using GlEnum = std::uint32_t;
using GlUint = std::uint32_t;
using GlInt = std::int32_t;
using GlSize = std::int32_t;
using GlFloat = float;
using GlBool = std::uint8_t;
using GlBits = std::uint32_t;
using GlBytes = std::ptrdiff_t;

// X(result, name, parameters)
#define IVORY_GL_FUNCTIONS(X)                                                                    \
    X(void, ActiveTexture, (GlEnum unit))                                                        \
    X(void, AttachShader, (GlUint program, GlUint shader))                                       \
    X(void, BindBuffer, (GlEnum target, GlUint buffer))                                          \
    X(void, BindFramebuffer, (GlEnum target, GlUint framebuffer))                                \
    X(void, BindRenderbuffer, (GlEnum target, GlUint renderbuffer))                              \
    X(void, BindTexture, (GlEnum target, GlUint texture))                                        \
    X(void, BindVertexArray, (GlUint array))                                                     \
    X(void, BlendEquation, (GlEnum mode))                                                        \
    X(void, BlendFuncSeparate, (GlEnum from, GlEnum to, GlEnum from_alpha, GlEnum to_alpha))     \
    X(void, BufferData, (GlEnum target, GlBytes size, const void* data, GlEnum usage))           \
    X(GlEnum, CheckFramebufferStatus, (GlEnum target))                                           \
    X(void, Clear, (GlBits mask))                                                                \
    X(void, ClearColor, (GlFloat r, GlFloat g, GlFloat b, GlFloat a))                            \
    X(void, CompileShader, (GlUint shader))                                                      \
    X(GlUint, CreateProgram, ())                                                                 \
    X(GlUint, CreateShader, (GlEnum type))                                                       \
    X(void, DeleteBuffers, (GlSize n, const GlUint* buffers))                                    \
    X(void, DeleteFramebuffers, (GlSize n, const GlUint* framebuffers))                          \
    X(void, DeleteProgram, (GlUint program))                                                     \
    X(void, DeleteRenderbuffers, (GlSize n, const GlUint* renderbuffers))                        \
    X(void, DeleteShader, (GlUint shader))                                                       \
    X(void, DeleteTextures, (GlSize n, const GlUint* textures))                                  \
    X(void, DeleteVertexArrays, (GlSize n, const GlUint* arrays))                                \
    X(void, Disable, (GlEnum what))                                                              \
    X(void, DrawArrays, (GlEnum mode, GlInt first, GlSize count))                                \
    X(void, DrawElementsBaseVertex,                                                              \
      (GlEnum mode, GlSize count, GlEnum type, const void* indices, GlInt base))                 \
    X(void, Enable, (GlEnum what))                                                               \
    X(void, EnableVertexAttribArray, (GlUint index))                                             \
    X(void, Finish, ())                                                                          \
    X(void, FramebufferRenderbuffer,                                                             \
      (GlEnum target, GlEnum attachment, GlEnum renderbuffer_target, GlUint renderbuffer))       \
    X(void, GenBuffers, (GlSize n, GlUint * buffers))                                            \
    X(void, GenFramebuffers, (GlSize n, GlUint * framebuffers))                                  \
    X(void, GenRenderbuffers, (GlSize n, GlUint * renderbuffers))                                \
    X(void, GenTextures, (GlSize n, GlUint * textures))                                          \
    X(void, GenVertexArrays, (GlSize n, GlUint * arrays))                                        \
    X(GlEnum, GetError, ())                                                                      \
    X(void, GetIntegerv, (GlEnum name, GlInt * value))                                           \
    X(void, GetProgramInfoLog, (GlUint program, GlSize size, GlSize * length, char* log))        \
    X(void, GetProgramiv, (GlUint program, GlEnum name, GlInt * value))                          \
    X(void, GetShaderInfoLog, (GlUint shader, GlSize size, GlSize * length, char* log))          \
    X(void, GetShaderiv, (GlUint shader, GlEnum name, GlInt * value))                            \
    X(const std::uint8_t*, GetString, (GlEnum name))                                             \
    X(GlInt, GetUniformLocation, (GlUint program, const char* name))                             \
    X(void, LinkProgram, (GlUint program))                                                       \
    X(void, PixelStorei, (GlEnum name, GlInt value))                                             \
    X(void, ReadPixels,                                                                          \
      (GlInt x, GlInt y, GlSize width, GlSize height, GlEnum format, GlEnum type, void* pixels)) \
    X(void, RenderbufferStorage, (GlEnum target, GlEnum format, GlSize width, GlSize height))    \
    X(void, Scissor, (GlInt x, GlInt y, GlSize width, GlSize height))                            \
    X(void, ShaderSource,                                                                        \
      (GlUint shader, GlSize count, const char* const* texts, const GlInt* lengths))             \
    X(void, TexImage2D,                                                                          \
      (GlEnum target, GlInt level, GlInt internal_format, GlSize width, GlSize height,           \
       GlInt border, GlEnum format, GlEnum type, const void* pixels))                            \
    X(void, TexParameteri, (GlEnum target, GlEnum name, GlInt value))                            \
    X(void, TexSubImage2D,                                                                       \
      (GlEnum target, GlInt level, GlInt x, GlInt y, GlSize width, GlSize height, GlEnum format, \
       GlEnum type, const void* pixels))                                                         \
    X(void, Uniform1i, (GlInt location, GlInt value))                                            \
    X(void, Uniform2f, (GlInt location, GlFloat x, GlFloat y))                                   \
    X(void, UseProgram, (GlUint program))                                                        \
    X(void, VertexAttribPointer,                                                                 \
      (GlUint index, GlInt size, GlEnum type, GlBool normalized, GlSize stride,                  \
       const void* pointer))                                                                     \
    X(void, Viewport, (GlInt x, GlInt y, GlSize width, GlSize height))

struct Gl {
#define IVORY_GL_MEMBER(result, name, parameters) result(IVORY_GL_CALL* name) parameters = nullptr;
    IVORY_GL_FUNCTIONS(IVORY_GL_MEMBER)
#undef IVORY_GL_MEMBER

    using ProcAddress = void (*)();

    // The functions of the current context. Throws Error where one is missing, or the context is older
    // than OpenGL 3.3: a null address alone says nothing (OSMesa gives some for names that do not exist).
    [[nodiscard]] static Gl load(const std::function<ProcAddress(const char*)>& proc_address);
};

namespace gl {

inline constexpr GlEnum no_error = 0, triangles = 0x0004, triangle_strip = 0x0005;
inline constexpr GlBits color_buffer_bit = 0x4000;
inline constexpr GlEnum src_alpha = 0x0302, one_minus_src_alpha = 0x0303, one = 1,
                        func_add = 0x8006;
inline constexpr GlEnum blend = 0x0BE2, cull_face = 0x0B44, depth_test = 0x0B71,
                        stencil_test = 0x0B90, scissor_test = 0x0C11, framebuffer_srgb = 0x8DB9;
inline constexpr GlEnum unsigned_byte = 0x1401, unsigned_short = 0x1403, unsigned_int = 0x1405,
                        floating = 0x1406;
inline constexpr GlEnum red = 0x1903, r8 = 0x8229, rgb = 0x1907, rgba = 0x1908, rgba8 = 0x8058,
                        srgb8_alpha8 = 0x8C43;
inline constexpr GlEnum texture_2d = 0x0DE1, texture0 = 0x84C0, texture_mag_filter = 0x2800,
                        texture_min_filter = 0x2801, texture_wrap_s = 0x2802,
                        texture_wrap_t = 0x2803, nearest = 0x2600, linear = 0x2601,
                        clamp_to_edge = 0x812F, max_texture_size = 0x0D33;
inline constexpr GlEnum unpack_row_length = 0x0CF2, unpack_alignment = 0x0CF5,
                        pack_alignment = 0x0D05;
inline constexpr GlEnum vertex_shader = 0x8B31, fragment_shader = 0x8B30, compile_status = 0x8B81,
                        link_status = 0x8B82;
inline constexpr GlEnum array_buffer = 0x8892, element_array_buffer = 0x8893, stream_draw = 0x88E0;
inline constexpr GlEnum framebuffer = 0x8D40, renderbuffer = 0x8D41, color_attachment0 = 0x8CE0,
                        framebuffer_complete = 0x8CD5;
inline constexpr GlEnum vendor = 0x1F00, renderer = 0x1F01, version = 0x1F02,
                        major_version = 0x821B, minor_version = 0x821C;

}  // namespace gl

// A linked program of the two shaders, `name` naming them in the Error that says what does not compile.
[[nodiscard]] GlUint link_program(const Gl& gl, const char* name, const char* vertex,
                                  const char* fragment);

}  // namespace ivory
