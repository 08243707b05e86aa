// Rays in a narrow cone, as structure of arrays: the primary rays of a tile.
#pragma once

#include <array>
#include <cstddef>

#include "core/field/bundle.h"
#include "core/trace/ray.h"

namespace ivory {

struct RayBundle {
    static constexpr std::size_t capacity = 256;
    static constexpr std::size_t room = capacity + 16;  // vectors are read whole

    Bundle bundle;  // holds all rays; their directions have length 1 within 2^-50
    const CommonBundle* common = nullptr;  // that this one is a part of
    std::size_t count = 0;                 // 0 .. capacity
    alignas(64) std::array<double, room> dx, dy, dz;
    // Their origins, unless all have the bundle's.
    bool has_origins = false;
    alignas(64) std::array<double, room> ox, oy, oz;
    // None, or the bundle itself and then its parts, as core/field/bundle.h wants them. What a part
    // is must not depend on which rays there are, or answers would.
    std::array<BundlePart, 21> parts;
    std::size_t part_count = 0;

    [[nodiscard]] std::size_t size() const { return count; }
    [[nodiscard]] Ray ray(std::size_t k) const {
        return {has_origins ? Vec3d{ox[k], oy[k], oz[k]} : bundle.origin, {dx[k], dy[k], dz[k]}};
    }
    [[nodiscard]] RayColumns columns() const {
        if (!has_origins) return {dx.data(), dy.data(), dz.data()};
        return {dx.data(), dy.data(), dz.data(), ox.data(), oy.data(), oz.data()};
    }
    void add_part(const BundlePart& part) { parts[part_count++] = part; }
    void add(const Vec3d& direction) {
        dx[count] = direction.x;
        dy[count] = direction.y;
        dz[count] = direction.z;
        ++count;
    }
    // One that has its own origin, if it has_origins.
    void add(const Ray& ray) {
        if (has_origins) {
            ox[count] = ray.origin.x;
            oy[count] = ray.origin.y;
            oz[count] = ray.origin.z;
        }
        add(ray.direction);
    }
};

}  // namespace ivory
