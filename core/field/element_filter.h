// A set of elements that may hold a few more than were put in (Bloom 1970, with one hash).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ivory {

// Exact where the field has no more than `places` elements.
class ElementFilter {
  public:
    static constexpr std::uint32_t places = 512;

    void add(std::uint32_t element) {
        words_[element % places / 64] |= std::uint64_t{1} << element % 64;
    }
    void add(std::span<const std::uint32_t> elements) {
        for (const std::uint32_t element : elements) add(element);
    }
    void add_all() { words_.fill(~std::uint64_t{0}); }

    // false: certainly no element is in both.
    [[nodiscard]] bool meets(const ElementFilter& others) const {
        std::uint64_t common = 0;
        for (std::size_t k = 0; k < words_.size(); ++k) common |= words_[k] & others.words_[k];
        return common != 0;
    }

  private:
    std::array<std::uint64_t, places / 64> words_{};
};

}  // namespace ivory
