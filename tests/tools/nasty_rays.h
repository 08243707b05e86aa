// Seeded rays for a scene, ordinary ones and those that renderers get wrong.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory::tools {

enum class RayKind {
    random,    // through the neighbourhood of the scene
    tangent,   // on both sides of a silhouette, off by 1e-4 .. 1e-15 of the way between two rays
    axis,      // along the axis of a circle, 1e-8 and 1e-14 beside it, and across it
    segment,   // along a segment and beside it, through its ends; through points
    inside,    // from the skeleton of a positive element
    scaled,    // |d| from 1e-6 to 1e6, 1e-150 and 1e150
    parallel,  // to an axis of coordinates
    surface,   // from a point that rounds to the surface
    far,       // from 1e6 times the size of the scene away
};

inline constexpr std::array<std::string_view, 9> ray_kind_words{
    "random", "tangent", "axis", "segment", "inside", "scaled", "parallel", "surface", "far"};

// About `count` rays of the kind; none of a kind that the scene has no place for.
[[nodiscard]] std::vector<Ray> nasty_rays(const Scene& scene, RayKind kind, std::size_t count,
                                          std::uint64_t seed);

}  // namespace ivory::tools
