// What the surface is like where the rays of a bundle meet it, as structure of arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "core/field/element_filter.h"
#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

// What pixels are shaded from: normals and colours; nx is NaN where there is no surface, or none
// found yet.
struct Looks {
    static constexpr std::size_t room = RayBundle::room;

    alignas(64) std::array<float, room> nx, ny, nz, r, g, b;

    // The first `count`, and as many more as a vector that is read whole has.
    void forget_all(std::size_t count) {
        std::fill_n(nx.begin(), std::min(count + 16, room),
                    std::numeric_limits<float>::quiet_NaN());
    }
    // So many from number k on are what those from number i on are there.
    template <std::size_t count>
    void take(std::size_t k, const Looks& from, std::size_t i) {
        const auto copy = [&](const std::array<float, room>& there, std::array<float, room>& here) {
            std::memcpy(&here[k], &there[i], count * sizeof(float));
        };
        copy(from.nx, nx);
        copy(from.ny, ny);
        copy(from.nz, nz);
        copy(from.r, r);
        copy(from.g, g);
        copy(from.b, b);
    }
    // Whether there is a surface at one of number first .. end - 1.
    [[nodiscard]] bool any(std::size_t first, std::size_t end) const {
        bool found = false;
        for (std::size_t k = first; k < end; ++k) found |= !std::isnan(nx[k]);
        return found;
    }
};

struct BundleSurfaces : Looks {
    // Whether `points` are wanted too: the same in double, as answers tell them.
    bool exact = false;
    std::array<SurfacePoint, RayBundle::capacity> points;
    // Whether `elements` are: those that colours were mixed of. No other one's colour matters.
    bool wants_elements = false;
    ElementFilter elements;

    // Nothing is found yet.
    void clear(std::size_t count) {
        forget_all(count);
        elements = {};
        if (!exact) return;
        for (std::size_t k = 0; k < count; ++k) {
            points[k].normal.x = std::numeric_limits<double>::quiet_NaN();
        }
    }
    void mix(std::span<const std::uint32_t> mixed) {
        if (wants_elements) elements.add(mixed);
    }
    // Of whatever elements.
    void set(std::size_t k, const SurfacePoint& point) {
        elements.add_all();
        set_seen(k, point);
        if (exact) points[k] = point;
    }
    void set_seen(std::size_t k, const SurfacePoint& point) {
        nx[k] = static_cast<float>(point.normal.x);
        ny[k] = static_cast<float>(point.normal.y);
        nz[k] = static_cast<float>(point.normal.z);
        r[k] = static_cast<float>(point.color.x);
        g[k] = static_cast<float>(point.color.y);
        b[k] = static_cast<float>(point.color.z);
    }
    void forget(std::size_t k) { nx[k] = std::numeric_limits<float>::quiet_NaN(); }
    [[nodiscard]] bool seen(std::size_t k) const { return !std::isnan(nx[k]); }
    [[nodiscard]] bool found(std::size_t k) const {
        return seen(k) && !(exact && std::isnan(points[k].normal.x));
    }
};

}  // namespace ivory
