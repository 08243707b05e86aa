#include "core/trace/methods/bisection.h"

#include <array>
#include <cmath>

#include "core/field/kernel.h"
#include "core/field/surface.h"
#include "core/trace/clip.h"

namespace ivory {
namespace {

using Number = Interval<double>;
using Point = Vec3<Number>;

Point point(const Vec3d& p) { return {Number(p.x), Number(p.y), Number(p.z)}; }

// As the paper has it: the sum of squares of intervals that know nothing of each other.
Number square(const Point& v) { return sqr(v.x) + sqr(v.y) + sqr(v.z); }

// 3-1: d = |C - P|.
Number square_to_point(const Point& c, const Point& p) { return square(c - p); }

// 3-2: with M = B - A and the foot t = M.(P - A) / |M|^2, the distance to A for t <= 0, to A + t M
// between, to B for t >= 1; the hull of the cases that [t] allows.
Number square_to_segment(const Point& a, const Point& b, const Point& p) {
    const Point m = b - a;
    const Number length_square = square(m);
    if (length_square.hi == 0) return square_to_point(a, p);
    const Number t = dot(m, p - a) / length_square;
    Number s = Number::empty_set();
    if (is_empty(t) || t.lo <= 0) s = hull(s, square_to_point(a, p));
    if (is_empty(t) || t.hi >= 1) s = hull(s, square_to_point(b, p));
    const Number between = intersection(t, Number(0.0, 1.0));
    if (!is_empty(between)) s = hull(s, square(p - (a + between * m)));
    return s;
}

// 3-3: d^2 = r^2 + |C - P|^2 - 2 r |P - C - (N.(P - C)) N|, expanded as printed.
Number square_to_circle(const Point& c, const Point& n, const Number& r, const Point& p) {
    const Point v = p - c;
    const Number across = sqrt(square(v - dot(n, v) * n));
    return sqr(r) + square(v) - Number(2.0) * r * across;
}

// f(P) over a box of points, with what the list has left out.
Number natural_extension(const Field& field, const ElementList& list, const Point& p) {
    Number sum = list.rest - Number(field.threshold);
    for (const std::uint32_t i : list.elements) {
        Number s;
        switch (field.shape[i]) {
            case Shape::point:
                s = square_to_point(point(field.a(i)), p);
                break;
            case Shape::segment:
                s = square_to_segment(point(field.a(i)), point(field.b(i)), p);
                break;
            case Shape::circle: {
                const Point n = point(field.b(i));
                const Number length = sqrt(square(n));
                s = square_to_circle(point(field.a(i)), {n.x / length, n.y / length, n.z / length},
                                     Number(field.radius[i]), p);
                break;
            }
        }
        s = s / sqr(Number(field.width[i]));
        // A square whose numbers overflowed bounds nothing but the kernel's own range.
        const Number k = is_empty(s) ? Number(0.0, 1.0)
                                     : kernel_over(field.kernel[i], {std::fmax(s.lo, 0.0), s.hi});
        sum += Number(field.strength[i]) * k;
    }
    return sum;
}

double value(const Field& field, const ElementList& list, const Vec3d& p) {
    return sample(field, list, p, Vec3d{1, 0, 0}, 0).value;
}

// A ray that grazes the surface over a long way meets very many intervals that may hold a root.
constexpr std::uint64_t evaluation_budget = 1'000'000;

}  // namespace

Isolation Bisection::isolate(const Field& field, const ElementList& list, const Ray& ray,
                             const MethodOptions& options, Counts& counts) const {
    const Isolation miss{Status::miss, Interval<double>::empty_set()};
    if (list.certainly_empty) return miss;
    const ScaledRay scaled_ray = scaled(ray);
    const Interval<double> span = clip(scaled_ray, field.box);
    if (is_empty(span)) return miss;
    if (!(span.hi < infinity<double>)) return {Status::unresolved, {0.0, infinity<double>}};

    const Point origin = point(scaled_ray.origin);
    Point direction = point(scaled_ray.direction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // A component that underflowed when the ray was scaled.
        const double d = scaled_ray.direction[axis];
        if (std::abs(d) < std::numeric_limits<double>::min() && ray.direction[axis] != 0) {
            direction[axis] = {next_down(d), next_up(d)};
        }
    }
    const double least_width = options.tolerance * field.least_width /
                               std::sqrt(dot(scaled_ray.direction, scaled_ray.direction));

    // The right halves that wait while the left ones are searched: one for each halving.
    std::array<Interval<double>, 2200> waiting;
    std::size_t depth = 0;
    waiting[depth++] = span;
    std::uint64_t evaluations = 0;
    Isolation result = miss;
    while (depth > 0) {
        const Interval<double> t = waiting[--depth];
        if (++evaluations > evaluation_budget) {
            result = {Status::unresolved, {t.lo, span.hi}};
            break;
        }
        const Number f = natural_extension(field, list, origin + t * direction);
        if (!contains(f, 0.0)) continue;
        const double middle = midpoint(t);
        if (width(t) <= least_width || middle <= t.lo || middle >= t.hi) {
            result = {Status::claimed_hit, t};
            break;
        }
        waiting[depth++] = {middle, t.hi};
        waiting[depth++] = {t.lo, middle};
    }
    counts.evaluations += evaluations;
    counts.element_evaluations += evaluations * list.elements.size();
    result.t = scaled_ray.unscaled(result.t);
    return result;
}

// 5.2 and 6: normal f(x - delta) - f(x + delta) for each axis; 5.3: C = sum C_i F_i / T.
SurfacePoint Bisection::surface(const Field& field, const ElementList& list, const Ray& ray,
                                double m, const MethodOptions& options) const {
    const Vec3d p = ray.origin + m * ray.direction;
    const double delta = options.difference_delta * field.least_width;
    Vec3d gradient;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3d before = p, after = p;
        before[axis] -= delta;
        after[axis] += delta;
        gradient[axis] = value(field, list, after) - value(field, list, before);
    }
    Vec3d color;
    for (const std::uint32_t i : list.elements) {
        color = color + (element_value(field, i, p) / field.threshold) * field.color[i];
    }
    return {outward_normal(gradient), color};
}

}  // namespace ivory
