// A convex polygon in a plane of space: what polygons are made of. Its numbers (SkeletonColumns), with the
// element's first vertex a as origin of the plane's coordinates x = v.e1, y = v.e2, h = v.n for v = p - a:
// a frame, and each edge as where it begins, its unit tangent and its length, counterclockwise.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/interval/rounding.h"
#include "core/math/vec3.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// Where its numbers stand.
namespace convex_part {

// How many edges; the margin below; the frame's three unit vectors; the least of its edges and of the
// distances between a vertex and an edge that it is not on; a circle in the plane that holds it: centre
// and radius, rounded up; the edges: x, y, tangent, length.
inline constexpr std::size_t at_count = 0, at_margin = 1, at_n = 2, at_e1 = 5, at_e2 = 8,
                             at_least = 11, at_center = 12, at_radius = 14, at_edges = 15,
                             per_edge = 5, most_edges = 16,
                             most_numbers = at_edges + per_edge * most_edges;

// What is known of the numbers. With E >= 1 as `convex_parts` found it, unit vectors and tangents are
// within 1.1 E u of those of an exact frame, u their own unit roundoff, and coordinates within 1.1 E u S,
// where S is the skeleton's size (its vertices' greatest distance from a). Then with L = |v|, v off by eta,
//   - (x, y, h) is off by eta + 7 E u L: as if p were that far away, which moves a distance by no more;
//   - the distance above an edge is off by less than tau = margin (|x| + |y| + S), margin = 8 E u;
//   - what leads from the clamped foot on an edge to p is off by 7 E u (1.5 L + S) + 3 E u S.
// `nearest_in_plane` takes a p for inside where it is above all edges by tau or more: then it is. If it is
// inside without being taken for that, it is within 2 tau of some edge's line, and so, in a convex
// polygon, of the boundary. Outside, a foot that lies within an edge which p is not above is the nearest
// place, in exact arithmetic the only such; an edge that is taken for it by mistake is within 2 tau of p,
// or its foot within the errors above of the end that is. Else the nearest of the clamped feet is taken.
// All in all the distance is off by at most
//     eta + margin (5.5 L + 3.5 S),
// and what leads from the nearest place to p by that and, where two vertices far apart are as good as
// equally near, by sqrt(8 tau D) at the most; that takes an edge, or the way from a vertex to an edge, of
// less than that length: l. Both are below
//     margin (L + S)^2 12 / l + 4 tau.
[[nodiscard]] constexpr double value_error(double eta, double margin, double reach, double size) {
    return eta + margin * (5.5 * reach + 3.5 * size);
}
[[nodiscard]] constexpr double turn_error(double margin, double reach, double size, double least) {
    const double all = reach + size;
    return margin * all * (12 * all / least + 6);
}

// From the nearest place of the part to a point of its plane; the same as the lanes' in polygon.h.
struct OffPart {
    double x, y;
};
[[nodiscard]] OffPart nearest_in_plane(std::span<const double> numbers, double size, double x,
                                       double y);

// Number k for lanes of float, lengths in units.
[[nodiscard]] constexpr float in_units(std::size_t k, double value, double per_unit) {
    if (k == at_margin) return static_cast<float>(value * (1 + 0x1p-20) + 8 * 0x1p-24);
    const bool is_direction =
        k < at_least ||
        (k >= at_edges && ((k - at_edges) % per_edge == 2 || (k - at_edges) % per_edge == 3));
    return static_cast<float>(is_direction ? value : value * per_unit);
}
[[nodiscard]] inline std::size_t size_of(std::span<const double> numbers) {
    return at_edges + per_edge * static_cast<std::size_t>(numbers[at_count]);
}

}  // namespace convex_part

// The convex parts of a polygon without fault, of at most convex_part::most_edges edges each: its vertices,
// projected on the plane through the first one with the Newell normal, in triangles (ear clipping), these
// joined where they stay convex (Hertel and Mehlhorn 1983). `columns.a` is the first vertex, m the normal,
// `parameter` the size.
[[nodiscard]] std::vector<SkeletonPart> convex_parts(std::span<const Vec3d> vertices);

// What is wrong with three or more finite vertices: not in a plane, no area, not simple. Nothing, or a
// sentence that goes on "the vertices ...".
[[nodiscard]] std::optional<std::string> polygon_fault(std::span<const Vec3d> vertices);

}  // namespace ivory
