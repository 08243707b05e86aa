// A picture painted on a canvas by worker threads: tile by tile, in full or in part, until it is done or
// cancelled.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/render/canvas.h"
#include "core/render/sampled_picture.h"
#include "core/trace/ray.h"

namespace ivory {

enum class Task : std::uint8_t {
    trace_and_shade,
    trace,   // no colours: for depth, or for answers where the canvas keeps the surface
    shade,   // what is traced already, from its t: after a change of colours, lights or background
    sample,  // several samples a pixel, on `sampled`; the canvas stays as it is
};

enum class Order : std::uint8_t {
    plain,       // block by block, row by row
    from_focus,  // the blocks around the focus first
};

// All pixels of the tile are in the frame now.
struct TileNotice {
    std::size_t tile;
    PixelRect rect;
    // Nothing in the frame is another than before: a tile that was without a surface and is.
    bool same = false;
};

struct JobSettings {
    int threads = 1;  // 1 or more
    Task task = Task::trace_and_shade;
    Order order = Order::plain;
    bool keep_lists = false;            // in the canvas, for the next job
    SampledPicture* sampled = nullptr;  // Task::sample
    // Task::shade: indices into the field, ascending, of the elements whose colour is another than
    // it was when the looks that the canvas keeps were found.
    std::vector<std::uint32_t> recolored;
    // One value for each tile of the canvas, not 0 where it is to be done; empty: all of them.
    std::vector<std::uint8_t> selected;
    // From the focus, the pixel of it; -1, -1: the middle.
    int focus_i = -1, focus_j = -1;
    // Called by the workers, several at a time, never twice at a time for one tile. It may read the
    // pixels of that tile that the notice names until it returns. Must not throw.
    std::function<void(const TileNotice&)> on_tile;
};

struct JobReport {
    bool complete = false;  // false: cancelled before the last tile
    double seconds = 0;     // from start to the last worker's end
    double shade_share =
        0;  // of the workers' time, 0..1; the rest went into tracing, and all sampling
    Counts counts;
    std::size_t tiles_traced = 0;  // tiles of which this job traced or shaded a pixel
    // Elements in the list of a tile that is not empty; shading does not count them.
    std::size_t elements_reached = 0;
};

// Starts at once, but for one thread, or where the system gives none: then the caller does the work
// in `wait_for` and `finish`. The canvas must outlive it and belongs to it until `finish` or the destructor
// has returned; then every tile is what its TileState says, cancelled or not.
class FrameJob {
  public:
    // Throws std::bad_alloc.
    FrameJob(Picture picture, Canvas& canvas, JobSettings settings);
    ~FrameJob();  // cancels and waits
    FrameJob(const FrameJob&) = delete;
    FrameJob& operator=(const FrameJob&) = delete;

    // Returns at once, from any thread; the workers end within the tiles that they are at, of which
    // nothing is written then.
    void cancel() noexcept;

    // Whether all workers have ended. Never waits.
    [[nodiscard]] bool finished() const;

    // Waits, or works, that long and no step of the work longer; whether all of it is done.
    [[nodiscard]] bool wait_for(std::chrono::milliseconds time);

    // Waits for the end. Throws what a worker threw (std::bad_alloc).
    JobReport finish();

    // Share of the work that has been dealt out, 0..1.
    [[nodiscard]] double progress() const noexcept;

  private:
    class Work;
    std::unique_ptr<Work> work_;
};

// All at once: a job with these settings, from start to end.
JobReport render(const Picture& picture, Canvas& canvas, const JobSettings& settings);

}  // namespace ivory
