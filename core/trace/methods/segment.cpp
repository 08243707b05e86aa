#include "core/trace/methods/segment.h"

#include <algorithm>

#include "core/field/inclusion.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

constexpr int evaluation_budget = 100'000;
constexpr double growth = 2;  // of the next segment over the last step

}  // namespace

Isolation SegmentTracing::isolate(const Field& field, const ElementList& list, const Ray& ray,
                                  const MethodOptions& options, Counts& counts) const {
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local FieldAlongRay along;
    along.build(field, list, search.ray.origin, search.ray.direction, search.span);

    const double end = search.span.hi;
    double t = search.span.lo;
    double segment = field.least_width / search.speed;
    int evaluations = 0;
    Isolation result = search.answer;
    while (t < end) {
        if (evaluations == evaluation_budget || counts.stop.requested()) {
            result = search.result(Status::unresolved, {t, end});
            break;
        }
        ++evaluations;
        counts.add(1, along.size());
        const double ahead = std::min(end, std::max(t + segment, next_up(t)));
        const Enclosure f = along.over(t, ahead);
        const double clear = std::max(std::max(-f.left.hi, f.left.lo), 0.0);
        const double steepest = std::max(f.slope.hi, -f.slope.lo);
        const double step = clear / steepest * (1 - 8 * unit_roundoff);
        const bool all = step >= sub_up(ahead, t) || (steepest == 0 && clear > 0);
        if (!all && !(step > search.tolerance)) {
            result = search.result(Status::claimed_hit, {t, add_up(t, search.tolerance)});
            break;
        }
        const double next = all ? ahead : add_down(t, step);
        if (!(next > t)) {
            result = search.result(Status::claimed_hit, {t, next_up(t)});
            break;
        }
        if (next >= end && f.left.lo > 0) {
            // f < 0 beyond the span: a root before its end, unless rounding has the last word.
            result = search.result(Status::claimed_hit, {t, end});
            break;
        }
        segment = growth * (next - t);
        t = next;
    }
    return result;
}

}  // namespace ivory
