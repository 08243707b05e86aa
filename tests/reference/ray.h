// A ray as the reference takes it: p(t) = origin + t direction for t >= 0.
#pragma once

#include <concepts>
#include <type_traits>

#include "core/math/vec3.h"

namespace ivory::reference {

struct Ray {
    Vec3d origin, direction;

    Ray() = default;
    Ray(const Vec3d& o, const Vec3d& d) : origin(o), direction(d) {}
    // Core's, which is none of the reference's business.
    template <class Other>
    requires(!std::is_same_v<Other, Ray> &&
             requires(const Other& other) {
                 { other.direction } -> std::convertible_to<Vec3d>;
             }) Ray(const Other& other)
        : origin(other.origin), direction(other.direction) {}
};

}  // namespace ivory::reference
