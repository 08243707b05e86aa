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

}  // namespace ivory
