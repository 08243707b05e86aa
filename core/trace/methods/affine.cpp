#include "core/trace/methods/affine.h"

#include <array>

#include "core/interval/quick.h"
#include "core/trace/methods/affine_form.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

constexpr std::uint64_t evaluation_budget = 100'000;

// The part of `t` where mid + lin e + [-err, err] can be 0, e = (t - t.mid) / t.lin.
Interval<double> possible_zeros(const natural::Affine& f, const natural::Affine& t,
                                const Interval<double>& all) {
    const bool finite = f.err < infinity<double> && std::abs(f.mid) < infinity<double>;
    if (!finite || !(std::abs(f.lin) > 0)) return all;
    const Interval<double> e =
        quick::div(quick::sub(Interval<double>(-f.err, f.err), Interval<double>(f.mid)),
                   f.lin > 0 ? Interval<double>(f.lin) : Interval<double>(-f.lin));
    const Interval<double> oriented = f.lin > 0 ? e : -e;
    return intersection(
        all, quick::add(Interval<double>(t.mid), quick::mul(Interval<double>(t.lin), oriented)));
}

}  // namespace

Isolation AffineBisection::isolate(const Field& field, const ElementList& list, const Ray& ray,
                                   const MethodOptions& options, Counts& counts) const {
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local natural::RayField along;
    along.build(field, list, ray, search.ray);

    // What waits while the nearer part is searched: one interval for each halving.
    std::array<Interval<double>, 2200> waiting;
    std::size_t depth = 0;
    waiting[depth++] = search.span;
    std::uint64_t evaluations = 0;
    Isolation result = search.answer;
    while (depth > 0) {
        Interval<double> t = waiting[--depth];
        if (evaluations == evaluation_budget || counts.stop.requested()) {
            result = search.result(Status::unresolved, {t.lo, search.span.hi});
            break;
        }
        ++evaluations;
        counts.add(1, list.elements.size());
        const natural::Affine place = natural::affine_over(t);
        const natural::Affine f = natural::extension(along, place);
        const Interval<double> range = natural::range(f);
        if (range.hi < 0 || range.lo > 0) continue;
        const double before = width(t);
        t = possible_zeros(f, place, t);
        if (is_empty(t)) continue;
        const double middle = midpoint(t);
        if (width(t) <= search.tolerance || middle <= t.lo || middle >= t.hi) {
            result = search.result(Status::claimed_hit, t);
            break;
        }
        if (width(t) < 0.5 * before) {
            waiting[depth++] = t;
        } else {
            waiting[depth++] = {middle, t.hi};
            waiting[depth++] = {t.lo, middle};
        }
    }
    return result;
}

}  // namespace ivory
