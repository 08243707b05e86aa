#include "core/trace/methods/lipschitz.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

}  // namespace

double steepest_beyond(KernelKind kind, double q) {
    return with_kernel(kind, [&]<class K>() { return K::steepest_beyond(q); });
}

double lipschitz_bound(const Field& field, const ElementList& list, const ScaledRay& ray,
                       int exponent) {
    const double speed = std::sqrt(dot(ray.direction, ray.direction));
    double sum = 0;
    const auto steepest_of = [&](std::uint32_t i) {
        const Ball ball =
            with_field_shape(field.shape[i], [&]<class S>() { return S::ball(field.columns(i)); });
        const Vec3d away = ball.center - ray.origin;
        const Vec3d moment = cross(away, ray.direction);
        // Each component of the cross product errs by less than 4 u |away| |direction|.
        const double least = std::sqrt(dot(moment, moment)) * (1 - 8 * u) -
                             16 * u * one_norm(away) * one_norm(ray.direction);
        const double distance = least / speed * (1 - 8 * u) - ball.radius * (1 + 4 * u);
        const double q = distance > 0 ? distance / field.greatest_width_of(i) * (1 - 8 * u) : 0;
        const double strength = std::ldexp(std::abs(field.strength[i]), -exponent);
        return strength * steepest_beyond(field.kernel[i], q) / field.width[i] + 1e-300;
    };
    for_elements(field, list.elements, [&](std::span<const std::uint32_t> parts) {
        double steepest = 0;
        for (const std::uint32_t i : parts) steepest = std::max(steepest, steepest_of(i));
        sum += steepest;
    });
    return sum * speed * (1 + (static_cast<double>(list.elements.size()) + 16) * u);
}

}  // namespace ivory
