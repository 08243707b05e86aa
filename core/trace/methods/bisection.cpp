#include "core/trace/methods/bisection.h"

#include <array>
#include <cmath>
#include <span>

#include "core/field/surface.h"
#include "core/interval/quick.h"
#include "core/trace/methods/natural_numbers.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

using natural::Range;
using natural::RayElement;
using natural::Span;

// The distance as the paper prints it.
Range printed_square(const RayElement& e, const Range& t) {
    if (e.collapsed) return square(e.from, t);
    return with_field_shape(e.shape, [&]<class S>() {
        // of a circle
        if constexpr (requires { S::square_as_printed(e, t); })
            return S::square_as_printed(e, t);
        else
            return S::square(e, t);
    });
}

// The sum of squares of intervals that know nothing of each other, as the paper has it, with the ray
// put in: each component of P - C is one interval, each foot on a segment too.
Range natural_extension(const natural::RayField& field, const Range& t) {
    Range sum{field.constant()};
    Range parts{Span(infinity<double>)};  // the least of an element's so far
    for (const RayElement& e : field.elements()) {
        const Range s = e.bounded ? printed_square(e, t) : Range{{0.0, infinity<double>}};
        parts = least(parts, s);
        if (e.joins) continue;
        sum = sum + times(e.strength, kernel(e.kernel, parts));
        parts = {Span(infinity<double>)};
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
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local natural::RayField along;
    along.build(field, list, ray, search.ray);

    // The right halves that wait while the left ones are searched: one for each halving.
    std::array<Interval<double>, 2200> waiting;
    std::size_t depth = 0;
    waiting[depth++] = search.span;
    std::uint64_t evaluations = 0;
    Isolation result = search.answer;
    while (depth > 0) {
        const Interval<double> t = waiting[--depth];
        ++evaluations;
        if (counts.add(1, list.elements.size()) || evaluations > evaluation_budget) {
            result = search.result(Status::unresolved, {t.lo, search.span.hi});
            break;
        }
        const Interval<double> f = natural_extension(along, {t}).x;
        if (f.hi < 0 || f.lo > 0) continue;
        const double middle = midpoint(t);
        if (width(t) <= search.tolerance || middle <= t.lo || middle >= t.hi) {
            result = search.result(Status::claimed_hit, t);
            break;
        }
        waiting[depth++] = {middle, t.hi};
        waiting[depth++] = {t.lo, middle};
    }
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
    for_elements(field, list.elements, [&](std::span<const std::uint32_t> parts) {
        const double share = element_value(field, parts, p) / field.threshold;
        color = color + share * field.color[parts[0]];
    });
    return {outward_normal(gradient), color};
}

}  // namespace ivory
