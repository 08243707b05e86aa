// The board: the picture in the making, pixel by pixel, between the workers, who put finished tiles
// on it, and the window, which takes what has changed. Every pixel shows something of one picture
// once `readiness` says so: what is not traced yet shows its nearest pixel that is, as blocks.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/platform/window_rect.h"
#include "app/viewer/patience.h"
#include "app/viewer/shown_picture.h"
#include "app/viewer/tile_blocks.h"
#include "app/viewer/tile_tally.h"
#include "core/render/canvas.h"
#include "core/render/frame.h"
#include "core/render/render.h"

namespace ivory {

// Used under the session's lock.
class PictureBoard {
  public:
    std::uint64_t number = 0;  // of its request; 0: none yet
    PictureRequest request;
    TileTally tally;
    bool certainly_empty = false;
    bool final = false;
    // When the last tile came that anyone can tell from the one before.
    std::chrono::steady_clock::time_point ended;
    std::string fault;

    [[nodiscard]] Readiness readiness() const;
    [[nodiscard]] std::size_t pixels() const { return color_.size(); }
    [[nodiscard]] std::size_t tiles() const { return blocks_.size(); }
    [[nodiscard]] bool tracing() const { return tracing_; }

    // Another picture. It has nothing yet of the tiles in `missing`; the others stand as they are.
    void begin(std::uint64_t new_number, const PictureRequest& new_request,
               const std::vector<std::uint8_t>& missing, bool surface_empty);
    // A job begins that makes these tiles anew; those of `kept` show what is not this picture's.
    void expect(const std::vector<std::uint8_t>& selected, const std::vector<std::uint8_t>& kept,
                bool job_traces);
    // What a worker has made of a tile. How many more of its pixels are there now.
    std::uint64_t take(const TileNotice& notice, const Canvas& canvas);

    // What has changed since it was last called, of a complete picture, goes to the screen.
    void hand_over(ShownPicture& shown, PictureChange& change);
    [[nodiscard]] ShownPicture copy() const { return {request.size, color_, depth_}; }

  private:
    void lay_out(WindowSize size, std::size_t tiles);
    void take_pixel(const Frame& frame, std::size_t from, std::size_t to);
    void take_row(const Frame& frame, std::size_t first, int count, bool misses);
    void take_blocks(const TileNotice& notice, const Frame& frame);
    void spread(const TileNotice& notice, const Canvas& canvas);
    void shows(std::size_t tile, int pixels_a_side, bool differs = true);
    bool hand_over_tile(const PixelRect& rect, bool with_depth, ShownPicture& shown) const;

    WindowSize laid_out_;  // what all that follows is of
    std::vector<Rgba8> color_;
    std::vector<float> depth_;
    TileBlocks blocks_;
    std::vector<std::size_t> changed_;      // tiles since they were handed over, each once
    std::vector<std::uint8_t> is_changed_;  // by tile: 1: its colours, 3: its depth too
    std::vector<std::uint8_t> is_covered_;  // by tile: with another one's pixels, now or before
    bool tracing_ = false;                  // false: only shaded anew
};

}  // namespace ivory
