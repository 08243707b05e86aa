// One element along a ray: its skeleton's s(t) = q^2 (core/shape/along_ray.h), and what of its kernel
// the ray can meet at all.
#pragma once

#include "core/field/field.h"
#include "core/interval/interval.h"
#include "core/kernel/kernels.h"
#include "core/math/vec3.h"
#include "core/shape/along_ray.h"

namespace ivory {

// One element seen from one ray, for t in a span.
struct ElementAlongRay : SkeletonAlongRay {
    KernelKind kernel = KernelKind::blinn;
    double strength = 1;
    double least = 0;                   // a lower bound of s over the span
    double peak = 1;                    // an upper bound of k over the span
    Interval<double> beyond{0.0, 0.0};  // of strength k(s) outside of `active`
    bool joins = false;                 // the next one is another part of the same element
};

// Element i of the field along origin + t direction, t in the finite `span`; the largest component
// of `direction` has to lie in [1, 2). `cut` bounds `active`: a value of s beyond which k counts as
// nothing.
void along_ray(const Field& field, std::size_t i, const Vec3d& origin, const Vec3d& direction,
               const Interval<double>& span, double cut, ElementAlongRay& result);

}  // namespace ivory
