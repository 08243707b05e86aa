// The part of a ray that can meet the surface, and the ray in units that no later formula overflows
// in.
#pragma once

#include "core/field/field.h"
#include "core/interval/interval.h"
#include "core/trace/ray.h"

namespace ivory {

// direction * 2^shift, its largest component in [1, 2); ray t = scaled t * 2^shift. Exact but for
// components that underflow to within 2^-1074 of their value, which along_ray.h accounts for.
struct ScaledRay {
    Vec3d origin;
    Vec3d direction;
    int shift = 0;

    // Scaled t to the ray's own t, outward.
    [[nodiscard]] Interval<double> unscaled(const Interval<double>& t) const;
};

[[nodiscard]] ScaledRay scaled(const Ray& ray);

// The scaled t >= 0 outside of which the ray is outside of `box`: rounded outward, so that the ray
// is outside at its upper end too. Empty: the ray misses the box.
[[nodiscard]] Interval<double> clip(const ScaledRay& ray, const Box3& box);

}  // namespace ivory
