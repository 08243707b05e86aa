// The work on one tile, by one worker: its rays traced, its colours found, both written to the frame;
// or shaded anew from what stands there.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/render/sample_work.h"
#include "core/render/shade.h"
#include "core/render/tile_lists.h"
#include "core/render/tile_rays.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"

namespace ivory {

// One for each worker: what it works on and adds up for itself, and the report gets at its end; in
// cache lines of its own. Nothing of a tile is written before all of it is known, so that a
// cancelled tile stays what it was.
class alignas(128) TileWorker {
  public:
    using Clock = std::chrono::steady_clock;

    // All of them outlive it.
    TileWorker(const Picture& picture, Canvas& canvas, const JobSettings& settings,
               TileLists& lists, const std::atomic<bool>& stop);

    // Tiles of another block come next.
    void leave_block() { common_.number = 0; }

    // Its list is there and not empty. False: cancelled on the way.
    bool trace(std::size_t tile);
    // Colours, lights and background anew, from the t that stand in the frame. Likewise.
    bool shade_again(std::size_t tile);
    // Misses, all over the rectangle, and all over the tile.
    void paint_empty(const PixelRect& rect) const;
    void leave_empty(std::size_t tile) const;
    // Its own, for the tiles of such a picture.
    [[nodiscard]] SampleWorker& sampler(SampledPicture& sampled);
    // The elements of a list that a tile with a surface has.
    void mark_reached(const ElementList& list);

    Counts counts;
    std::size_t tiles = 0;
    Clock::duration tracing{}, shading{};
    std::vector<std::uint8_t> reached;  // by element

  private:
    bool stopped() const { return stop_.load(std::memory_order_relaxed); }
    bool shaded() const { return settings_.task != Task::trace; }
    bool wants_surface() const {
        return shaded() || !canvas_.frame.surface.empty() || !canvas_.looks.empty();
    }
    void gather(std::size_t tile);
    bool share(std::size_t tile);
    void find_surface(const ElementList& list, const std::array<double, pixels_in_tile>& m);
    void paint();
    void commit(std::size_t tile);
    template <std::size_t count>
    void commit_run(std::size_t k, std::size_t p, bool colored, Looks* looks) const;
    bool reached_by_recolored(const ElementList& list) const;
    bool is_recolored(const TileState& tile) const;
    void paint_looks(std::size_t tile);
    bool look_again(std::size_t tile);

    const Picture& picture_;
    Canvas& canvas_;
    const JobSettings& settings_;
    TileLists& lists_;
    const std::atomic<bool>& stop_;
    ElementFilter recolored_;
    std::unique_ptr<SampleWorker> sampler_;
    CommonBundle common_;  // of the block that is being worked on; number 0: nobody has asked yet

    // Of the tile, between tracing and the frame.
    TileRays tile_;
    BundleIsolations isolations_;
    BundleSurfaces surfaces_;
    alignas(64) std::array<Rgba8, pixels_in_tile> colors_;
};

}  // namespace ivory
