#include "core/trace/methods/march.h"

#include "core/trace/methods/natural_numbers.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

constexpr std::uint64_t evaluation_budget = 1'000'000;

}  // namespace

Isolation Marching::isolate(const Field& field, const ElementList& list, const Ray& ray,
                            const MethodOptions& options, Counts& counts) const {
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local natural::RayField along;
    along.build(field, list, ray, search.ray);

    std::uint64_t evaluations = 0;
    const auto at = [&](double t) {
        ++evaluations;
        counts.add(1, list.elements.size());
        return natural::extension(along, natural::Plain{t}).x;
    };
    const auto answer = [&]() -> Isolation {
        const double stride = step * field.least_width / search.speed;
        double before = search.span.lo;
        const bool inside = at(before) > 0;
        for (double n = 1; before < search.span.hi; ++n) {
            if (evaluations >= evaluation_budget || counts.stop.requested()) {
                return search.result(Status::unresolved, search.span);
            }
            double after = search.span.lo + n * stride;
            if ((at(after) > 0) == inside) {
                before = after;
                continue;
            }
            while (after - before > search.tolerance) {
                const double middle = 0.5 * (before + after);
                if (middle <= before || middle >= after || counts.stop.requested()) break;
                ((at(middle) > 0) == inside ? before : after) = middle;
            }
            if (counts.stop.requested()) return search.result(Status::unresolved, search.span);
            return search.result(Status::claimed_hit, {before, after});
        }
        return {Status::claimed_miss, Interval<double>::empty_set()};
    };
    return answer();
}

}  // namespace ivory
