// Rays from one origin around an axis, which are bounded together (core/field/bundle_field.h).
#pragma once

#include <cstdint>

#include "core/field/support.h"
#include "core/math/vec3.h"

namespace ivory {

// Rays origin + t d, t >= 0, with |d| and |axis| in 1 -+ 2^-50 and |d - axis| <= spread <= 1/2.
struct Bundle {
    Vec3d origin;
    Vec3d axis;
    double spread = 0;
};

// Some of a bundle's rays, which lie closer together, numbered as their owner likes; its own parts
// are others of the same array. Windows on which much is to be done are made for each part alone.
struct BundlePart {
    Vec3d axis;
    double spread = 0;
    std::uint32_t first = 0, end = 0;                // rays
    std::uint32_t first_part = 0, end_of_parts = 0;  // after this one in the array; none: equal
};

// A wider bundle, of the same origin, that others are parts of, and a list that is valid on it.
// What is bounded on long stretches of it is kept as long as `number` stays the same, and so shared
// by those who come one after another.
struct CommonBundle {
    Bundle bundle;
    const ElementList* list = nullptr;
    // Not 0; another one for each field, list and bundle, and for all else that `build` is given.
    std::uint64_t number = 0;
};

}  // namespace ivory
