// Lengths and unit vectors in plain double, safe where squares would over- or underflow.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/vec3.h"

namespace ivory {

[[nodiscard]] inline double length_of(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

// v / |v| for a finite v that is not 0. The scaling by a power of two changes nothing but the
// range: where the plain formula neither over- nor underflows, it gives the same doubles.
[[nodiscard]] inline Vec3d unit(const Vec3d& v) {
    int exponent = 0;
    std::frexp(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}), &exponent);
    const Vec3d w{std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent),
                  std::ldexp(v.z, -exponent)};
    const double length = std::sqrt(dot(w, w));
    return {w.x / length, w.y / length, w.z / length};
}

}  // namespace ivory
