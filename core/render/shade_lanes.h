// The arithmetic of shade.h for many pixels at a time in SIMD.
// Nothing is fused: every instruction set gives the same doubles.
#pragma once

#include <array>
#include <cstddef>

#include "core/render/shade.h"

namespace ivory {

// What light falls on, as structure of arrays; whatever stands beyond `count` is never looked at.
struct ShadingLanes {
    static constexpr std::size_t capacity = 256;

    std::size_t count = 0;
    alignas(64) std::array<double, capacity> dx, dy, dz;  // of the ray, length 1
    alignas(64) std::array<double, capacity> nx, ny, nz;  // normal, length 1, or 0
    alignas(64) std::array<double, capacity> r, g, b;  // in: the surface's colour; out: the light

    void add(const Vec3d& direction, const SurfacePoint& surface) {
        dx[count] = direction.x;
        dy[count] = direction.y;
        dz[count] = direction.z;
        nx[count] = surface.normal.x;
        ny[count] = surface.normal.y;
        nz[count] = surface.normal.z;
        r[count] = surface.color.x;
        g[count] = surface.color.y;
        b[count] = surface.color.z;
        ++count;
    }
};

// r, g, b: from the surface's colour to the linear light that reaches the eye.
void shade_lanes(const Lighting& lighting, ShadingLanes& lanes);

}  // namespace ivory
