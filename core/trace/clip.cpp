#include "core/trace/clip.h"

#include <cmath>

#include "core/interval/slabs.h"

namespace ivory {

Interval<double> ScaledRay::unscaled(const Interval<double>& t) const {
    const auto scale = [&](double x) { return std::ldexp(x, shift); };
    const auto exact = [&](double x) { return std::ldexp(scale(x), -shift) == x; };
    if (is_empty(t)) return t;
    const double lo = scale(t.lo), hi = scale(t.hi);
    return {exact(t.lo) ? lo : std::fmax(next_down(lo), 0.0), exact(t.hi) ? hi : next_up(hi)};
}

ScaledRay scaled(const Ray& ray) {
    const Vec3d& d = ray.direction;
    int exponent = 0;
    std::frexp(std::fmax(std::abs(d.x), std::fmax(std::abs(d.y), std::abs(d.z))), &exponent);
    const int shift = 1 - exponent;
    return {ray.origin,
            {std::ldexp(d.x, shift), std::ldexp(d.y, shift), std::ldexp(d.z, shift)},
            shift};
}

Interval<double> clip(const ScaledRay& ray, const Box3& box) {
    if (box.empty()) return Interval<double>::empty_set();
    // smaller components may have lost digits and bound nothing
    Interval<double> span = within_slabs(box, ray.origin, ray.direction, 1e-250);
    if (!is_empty(span)) span.hi = next_up(span.hi);
    return span;
}

}  // namespace ivory
