// What a skeleton of several parts is to a field: parts that stand side by side, each with the mathematics
// of a shape of its own. Of one element F = b max over its parts of k(s), k falls: the nearest part
// decides. So along a ray, for x = t - t0 and whatever part decides at t,
//     F / b <= max over the parts of (k(t0) + k'(t0) x) + (the greatest k'' of any) x^2 / 2,
// and not less with any one part in the place of the maximum: bounds of the value are maxima, those of
// derivatives hulls over the parts that may decide, and kinks need no case of their own.
#pragma once

#include "core/shape/along_ray.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

template <class Part>
struct JoinedParts {
    friend bool operator==(const JoinedParts&, const JoinedParts&) = default;

    static constexpr bool is_joined = true, has_numbers = Part::has_numbers;
    static constexpr bool has_kinks = Part::has_kinks, is_taper = Part::is_taper;
    static constexpr bool has_axis = Part::has_axis;
    static constexpr int m_power = Part::m_power, parameter_power = Part::parameter_power;

    static Surroundings surroundings(const SkeletonColumns& c) { return Part::surroundings(c); }
    static Box3 box(const SkeletonColumns& c) { return Part::box(c); }
    static Ball ball(const SkeletonColumns& c) { return Part::ball(c); }
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        return Part::farthest(c, from, direction);
    }
    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        return Part::nearest(c, from_a, width);
    }
    static bool along_ray(const SkeletonColumns& c, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        return Part::along_ray(c, width, ray, e);
    }
    static void see(const SkeletonColumns& c, const natural::Span& scale,
                    const natural::Vector& origin, const natural::Vector& start,
                    const natural::Vector& rate, natural::RaySkeleton& e) {
        Part::see(c, scale, origin, start, rate, e);
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return Part::square(e, t);
    }
};

}  // namespace ivory
