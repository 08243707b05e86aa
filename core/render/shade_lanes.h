// The arithmetic of shade.h for many pixels at a time, in float and SIMD.
// Nothing is fused: from the same floats every instruction set makes the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/render/shade.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

// colors[k]: the light from the surface along ray k, or the background where looks.nx[k] is NaN.
void shade_lanes(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                 std::span<Rgba8> colors);

// Linear light, each 0..1.
struct LightColumns {
    static constexpr std::size_t room = RayBundle::room;
    alignas(64) std::array<float, room> r, g, b;
};

// The same before it is rounded to bytes, of the first `size` pixels.
void light_lanes(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                 std::size_t size, LightColumns& light);

}  // namespace ivory
