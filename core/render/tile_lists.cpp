#include "core/render/tile_lists.h"

#include <thread>

#include "core/field/support.h"
#include "core/render/camera.h"

namespace ivory {
namespace {

// Short: whoever is at it has at most the rest of one step to do. False: cancelled.
bool wait_until(const std::atomic<bool>& done, const std::atomic<bool>& stop) {
    while (!done.load(std::memory_order_acquire)) {
        if (stop.load(std::memory_order_relaxed)) return false;
        std::this_thread::yield();
    }
    return true;
}

}  // namespace

TileLists::TileLists(const Picture& picture, Canvas& canvas, const std::atomic<bool>& stop, int n)
    : picture_(picture),
      canvas_(canvas),
      stop_(stop),
      n_(n),
      all_(all_elements(*picture.field)),
      all_clusters_(picture.options.skipping.lists ? all_clusters(*picture.field) : all_),
      region_lists_(canvas.grid.regions.size()),
      region_done_(canvas.grid.regions.size()),
      region_is_planned_(canvas.grid.regions.size()),
      block_lists_(canvas.grid.blocks.size()) {}

std::size_t TileLists::block_of(std::size_t tile) const {
    const PixelRect rect = canvas_.grid.tiles.rect(tile);
    return canvas_.grid.blocks.at(rect.x0, rect.y0);
}

std::size_t TileLists::region_of(std::size_t block) const {
    const PixelRect rect = canvas_.grid.blocks.rect(block);
    return canvas_.grid.regions.at(rect.x0, rect.y0);
}

ElementList TileLists::narrowed(const ElementList& parent, const PixelRect& rect,
                                Counts& counts) const {
    if (parent.certainly_empty || !picture_.options.skipping.lists) return parent;
    const Frame& frame = canvas_.frame;
    ElementList list = reaching_clusters(
        *picture_.field, parent,
        cone_around(picture_.view, frame.width * n_, frame.height * n_, seen(rect)));
    counts.skipping.list_elements += parent.size();
    counts.skipping.list_left_out += parent.size() - list.size();
    return list;
}

void TileLists::make_region(std::size_t region, Counts& counts) {
    region_lists_[region] = narrowed(all_clusters_, canvas_.grid.regions.rect(region), counts);
    region_done_[region].store(true, std::memory_order_release);
}

bool TileLists::make_block(std::size_t block, Counts& counts) {
    if (block_lists_[block]) return true;
    // The same from either, so that it does not matter who else asks for the region's.
    const std::size_t region = region_of(block);
    const bool planned = region_is_planned_[region] != 0;
    if (planned && !wait_until(region_done_[region], stop_)) return false;
    block_lists_[block] =
        narrowed(planned ? region_lists_[region]
                         : narrowed(all_clusters_, canvas_.grid.regions.rect(region), counts),
                 canvas_.grid.blocks.rect(block), counts);
    return true;
}

ElementList TileLists::of_tile(std::size_t tile, Counts& counts) const {
    return narrowed(*block_lists_[block_of(tile)], canvas_.grid.tiles.rect(tile), counts);
}

CommonBundle TileLists::common(std::size_t block) const {
    static std::atomic<std::uint64_t> numbers{0};
    return {
        .bundle = bundle_around(picture_.view, canvas_.frame.width * n_, canvas_.frame.height * n_,
                                seen(canvas_.grid.blocks.rect(block))),
        .list = &*block_lists_[block],
        .number = numbers.fetch_add(1, std::memory_order_relaxed) + 1};
}

}  // namespace ivory
