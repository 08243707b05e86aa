#include "core/trace/methods/sphere.h"

#include <algorithm>

#include "core/field/inclusion.h"
#include "core/trace/methods/lipschitz.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

// Steps shrink with the distance: a ray that grazes the surface takes very many.
constexpr int evaluation_budget = 100'000;

}  // namespace

Isolation SphereTracing::isolate(const Field& field, const ElementList& list, const Ray& ray,
                                 const MethodOptions& options, Counts& counts) const {
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local FieldAlongRay along;
    along.build(field, list, search.ray.origin, search.ray.direction, search.span);
    const double steepest = lipschitz_bound(field, list, search.ray, along.exponent());

    const double end = search.span.hi;
    double t = search.span.lo;
    int evaluations = 0;
    Isolation result = search.answer;
    // f(t) = g(t) + r(t), r within the rest that is part of every enclosure and g with that
    // constant: beyond t, f <= (upper end of f(t)) + L (t' - t), and likewise from below.
    while (t < end) {
        if (evaluations == evaluation_budget || counts.stop.requested()) {
            result = search.result(Status::unresolved, {t, end});
            break;
        }
        ++evaluations;
        counts.add(1, along.size());
        const Interval<double> f = along.at(t);
        const double clear = std::max(std::max(-f.hi, f.lo), 0.0);
        const double step = clear / steepest * (1 - 8 * unit_roundoff);
        if (!(step > search.tolerance)) {
            result = search.result(Status::claimed_hit, {t, add_up(t, search.tolerance)});
            break;
        }
        const double next = add_down(t, step);
        if (!(next > t)) {
            result = search.result(Status::claimed_hit, {t, next_up(t)});
            break;
        }
        if (next >= end && f.lo > 0) {
            // f < 0 beyond the span: a root before its end, unless rounding has the last word.
            result = search.result(Status::claimed_hit, {t, end});
            break;
        }
        t = next;
    }
    return result;
}

}  // namespace ivory
