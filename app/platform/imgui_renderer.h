// Draws what Dear ImGui has prepared, through Ivory's own table of OpenGL functions.
#pragma once

#include "app/platform/gl.h"
#include "app/platform/window_rect.h"

struct ImDrawData;

namespace ivory {

// Of the current ImGui context; made and destroyed while the OpenGL context is current.
class ImguiRenderer {
  public:
    explicit ImguiRenderer(const Gl& gl);
    ~ImguiRenderer();
    ImguiRenderer(const ImguiRenderer&) = delete;
    ImguiRenderer& operator=(const ImguiRenderer&) = delete;

    // The atlas of the current ImGui context, as a texture. After every load_fonts.
    void upload_fonts();
    // Into the bound frame buffer, of that size; blending, scissor and bindings are left changed.
    void draw(const ImDrawData& data, WindowSize framebuffer);

  private:
    const Gl& gl_;
    GlUint program_ = 0, vertices_ = 0, indices_ = 0, array_ = 0, font_texture_ = 0;
    GlInt size_uniform_ = -1, texture_uniform_ = -1;
};

}  // namespace ivory
