// Seeded scenes of one shape in a position that formulas get wrong, with the rays that meet it there:
// exactly where coordinates allow it (they are small multiples of powers of two in the frame of a
// few whole numbers), and beside it by 1e-3 .. 1e-14 of its size.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/trace/ray.h"
#include "tests/reference/scene.h"

namespace ivory::tools {

enum class Family {
    curve_in_plane,   // a flat curve, rays in its plane
    curve_cusp,       // rays at and through a cusp
    curve_loop,       // rays at and through where a curve meets itself
    curve_collinear,  // control points on a line, some doubling back; rays along it
    curve_point,      // control points that are all equal
    polygon_edge_on,  // rays parallel to a polygon's plane, next to it
    polygon_plane,    // rays in it
    polygon_vertex,   // rays through vertices
    polygon_edge,     // rays along edges
    taper_axis,       // rays along a taper's axis
    taper_line,       // rays along a straight line of the surface of its cone
    taper_apex,       // rays through the cone's apex
    taper_swallow,    // one end ball holds the other, or nearly does
    coincident,       // neighbours of a chain, or a segment's ends, in one place
    disc_edge_on,     // rays parallel to a disc's plane, next to it
    disc_axis,        // rays along its axis
    disc_rim,         // rays through its rim
    disc_plane,       // rays in its plane
};

inline constexpr std::array<std::string_view, 18> family_words{
    "curve_in_plane",  "curve_cusp",    "curve_loop",     "curve_collinear", "curve_point",
    "polygon_edge_on", "polygon_plane", "polygon_vertex", "polygon_edge",    "taper_axis",
    "taper_line",      "taper_apex",    "taper_swallow",  "coincident",      "disc_edge_on",
    "disc_axis",       "disc_rim",      "disc_plane"};

struct DegenerateCase {
    reference::ReferenceScene scene;
    std::vector<Ray> rays;
};

// Kernels and signs of the strength go by turns with the seed; where the shape carves there is
// something to carve from. Thresholds from 0.1 to 0.6.
[[nodiscard]] DegenerateCase degenerate_case(Family family, std::uint64_t seed);

// As a scene file, and as a file of rays in C hexadecimal.
[[nodiscard]] std::string scene_text(const reference::ReferenceScene& scene);
[[nodiscard]] std::string rays_text(const std::vector<Ray>& rays);

}  // namespace ivory::tools
