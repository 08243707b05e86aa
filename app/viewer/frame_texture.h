// The traced picture as a texture, drawn pixel for pixel into the viewport.
#pragma once

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
    // Into the bound frame buffer, of that size: the picture in the middle of the viewport, which
    // is all of it where they are of one size, and `surroundings` where it does not reach.
    void draw(const WindowRect& viewport, WindowSize framebuffer, Rgba8 surroundings) const;

  private:
    const Gl& gl_;
    GlUint program_ = 0, array_ = 0, texture_ = 0;
    GlInt picture_uniform_ = -1, size_uniform_ = -1;
    WindowSize size_;
};

// The least number of rectangles, one tile high each, that cover the same pixels: neighbours in a
// row of tiles become one.
[[nodiscard]] std::vector<PixelRect> rows_of_tiles(std::vector<PixelRect> tiles);

}  // namespace ivory
