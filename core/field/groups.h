// Elements of one shape and one kernel are a group: the inner loops are made for each of them. They
// are numbered shape by shape.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/kernel/kernels.h"
#include "core/shape/shapes.h"

namespace ivory {

inline constexpr std::size_t field_groups = field_shape_count * kernel_count;

[[nodiscard]] constexpr std::size_t group_of(Shape shape, KernelKind kernel) {
    return static_cast<std::size_t>(shape) * kernel_count + static_cast<std::size_t>(kernel);
}

// Where each group begins in a list that is sorted by them; the last: how long it is.
using GroupStarts = std::array<std::uint32_t, field_groups + 1>;

// Writes them for a list that grows group by group, those without elements left out.
class GroupStartsWriter {
  public:
    explicit GroupStartsWriter(GroupStarts& first) : first_(first) {}
    // What follows, after so many, is of that group.
    void begin(std::size_t group, std::size_t count) {
        while (next_ <= group) first_[next_++] = static_cast<std::uint32_t>(count);
    }
    void end(std::size_t count) { begin(field_groups, count); }

  private:
    GroupStarts& first_;
    std::size_t next_ = 0;
};

}  // namespace ivory
