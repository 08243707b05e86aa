// Rays around an axis, from one origin or side by side, which are bounded together
// (core/field/bundle_field.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/field/support.h"
#include "core/math/vec3.h"

namespace ivory {

// Rays o + t d, t >= 0, with |d| and |axis| in 1 -+ 2^-50 and |d - axis| <= spread <= 1/2, from
// origins across the axis: |o - origin| <= radius, |(o - origin).axis| <= spread radius. So a ray's
// point at t lies within radius + t spread of the axis' point origin + t axis.
struct Bundle {
    Vec3d origin;
    Vec3d axis;
    double spread = 0;
    double radius = 0;
};

// The directions of a bundle's rays, component by component; null: not told.
struct RayColumns {
    const double *x = nullptr, *y = nullptr, *z = nullptr;
    // And their origins; null: that of the bundle.
    const double *ox = nullptr, *oy = nullptr, *oz = nullptr;

    [[nodiscard]] Vec3d operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
    [[nodiscard]] Vec3d origin(std::size_t k, const Vec3d& common) const {
        return ox == nullptr ? common : Vec3d{ox[k], oy[k], oz[k]};
    }
    // Those from the k-th on.
    [[nodiscard]] RayColumns from(std::size_t k) const {
        if (ox == nullptr) return {x + k, y + k, z + k};
        return {x + k, y + k, z + k, ox + k, oy + k, oz + k};
    }
};

// Some of a bundle's rays, which lie closer together, numbered as their owner likes; its own parts
// are others of the same array. Windows on which much is to be done are made for each part alone.
struct BundlePart {
    Vec3d axis;
    double spread = 0;
    Vec3d origin;                      // the bundle's own, unless its rays have different ones
    double radius = 0;                 // likewise
    std::uint32_t first = 0, end = 0;  // rays
    std::uint32_t first_part = 0, end_of_parts = 0;  // after this one in the array; none: equal
};

[[nodiscard]] inline BundlePart whole_of(const Bundle& bundle) {
    return {.axis = bundle.axis,
            .spread = bundle.spread,
            .origin = bundle.origin,
            .radius = bundle.radius};
}

// A wider bundle that others are parts of, and a list that is valid on it.
// What is bounded on long stretches of it is kept as long as `number` stays the same, and so shared
// by those who come one after another.
struct CommonBundle {
    Bundle bundle;
    const ElementList* list = nullptr;
    // Not 0; another one for each field, list and bundle, and for all else that `build` is given.
    std::uint64_t number = 0;
};

}  // namespace ivory
