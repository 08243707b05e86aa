// Elements of one shape and one kernel are a group: the inner loops are made for each of them. They
// are numbered shape by shape.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/kernel/kernels.h"
#include "core/shape/shapes.h"

namespace ivory {

inline constexpr std::size_t field_groups = field_shape_count * kernel_count;

[[nodiscard]] constexpr std::size_t group_of(Shape shape, KernelKind kernel) {
    return static_cast<std::size_t>(shape) * kernel_count + static_cast<std::size_t>(kernel);
}

// Where each group begins in a list that is sorted by them. It costs what groups there are, not what
// groups there could be.
class GroupStarts {
  public:
    struct Range {
        std::uint32_t first, end;
    };

    // What follows, after so many, is of that group, until another begins; in ascending order.
    void begin(std::size_t group, std::size_t count) {
        first_[group] = static_cast<std::uint32_t>(count);
        present_ |= bit(group);
    }
    void end(std::size_t count) { size_ = static_cast<std::uint32_t>(count); }
    void clear() {
        present_ = 0;
        size_ = 0;
    }

    [[nodiscard]] std::uint32_t size() const { return size_; }
    // Groups that have begun, one bit each; some may be empty.
    [[nodiscard]] std::uint64_t present() const { return present_; }
    [[nodiscard]] bool has(std::size_t group) const { return (present_ & bit(group)) != 0; }
    // Of a group that is present.
    [[nodiscard]] Range range(std::size_t group) const {
        const std::uint64_t later = present_ >> group >> 1;
        const auto next = static_cast<std::size_t>(std::countr_zero(later));
        return {first_[group], later == 0 ? size_ : first_[group + 1 + next]};
    }
    // Of any.
    [[nodiscard]] Range of(std::size_t group) const {
        return has(group) ? range(group) : Range{0, 0};
    }

    friend bool operator==(const GroupStarts& a, const GroupStarts& b) {
        if (a.present_ != b.present_ || a.size_ != b.size_) return false;
        for (std::uint64_t left = a.present_; left != 0; left &= left - 1) {
            const auto group = static_cast<std::size_t>(std::countr_zero(left));
            if (a.first_[group] != b.first_[group]) return false;
        }
        return true;
    }

  private:
    static_assert(field_groups <= 64);
    static std::uint64_t bit(std::size_t group) { return std::uint64_t{1} << group; }

    std::uint64_t present_ = 0;
    std::uint32_t size_ = 0;
    std::array<std::uint32_t, field_groups> first_{};  // of those that are present
};

}  // namespace ivory
