// The board: the picture in the making, between the workers, who put finished tiles on it, and the
// window, which takes what may be seen of it: all of a picture or nothing, and tile by tile only what
// takes the place of a coarser one of the same scene and camera.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/platform/window_rect.h"
#include "app/viewer/shown_picture.h"
#include "app/viewer/tile_tally.h"
#include "core/render/canvas.h"
#include "core/render/frame.h"
#include "core/render/render.h"
#include "core/render/sampled_picture.h"

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

    // There is a picture of the request to be shown.
    [[nodiscard]] bool showable() const { return seen_ != Seen::nothing; }
    [[nodiscard]] std::size_t pixels() const { return color_.size(); }
    [[nodiscard]] std::size_t tiles() const { return is_here_.size(); }
    [[nodiscard]] bool tracing() const { return tracing_; }

    // Another picture. It has nothing yet of the tiles in `missing`; the others stand as they are.
    void begin(std::uint64_t new_number, const PictureRequest& new_request,
               const std::vector<std::uint8_t>& missing, bool surface_empty);
    // There is no picture of that request, and that is why.
    void fail(std::uint64_t new_number, const std::string& why);
    // A job begins that makes these tiles anew; those of `kept` show what is not this picture's. Unless it
    // is to be seen, tiles of several samples a pixel keep their colours.
    void expect(const std::vector<std::uint8_t>& selected, const std::vector<std::uint8_t>& kept,
                bool job_traces, bool to_be_seen = true);
    // What a worker has made of a tile. How many more of its pixels are there now.
    std::uint64_t take(const TileNotice& notice, const Canvas& canvas);
    // The tile with several samples a pixel, in place of what it was; and all that are so as they were
    // before.
    void take_samples(const TileNotice& notice, const Canvas& canvas,
                      const SampledPicture& sampled);
    void leave_samples(const Canvas& canvas);
    // Not 0 for tiles that have but one.
    [[nodiscard]] std::vector<std::uint8_t> without_samples() const;
    // All of the picture in fewer pixels: it is what is seen.
    void take_coarse(CoarsePicture&& picture);
    // From now on the tiles that are there are seen in place of the coarse picture.
    void refine();

    // What has changed since it was last called goes to the screen; it is showable.
    void hand_over(ShownPicture& shown, PictureChange& change);
    // What would be on the screen, though nothing of it has been handed over: every pixel, or the
    // coarse picture alone.
    [[nodiscard]] ShownPicture copy() const;

  private:
    enum class Seen : std::uint8_t {
        nothing,  // tiles are missing
        fine,     // every tile
        coarse,   // the coarse picture and no tile
        both,     // the tiles that are there, the coarse picture elsewhere
    };

    void lay_out(WindowSize size, std::size_t tiles);
    void take_colors(const PixelRect& rect, const Canvas& canvas, const Plane<Rgba8>& color);
    void take_depth(const PixelRect& rect, const Canvas& canvas, bool misses);
    void has_changed(std::size_t tile, std::uint8_t what);
    bool hand_over_tile(const PixelRect& rect, bool with_depth, ShownPicture& shown) const;
    void set_fine(std::vector<std::uint8_t>& fine) const;

    WindowSize laid_out_;  // what all that follows is of
    std::vector<Rgba8> color_;
    std::vector<float> depth_;
    std::vector<std::uint8_t> is_here_;     // by tile
    std::vector<std::uint8_t> is_sampled_;  // by tile: its colours are of several samples a pixel
    std::size_t missing_ = 0;               // tiles
    std::vector<std::size_t> changed_;      // tiles since they were handed over, each once
    std::vector<std::uint8_t> is_changed_;  // by tile: 1: its colours, 3: its depth too
    bool tracing_ = false;                  // false: only shaded anew
    bool to_be_seen_ = true;                // what the job makes
    Seen seen_ = Seen::nothing;
    CoarsePicture coarse_;  // as long as something of it is seen
    bool coarse_is_handed_over_ = false;
    bool fine_changed_ = false;  // the set of tiles that are seen fine, since it was handed over
};

}  // namespace ivory
