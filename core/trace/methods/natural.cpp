#include "core/trace/methods/natural.h"

#include <cmath>

#include "core/interval/quick.h"

namespace ivory::natural {
namespace {

using Vector = Vec3<Span>;

Vector minus(const Vector& a, const Vector& b) {
    return {quick::sub(a.x, b.x), quick::sub(a.y, b.y), quick::sub(a.z, b.z)};
}

Vector times(const Span& s, const Vector& v) {
    return {quick::mul(s, v.x), quick::mul(s, v.y), quick::mul(s, v.z)};
}

Span inner(const Vector& a, const Vector& b) {
    return quick::add(quick::add(quick::mul(a.x, b.x), quick::mul(a.y, b.y)),
                      quick::mul(a.z, b.z));
}

Vector vector(const Vec3d& p) { return {Span(p.x), Span(p.y), Span(p.z)}; }

LinearVector moving(const Vector& start, const Vector& rate) {
    return {{start.x, rate.x}, {start.y, rate.y}, {start.z, rate.z}};
}

// N / |N|; the power of two takes care of numbers whose squares over- or underflow.
Vector unit(const Vec3d& n) {
    const double largest = std::fmax(std::abs(n.x), std::fmax(std::abs(n.y), std::abs(n.z)));
    int exponent = 0;
    std::frexp(largest, &exponent);
    Vector m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x = std::ldexp(n[axis], -exponent);
        m[axis] = std::ldexp(x, exponent) == n[axis] ? Span(x) : Span(next_down(x), next_up(x));
    }
    return times(quick::div(Span(1.0), quick::sqrt(inner(m, m))), m);
}

}  // namespace

void RayField::build(const Field& field, const ElementList& list, const Ray& ray,
                     const ScaledRay& scaled_ray) {
    elements_.clear();
    constant_ = list.rest - Span(field.threshold);
    const Vector origin = vector(scaled_ray.origin);
    Vector direction = vector(scaled_ray.direction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // A component that underflowed when the ray was scaled.
        const double d = scaled_ray.direction[axis];
        if (std::abs(d) < std::numeric_limits<double>::min() && ray.direction[axis] != 0) {
            direction[axis] = {next_down(d), next_up(d)};
        }
    }
    for (const std::uint32_t i : list.elements) {
        RayElement& e = elements_.emplace_back();
        e.shape = field.shape[i];
        e.kernel = field.kernel[i];
        e.strength = Span(field.strength[i]);
        const Span scale = quick::div(Span(1.0), Span(field.width[i]));
        const Vector rate = times(scale, direction);
        const Vector start = times(scale, minus(origin, vector(field.a(i))));
        e.from = moving(start, rate);
        if (e.shape == Shape::segment) {
            e.axis = times(scale, minus(vector(field.b(i)), vector(field.a(i))));
            const Span length_square = inner(e.axis, e.axis);
            if (field.a(i) == field.b(i)) {
                e.shape = Shape::point;
            } else if (!(length_square.lo > 1e-250)) {
                e.bounded = false;
            } else {
                e.from_b = moving(times(scale, minus(origin, vector(field.b(i)))), rate);
                e.along = {quick::div(inner(e.axis, start), length_square),
                           quick::div(inner(e.axis, rate), length_square)};
                e.across = moving(minus(start, times(e.along.start, e.axis)),
                                  minus(rate, times(e.along.rate, e.axis)));
            }
        } else if (e.shape == Shape::circle) {
            if (field.radius[i] == 0) {
                e.shape = Shape::point;
                continue;
            }
            const Vector n = unit(field.b(i));
            e.radius = quick::mul(scale, Span(field.radius[i]));
            e.along = {inner(n, start), inner(n, rate)};
            e.across = moving(minus(start, times(e.along.start, n)),
                              minus(rate, times(e.along.rate, n)));
        }
    }
}

}  // namespace ivory::natural
