// The traced picture as textures, drawn into the viewport: pixel for pixel where all of it is there, else
// a coarse picture made smooth, over which the tiles that are there fade in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/platform/gl.h"
#include "app/platform/window_rect.h"
#include "app/viewer/shown_picture.h"
#include "core/render/frame.h"
#include "core/render/tiles.h"

namespace ivory {

// Made and destroyed while the OpenGL context is current.
class FrameTexture {
  public:
    explicit FrameTexture(const Gl& gl);
    ~FrameTexture();
    FrameTexture(const FrameTexture&) = delete;
    FrameTexture& operator=(const FrameTexture&) = delete;

    // Uploads what has changed and nothing else.
    void update(const ShownPicture& picture, const PictureChange& change);
    // So much time has passed: tiles that take the place of a coarse picture are seen better.
    void fade(double seconds);
    [[nodiscard]] bool fading() const { return fading_ > 0; }
    // Into the bound frame buffer, of that size: the picture in the middle of the viewport, which
    // is all of it where they are of one size, and `surroundings` where it does not reach.
    void draw(const WindowRect& viewport, WindowSize framebuffer, Rgba8 surroundings) const;

  private:
    // A program of shaders/frame.vert and a fragment shader, and its uniforms.
    struct Program {
        GlUint name = 0;
        GlInt picture = -1, size = -1, coarse = -1, shares = -1, coarse_size = -1;
    };
    [[nodiscard]] Program make_program(const char* name, const char* fragment) const;
    void bind(GlEnum unit, GlUint texture) const;
    void take_pixels(const ShownPicture& picture, const PictureChange& change);
    void take_coarse(const ShownPicture& picture, const PictureChange& change);
    void take_shares();

    const Gl& gl_;
    Program frame_, preview_;
    GlUint array_ = 0, texture_ = 0, coarse_ = 0, share_texture_ = 0;
    WindowSize size_, coarse_size_;
    std::vector<std::uint8_t> fine_;  // by tile: it is there
    std::vector<float> shares_;       // by tile: 0, nothing of it is seen, to 1, nothing below it
    std::size_t hidden_ = 0;          // tiles of a share below 1
    std::size_t fading_ = 0;          // of these, they that are there
};

// The least number of rectangles, one tile high each, that cover the same pixels: neighbours in a
// row of tiles become one.
[[nodiscard]] std::vector<PixelRect> rows_of_tiles(std::vector<PixelRect> tiles);

}  // namespace ivory
