#include "app/platform/gl.h"

#include <string>

#include "core/scene/error.h"

namespace ivory {

Gl Gl::load(const std::function<ProcAddress(const char*)>& proc_address) {
    Gl table;
#define IVORY_GL_LOAD(result, name, parameters)                                    \
    table.name = reinterpret_cast<decltype(table.name)>(proc_address("gl" #name)); \
    if (table.name == nullptr)                                                     \
        throw Error("OpenGL: the driver has no gl" #name                           \
                    "; 3.3 is "                                                    \
                    "needed");
    IVORY_GL_FUNCTIONS(IVORY_GL_LOAD)
#undef IVORY_GL_LOAD
    GlInt major = 0, minor = 0;
    table.GetIntegerv(gl::major_version, &major);
    table.GetIntegerv(gl::minor_version, &minor);
    if (major * 10 + minor < 33)
        throw Error("OpenGL " + std::to_string(major) + "." + std::to_string(minor) +
                    " is too old; 3.3 is needed");
    return table;
}

namespace {

GlUint compile_shader(const Gl& gl, const char* name, GlEnum type, const char* text) {
    const GlUint shader = gl.CreateShader(type);
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    GlInt done = 0;
    gl.GetShaderiv(shader, gl::compile_status, &done);
    if (done == 0) {
        char log[1024] = "";
        gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
        gl.DeleteShader(shader);
        throw Error(std::string("OpenGL: shader ") + name + " does not compile: " + log);
    }
    return shader;
}

}  // namespace

GlUint link_program(const Gl& gl, const char* name, const char* vertex, const char* fragment) {
    const GlUint shaders[] = {compile_shader(gl, name, gl::vertex_shader, vertex),
                              compile_shader(gl, name, gl::fragment_shader, fragment)};
    const GlUint program = gl.CreateProgram();
    for (const GlUint shader : shaders) gl.AttachShader(program, shader);
    gl.LinkProgram(program);
    for (const GlUint shader : shaders) gl.DeleteShader(shader);
    GlInt done = 0;
    gl.GetProgramiv(program, gl::link_status, &done);
    if (done == 0) {
        char log[1024] = "";
        gl.GetProgramInfoLog(program, sizeof log, nullptr, log);
        gl.DeleteProgram(program);
        throw Error(std::string("OpenGL: program ") + name + " does not link: " + log);
    }
    return program;
}

}  // namespace ivory
