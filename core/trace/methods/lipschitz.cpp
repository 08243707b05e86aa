#include "core/trace/methods/lipschitz.h"

#include <algorithm>
#include <cmath>

#include "core/field/kernel.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

// A ball around the skeleton.
struct Ball {
    Vec3d center;
    double radius;  // rounded up
};

Ball ball_around(const Field& field, std::size_t i) {
    const Vec3d a = field.a(i);
    if (field.shape[i] != Shape::segment) return {a, field.radius[i]};
    const Vec3d center = 0.5 * a + 0.5 * field.b(i);
    const Vec3d from_a = center - a, from_b = field.b(i) - center;
    const double square = std::max(dot(from_a, from_a), dot(from_b, from_b));
    return {center, std::sqrt(square) * (1 + 8 * u) + 1e-150};
}

}  // namespace

double steepest_beyond(KernelKind kind, double q) {
    const double s = q * q;
    switch (kind) {
        case KernelKind::blinn:
            if (!(s > 0.5)) return 0.8577638849607070;
            return 2 * q * exp_minus(s * (1 - 2 * u), 0).hi * (1 + 8 * u) + 1e-300;
        case KernelKind::nishimura:
            if (!(q > 1.0 / 3)) return 2;
            return q < 1 ? 3 * (1 - q) * (1 + 8 * u) : 0;
        case KernelKind::wyvill:
            break;
    }
    if (!(s > 0.254)) return 1.5834298;
    return q < 1 ? 4.0 / 9 * q * (1 - s * (1 - 2 * u)) * (11 - 6 * s) * (1 + 32 * u) : 0;
}

double lipschitz_bound(const Field& field, const ElementList& list, const ScaledRay& ray,
                       int exponent) {
    const double speed = std::sqrt(dot(ray.direction, ray.direction));
    double sum = 0;
    for (const std::uint32_t i : list.elements) {
        const Ball ball = ball_around(field, i);
        const Vec3d away = ball.center - ray.origin;
        const Vec3d moment = cross(away, ray.direction);
        // Each component of the cross product errs by less than 4 u |away| |direction|.
        const double least = std::sqrt(dot(moment, moment)) * (1 - 8 * u) -
                             16 * u * one_norm(away) * one_norm(ray.direction);
        const double distance = least / speed * (1 - 8 * u) - ball.radius * (1 + 4 * u);
        const double q = distance > 0 ? distance / field.width[i] * (1 - 8 * u) : 0;
        const double strength = std::ldexp(std::abs(field.strength[i]), -exponent);
        sum += strength * steepest_beyond(field.kernel[i], q) / field.width[i] + 1e-300;
    }
    return sum * speed * (1 + (static_cast<double>(list.elements.size()) + 16) * u);
}

}  // namespace ivory
