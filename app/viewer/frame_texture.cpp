#include "app/viewer/frame_texture.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "app/platform/embedded.h"

namespace ivory {

FrameTexture::FrameTexture(const Gl& gl) : gl_(gl) {
    program_ = link_program(gl, "shaders/frame", embedded_file("shaders/frame.vert").data(),
                            embedded_file("shaders/frame.frag").data());
    picture_uniform_ = gl.GetUniformLocation(program_, "picture");
    size_uniform_ = gl.GetUniformLocation(program_, "size");
    gl.GenVertexArrays(1, &array_);  // empty, but core OpenGL draws nothing without one
    gl.GenTextures(1, &texture_);
    gl.BindTexture(gl::texture_2d, texture_);
    gl.TexParameteri(gl::texture_2d, gl::texture_min_filter, gl::nearest);
    gl.TexParameteri(gl::texture_2d, gl::texture_mag_filter, gl::nearest);
}

FrameTexture::~FrameTexture() {
    gl_.DeleteTextures(1, &texture_);
    gl_.DeleteVertexArrays(1, &array_);
    gl_.DeleteProgram(program_);
}

void FrameTexture::update(const ShownPicture& picture, const PictureChange& change) {
    if (!change.any()) return;
    size_ = picture.size;
    gl_.BindTexture(gl::texture_2d, texture_);
    gl_.PixelStorei(gl::unpack_row_length, size_.width);
    if (change.all)
        gl_.TexImage2D(gl::texture_2d, 0, gl::rgba8, size_.width, size_.height, 0, gl::rgba,
                       gl::unsigned_byte, picture.color.data());
    for (const PixelRect& rect : rows_of_tiles(change.tiles)) {
        const std::size_t corner =
            static_cast<std::size_t>(rect.y0) * static_cast<std::size_t>(size_.width) +
            static_cast<std::size_t>(rect.x0);
        gl_.TexSubImage2D(gl::texture_2d, 0, rect.x0, rect.y0, rect.width(), rect.height(),
                          gl::rgba, gl::unsigned_byte, &picture.color[corner]);
    }
    gl_.PixelStorei(gl::unpack_row_length, 0);
}

void FrameTexture::draw(const WindowRect& viewport, WindowSize framebuffer,
                        Rgba8 surroundings) const {
    gl_.Enable(gl::scissor_test);
    // OpenGL counts rows from below
    gl_.Scissor(viewport.x, framebuffer.height - viewport.y - viewport.height, viewport.width,
                viewport.height);
    if (size_.width < viewport.width || size_.height < viewport.height) {
        gl_.ClearColor(static_cast<float>(surroundings.r) / 255,
                       static_cast<float>(surroundings.g) / 255,
                       static_cast<float>(surroundings.b) / 255, 1);
        gl_.Clear(gl::color_buffer_bit);
    }
    const int left = viewport.x + (viewport.width - size_.width) / 2;
    const int top = viewport.y + (viewport.height - size_.height) / 2;
    gl_.Viewport(left, framebuffer.height - top - size_.height, size_.width, size_.height);
    gl_.Disable(gl::blend);
    gl_.UseProgram(program_);
    gl_.ActiveTexture(gl::texture0);
    gl_.BindTexture(gl::texture_2d, texture_);
    gl_.Uniform1i(picture_uniform_, 0);
    gl_.Uniform2f(size_uniform_, static_cast<float>(size_.width), static_cast<float>(size_.height));
    gl_.BindVertexArray(array_);
    gl_.DrawArrays(gl::triangle_strip, 0, 4);  // nothing, where there is no picture yet
    gl_.BindVertexArray(0);
    gl_.Disable(gl::scissor_test);
}

std::vector<PixelRect> rows_of_tiles(std::vector<PixelRect> tiles) {
    std::sort(tiles.begin(), tiles.end(), [](const PixelRect& a, const PixelRect& b) {
        return std::pair(a.y0, a.x0) < std::pair(b.y0, b.x0);
    });
    std::vector<PixelRect> rows;
    for (const PixelRect& tile : tiles) {
        if (!rows.empty() && rows.back().y0 == tile.y0 && rows.back().x1 == tile.x0)
            rows.back().x1 = tile.x1;
        else
            rows.push_back(tile);
    }
    return rows;
}

}  // namespace ivory
