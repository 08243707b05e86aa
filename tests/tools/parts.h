// Elements of several parts (core/shape/joined.h) as tests see them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "core/field/field.h"
#include "core/field/surface.h"
#include "core/scene/scene.h"

namespace ivory::tools {

// What part i of the field would be as an element of its own: a segment of a polyline, a convex part of a
// polygon, an arc of a curve; to nearest.
inline Element element_of_part(const Scene& scene, const Field& field, std::size_t i) {
    Element element = scene.elements[field.source[i]];
    if (has_numbers(field.shape[i])) {
        const SkeletonColumns c = field.columns(i);
        if (field.shape[i] == Shape::polygon) {
            std::vector<Vec3d> vertices;
            PolygonSkeleton::for_vertices(c,
                                          [&](const Vec3d& vertex) { vertices.push_back(vertex); });
            element.skeleton = PolygonSkeleton(std::move(vertices));
        } else {
            const auto k = [&](std::size_t at) {
                return Vec3d{c.numbers[at], c.numbers[at + 1], c.numbers[at + 2]};
            };
            const Vec3d k0 = k(curve_arc::at_k0), k1 = k(curve_arc::at_k1),
                        k2 = k(curve_arc::at_k2), k3 = k(curve_arc::at_k3);
            const Vec3d even = k0 - (1.0 / 3) * k2, odd = (1.0 / 3) * k1 - k3;
            element.skeleton = CurveSkeleton({c.a + (k0 - k1 + k2 - k3), c.a + (even - odd),
                                              c.a + (even + odd), c.a + (k0 + k1 + k2 + k3)});
        }
        return element;
    }
    const auto* chain = std::get_if<PolylineSkeleton>(&element.skeleton);
    if (chain == nullptr) return element;
    std::size_t part = 0;
    while (part < i && field.source[i - part - 1] == field.source[i]) ++part;
    if (!element.widths.empty()) {
        element.widths = {element.widths[part], element.widths[part + 1]};
        element.width = std::min(element.widths[0], element.widths[1]);
    }
    element.skeleton = Skeleton(chain->segment(part));
    return element;
}

// All parts of the field.
inline std::vector<std::uint32_t> all_parts(const Field& field) {
    std::vector<std::uint32_t> all(field.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
}

// What elements that are not kept, or not with all of their parts, add to the field at p and take away
// from it.
struct LeftOutThere {
    double above = 0, below = 0;
    int count = 0;  // parts that are out and would be there alone
};
inline LeftOutThere left_out_at(const Field& field, const std::vector<bool>& kept, const Vec3d& p) {
    LeftOutThere there;
    for_elements(field, all_parts(field), [&](std::span<const std::uint32_t> parts) {
        std::vector<std::uint32_t> kept_parts;
        for (const std::uint32_t i : parts) {
            if (kept[i]) kept_parts.push_back(i);
        }
        if (kept_parts.size() == parts.size()) return;
        double value = element_value(field, parts, p);
        there.count += value != 0;
        if (!kept_parts.empty()) value -= element_value(field, kept_parts, p);
        (value > 0 ? there.above : there.below) += std::abs(value);
    });
    return there;
}

}  // namespace ivory::tools
