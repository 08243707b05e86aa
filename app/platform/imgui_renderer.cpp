#include "app/platform/imgui_renderer.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "app/platform/embedded.h"

namespace ivory {

ImguiRenderer::ImguiRenderer(const Gl& gl) : gl_(gl) {
    ImGuiIO& io = ImGui::GetIO();
    io.BackendRendererName = "ivory";
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;

    program_ = link_program(gl, "shaders/imgui", embedded_file("shaders/imgui.vert").data(),
                            embedded_file("shaders/imgui.frag").data());
    size_uniform_ = gl.GetUniformLocation(program_, "display_size");
    texture_uniform_ = gl.GetUniformLocation(program_, "atlas");

    gl.GenVertexArrays(1, &array_);
    gl.GenBuffers(1, &vertices_);
    gl.GenBuffers(1, &indices_);
    gl.BindVertexArray(array_);
    gl.BindBuffer(gl::array_buffer, vertices_);
    gl.BindBuffer(gl::element_array_buffer, indices_);
    const auto attribute = [&](GlUint index, GlInt size, GlEnum type, bool normalized,
                               std::size_t offset) {
        gl.EnableVertexAttribArray(index);
        gl.VertexAttribPointer(index, size, type, normalized, sizeof(ImDrawVert),
                               reinterpret_cast<const void*>(offset));
    };
    attribute(0, 2, gl::floating, false, offsetof(ImDrawVert, pos));
    attribute(1, 2, gl::floating, false, offsetof(ImDrawVert, uv));
    attribute(2, 4, gl::unsigned_byte, true, offsetof(ImDrawVert, col));
    gl.BindVertexArray(0);
}

ImguiRenderer::~ImguiRenderer() {
    gl_.DeleteTextures(1, &font_texture_);
    gl_.DeleteBuffers(1, &vertices_);
    gl_.DeleteBuffers(1, &indices_);
    gl_.DeleteVertexArrays(1, &array_);
    gl_.DeleteProgram(program_);
}

void ImguiRenderer::upload_fonts() {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
    if (font_texture_ == 0) gl_.GenTextures(1, &font_texture_);
    gl_.BindTexture(gl::texture_2d, font_texture_);
    gl_.TexParameteri(gl::texture_2d, gl::texture_min_filter, gl::linear);
    gl_.TexParameteri(gl::texture_2d, gl::texture_mag_filter, gl::linear);
    gl_.PixelStorei(gl::unpack_row_length, 0);
    gl_.TexImage2D(gl::texture_2d, 0, gl::rgba8, width, height, 0, gl::rgba, gl::unsigned_byte,
                   pixels);
    // a pointer up to 1.91.3, an integer after
    atlas.SetTexID((ImTextureID)(std::intptr_t)font_texture_);
    atlas.ClearTexData();
}

void ImguiRenderer::draw(const ImDrawData& data, WindowSize framebuffer) {
    gl_.Enable(gl::blend);
    gl_.BlendEquation(gl::func_add);
    gl_.BlendFuncSeparate(gl::src_alpha, gl::one_minus_src_alpha, gl::one, gl::one_minus_src_alpha);
    gl_.Enable(gl::scissor_test);
    gl_.Viewport(0, 0, framebuffer.width, framebuffer.height);
    gl_.UseProgram(program_);
    gl_.Uniform1i(texture_uniform_, 0);
    gl_.Uniform2f(size_uniform_, data.DisplaySize.x, data.DisplaySize.y);
    gl_.ActiveTexture(gl::texture0);
    gl_.BindVertexArray(array_);
    gl_.BindBuffer(gl::array_buffer, vertices_);

    for (int n = 0; n < data.CmdListsCount; ++n) {
        const ImDrawList& list = *data.CmdLists[n];
        gl_.BufferData(gl::array_buffer, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data,
                       gl::stream_draw);
        gl_.BufferData(gl::element_array_buffer, list.IdxBuffer.size_in_bytes(),
                       list.IdxBuffer.Data, gl::stream_draw);
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback != nullptr) continue;  // Ivory has none
            const auto left = static_cast<int>(std::max(command.ClipRect.x, 0.0f));
            const auto top = static_cast<int>(std::max(command.ClipRect.y, 0.0f));
            const int right = std::min(static_cast<int>(command.ClipRect.z), framebuffer.width);
            const int bottom = std::min(static_cast<int>(command.ClipRect.w), framebuffer.height);
            if (right <= left || bottom <= top) continue;
            // OpenGL counts rows from below
            gl_.Scissor(left, framebuffer.height - bottom, right - left, bottom - top);
            gl_.BindTexture(gl::texture_2d, static_cast<GlUint>((std::intptr_t)command.GetTexID()));
            gl_.DrawElementsBaseVertex(
                gl::triangles, static_cast<GlSize>(command.ElemCount),
                sizeof(ImDrawIdx) == 2 ? gl::unsigned_short : gl::unsigned_int,
                reinterpret_cast<const void*>(command.IdxOffset * sizeof(ImDrawIdx)),
                static_cast<GlInt>(command.VtxOffset));
        }
    }
    gl_.Disable(gl::scissor_test);
    gl_.BindVertexArray(0);
}

}  // namespace ivory
