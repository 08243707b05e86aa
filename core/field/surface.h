// The field and its surface at one point: value, gradient, colour.
#pragma once

#include <cstdint>
#include <span>

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/math/vec3.h"

namespace ivory {

// At one point, to nearest: relative errors of a few units in the last place of the largest term.
struct FieldSample {
    double value = 0;  // f = sum of F_i - T
    Vec3d gradient;    // of f, per scene unit; 0 where it is undefined
    Vec3d color;       // sum of color_i max(F_i, 0) / sum of max(F_i, 0); 0 where no F_i > 0
    std::uint32_t strongest =
        0;  // index into Field: the element with the greatest |F_i|, its nearest part
};

// At the point origin + t direction of exact arithmetic: it is not rounded to doubles on the way,
// so far origins cost no accuracy. An empty list gives value -T.
[[nodiscard]] FieldSample sample(const Field& field, const ElementList& list, const Vec3d& origin,
                                 const Vec3d& direction, double t);

// At the point p, over all elements.
[[nodiscard]] FieldSample sample(const Field& field, const Vec3d& p);

// d / w of element i at the point that is `from_a` from its a, its position or centre, to nearest:
// off by less than 2^-45 (|from_a| + its length + its radius) / w.
[[nodiscard]] double distance_in_widths(const Field& field, std::size_t i, const Vec3d& from_a);

// F at the point p of the element that the field has these parts of, one or more.
[[nodiscard]] double element_value(const Field& field, std::span<const std::uint32_t> parts,
                                   const Vec3d& p);

}  // namespace ivory
