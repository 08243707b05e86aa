#include "app/viewer/frame_texture.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "app/platform/embedded.h"
#include "app/viewer/smoothing.h"

namespace ivory {

namespace {

// From the first moment of a tile until nothing is seen of what it takes the place of, in seconds:
// long enough that nothing pops.
constexpr float fade_time = 0.15f;

void set_filter(const Gl& gl, GlEnum filter) {
    gl.TexParameteri(gl::texture_2d, gl::texture_min_filter, static_cast<GlInt>(filter));
    gl.TexParameteri(gl::texture_2d, gl::texture_mag_filter, static_cast<GlInt>(filter));
    gl.TexParameteri(gl::texture_2d, gl::texture_wrap_s, static_cast<GlInt>(gl::clamp_to_edge));
    gl.TexParameteri(gl::texture_2d, gl::texture_wrap_t, static_cast<GlInt>(gl::clamp_to_edge));
}

}  // namespace

FrameTexture::FrameTexture(const Gl& gl) : gl_(gl) {
    frame_ = make_program("shaders/frame", "shaders/frame.frag");
    preview_ = make_program("shaders/preview", "shaders/preview.frag");
    gl.GenVertexArrays(1, &array_);  // empty, but core OpenGL draws nothing without one
    for (const auto& [texture, filter] :
         {std::pair(&texture_, gl::nearest), std::pair(&coarse_, gl::linear),
          std::pair(&share_texture_, gl::nearest)}) {
        gl.GenTextures(1, texture);
        gl.BindTexture(gl::texture_2d, *texture);
        set_filter(gl, filter);
    }
}

FrameTexture::~FrameTexture() {
    for (const GlUint* texture : {&texture_, &coarse_, &share_texture_})
        gl_.DeleteTextures(1, texture);
    gl_.DeleteVertexArrays(1, &array_);
    for (const Program* program : {&frame_, &preview_}) gl_.DeleteProgram(program->name);
}

FrameTexture::Program FrameTexture::make_program(const char* name, const char* fragment) const {
    Program program;
    program.name = link_program(gl_, name, embedded_file("shaders/frame.vert").data(),
                                embedded_file(fragment).data());
    const auto uniform = [&](const char* of) { return gl_.GetUniformLocation(program.name, of); };
    program.picture = uniform("picture");
    program.size = uniform("size");
    program.coarse = uniform("coarse");
    program.shares = uniform("shares");
    program.coarse_size = uniform("coarse_size");
    return program;
}

void FrameTexture::update(const ShownPicture& picture, const PictureChange& change) {
    if (!change.any()) return;
    size_ = picture.size;
    take_pixels(picture, change);
    take_coarse(picture, change);
}

void FrameTexture::take_pixels(const ShownPicture& picture, const PictureChange& change) {
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

void FrameTexture::take_coarse(const ShownPicture& picture, const PictureChange& change) {
    if (!change.coarse && !change.all) return;
    fine_ = picture.fine;
    const bool is_new = change.replaced || change.all || shares_.size() != fine_.size();
    if (picture.coarse.empty() || is_new)
        shares_.assign(fine_.size(), picture.coarse.empty() ? 1.0f : 0.0f);
    for (std::size_t tile = 0; tile < fine_.size(); ++tile)
        if (fine_[tile] == 0) shares_[tile] = 0;
    take_shares();
    if (picture.coarse.empty() || !is_new) return;
    const SmoothPicture smooth = smoothed(picture.coarse);
    coarse_size_ = smooth.size;
    gl_.BindTexture(gl::texture_2d, coarse_);
    gl_.TexImage2D(gl::texture_2d, 0, gl::srgb8_alpha8, coarse_size_.width, coarse_size_.height, 0,
                   gl::rgba, gl::unsigned_byte, smooth.color.data());
}

// Counts them, and uploads them where they are needed.
void FrameTexture::take_shares() {
    hidden_ = fading_ = 0;
    for (std::size_t tile = 0; tile < shares_.size(); ++tile) {
        if (shares_[tile] >= 1) continue;
        ++hidden_;
        fading_ += fine_[tile] != 0;
    }
    if (hidden_ == 0) return;
    const Squares& tiles = TileGrid(size_.width, size_.height).tiles;
    std::vector<std::uint8_t> bytes(shares_.size());
    // rises and ends slowly
    std::transform(shares_.begin(), shares_.end(), bytes.begin(), [](float share) {
        return static_cast<std::uint8_t>(255 * share * share * (3 - 2 * share) + 0.5f);
    });
    gl_.BindTexture(gl::texture_2d, share_texture_);
    gl_.PixelStorei(gl::unpack_alignment, 1);
    gl_.TexImage2D(gl::texture_2d, 0, gl::r8, tiles.across(), tiles.down(), 0, gl::red,
                   gl::unsigned_byte, bytes.data());
    gl_.PixelStorei(gl::unpack_alignment, 4);
}

void FrameTexture::fade(double seconds) {
    if (!fading()) return;
    for (std::size_t tile = 0; tile < shares_.size(); ++tile)
        if (fine_[tile] != 0)
            shares_[tile] = std::min(shares_[tile] + static_cast<float>(seconds) / fade_time, 1.0f);
    take_shares();
}

void FrameTexture::bind(GlEnum unit, GlUint texture) const {
    gl_.ActiveTexture(gl::texture0 + unit);
    gl_.BindTexture(gl::texture_2d, texture);
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
    const Program& program = hidden_ > 0 ? preview_ : frame_;
    gl_.UseProgram(program.name);
    gl_.Uniform1i(program.picture, 0);
    gl_.Uniform2f(program.size, static_cast<float>(size_.width), static_cast<float>(size_.height));
    if (hidden_ > 0) {
        bind(2, share_texture_);
        bind(1, coarse_);
        gl_.Uniform1i(program.coarse, 1);
        gl_.Uniform1i(program.shares, 2);
        gl_.Uniform2f(program.coarse_size, static_cast<float>(coarse_size_.width),
                      static_cast<float>(coarse_size_.height));
    }
    bind(0, texture_);
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
