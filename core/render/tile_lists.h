// Lists of elements, handed down from regions to blocks to tiles: each is made once, by whoever wants
// it first, and is the same whoever that is.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/render/canvas.h"

namespace ivory {

class TileLists {
  public:
    // Of n samples a side of a pixel: valid on all rays of a picture of n times as many columns and rows,
    // and of the pixels around each part.
    TileLists(const Picture& picture, Canvas& canvas, const std::atomic<bool>& stop, int n = 1);

    // All elements, which every list stands for.
    [[nodiscard]] const ElementList& all() const { return all_; }

    // Before any work: these regions' lists are steps of their own, which make_region does.
    void plan(std::vector<std::uint8_t> regions) { region_is_planned_ = std::move(regions); }
    void make_region(std::size_t region, Counts& counts);

    // The block's list, while somebody is at its tiles. False: cancelled on the way.
    bool make_block(std::size_t block, Counts& counts);
    [[nodiscard]] const ElementList* of_block(std::size_t block) const {
        return block_lists_[block] ? &*block_lists_[block] : nullptr;
    }
    void forget_block(std::size_t block) { block_lists_[block].reset(); }

    // The tile's; its block's has to be there.
    [[nodiscard]] ElementList of_tile(std::size_t tile, Counts& counts) const;

    // The block's as a bundle that its tiles share, with a number that no other has.
    [[nodiscard]] CommonBundle common(std::size_t block) const;

    [[nodiscard]] std::size_t block_of(std::size_t tile) const;
    [[nodiscard]] std::size_t region_of(std::size_t block) const;

  private:
    // A part as the lists see it, in pixels of that picture.
    [[nodiscard]] PixelRect seen(const PixelRect& rect) const {
        return n_ == 1 ? rect : times(widened(rect, 1), n_);
    }
    [[nodiscard]] ElementList narrowed(const ElementList& parent, const PixelRect& rect,
                                       Counts& counts) const;

    const Picture& picture_;
    Canvas& canvas_;
    const std::atomic<bool>& stop_;
    const int n_;
    const ElementList all_, all_clusters_;
    std::vector<ElementList> region_lists_;
    std::vector<std::atomic<bool>> region_done_;
    std::vector<std::uint8_t> region_is_planned_;
    std::vector<std::optional<ElementList>> block_lists_;
};

}  // namespace ivory
