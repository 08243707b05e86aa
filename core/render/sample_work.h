// The work on one tile of a picture of several samples a pixel.
//
// What is asked for is the mean, in linear light, of the n x n pixels of the picture of n times as many
// columns and rows. Where these have different statuses it is just that. Elsewhere the middle of a pixel
// stands for all of it, where two things hold: all rays of the pixel are proved to have one status
// (core/trace/footprint.h); and its light bends so little that the mean is known to a fraction of a byte
// from those of its four neighbours, which are hit likewise. With D2 the second differences along its row
// and its column,
//     mean = c + share (D2 of the row + D2 of the column) + ...,    share = (n^2 - 1) / (24 n^2).
// Light has kinks, where a lamp goes down. One of k in the pixel's middle makes D2 = k, and the mean is
// k / 8 more than c: then what is added is a third of what is to be, and what is left open is
// 2 share |D2|, of the greatest D2 of the pixel and its neighbours. Where these are much the same the light
// is smooth, and what is left open is of the size of their difference D4. Where a neighbour's is not known
// twice as much may be open.
// All other pixels have all of their samples traced, in the tiles of the larger picture.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/render/canvas.h"
#include "core/render/sampled_picture.h"
#include "core/render/shade_lanes.h"
#include "core/render/tile_lists.h"
#include "core/render/tile_rays.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"

namespace ivory {

// One for each worker, who owns `counts`. Nothing of a tile is written before all of it is known.
class SampleWorker {
  public:
    // All of them outlive it.
    SampleWorker(const Picture& picture, Canvas& canvas, SampledPicture& sampled, TileLists& lists,
                 const std::atomic<bool>& stop, Counts& counts);

    // Tiles of another block come next, whose list is there.
    void enter_block(std::size_t block) { common_ = lists_.common(block); }

    // `list` is the tile's. False: cancelled on the way.
    bool sample(std::size_t tile, const ElementList& list);

  private:
    // Of the tile's pixels, row by row.
    template <class T>
    using Pixels = std::array<T, pixels_in_tile>;
    struct Channels {
        Pixels<double> r{}, g{}, b{};
    };

    // The same and the pixels around.
    static constexpr std::size_t pixels_in_sight = (tile_side + 2) * (tile_side + 2);
    template <class T>
    using InSight = std::array<T, pixels_in_sight>;
    struct Light {
        double r = 0, g = 0, b = 0;
    };

    bool stopped() const { return stop_.load(std::memory_order_relaxed); }
    void certify(const PixelRect& rect, const ElementList& list);
    void take_certain(const ElementList& list);
    void judge(const PixelRect& rect);
    bool trace_rest(const PixelRect& rect, const ElementList& list);
    bool trace_part(const PixelRect& rect, const PixelRect& part, const ElementList& list);
    void write(std::size_t tile, const PixelRect& rect);
    void write_empty(std::size_t tile, const PixelRect& rect);
    [[nodiscard]] Footprint footprint() const;

    const Picture& picture_;
    Canvas& canvas_;
    SampledPicture& sampled_;
    TileLists& lists_;
    const std::atomic<bool>& stop_;
    Counts& counts_;
    CommonBundle common_;

    TileRays rays_;
    BundleIsolations isolations_;
    BundleSurfaces surfaces_;
    LightColumns light_;
    InSight<Status> certain_;       // unresolved: nothing is
    InSight<Light> middle_;         // of those that are hit
    Pixels<Status> status_;         // what its samples have been so far
    Pixels<std::uint8_t> settled_;  // its colour is known
    Pixels<double> depth_;
    Channels sum_;  // of its samples; of a settled one the mean
};

}  // namespace ivory
