// How coarse a picture in the making is: of what blocks each of its tiles is made, and whether any
// tile shows nothing yet or is too coarse to be worked with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ivory {

class TileBlocks {
  public:
    // Nothing is there of the tiles that are not 0 in `missing`, all of the others.
    void begin(const std::vector<std::uint8_t>& missing) {
        sides_.assign(missing.size(), 1);
        missing_ = 0;
        for (std::size_t tile = 0; tile < missing.size(); ++tile) {
            if (missing[tile] == 0) continue;
            sides_[tile] = nothing;
            ++missing_;
        }
        coarse_ = missing_;
    }

    void set(std::size_t tile, int pixels_a_side) {
        std::uint8_t& side = sides_[tile];
        if (side == nothing) --missing_;
        if (side > fine && pixels_a_side <= fine) --coarse_;
        side = static_cast<std::uint8_t>(pixels_a_side);
    }

    [[nodiscard]] bool coarser(std::size_t tile, int pixels_a_side) const {
        return sides_[tile] > pixels_a_side;
    }
    [[nodiscard]] bool complete() const { return missing_ == 0; }
    [[nodiscard]] bool all_fine() const { return coarse_ == 0; }
    [[nodiscard]] std::size_t size() const { return sides_.size(); }

  private:
    static constexpr int fine = 8;                // such blocks can be worked with
    static constexpr std::uint8_t nothing = 255;  // coarser than all blocks

    std::vector<std::uint8_t> sides_;  // by tile, in pixels
    std::size_t missing_ = 0, coarse_ = 0;
};

}  // namespace ivory
