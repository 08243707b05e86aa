#include "core/trace/methods/newton.h"

#include <array>

#include "core/interval/quick.h"
#include "core/trace/methods/natural_numbers.h"
#include "core/trace/methods/search.h"

namespace ivory {
namespace {

using natural::Dual;
using natural::Span;

constexpr std::uint64_t evaluation_budget = 100'000;

bool excludes_zero(const Span& x) { return x.lo > 0 || x.hi < 0; }

// The first root on the span, from left to right.
//
// The list's rest r(t) has no derivative here: f = g + r with g monotone where 0 is outside the
// slope. Then f on [a, b] lies in the hull of f(a) and f(b), both enclosed with all of the rest, and
// a root x = m - (g(m) + r(x)) / g'(xi) lies in m - f(m) / f'([t]), likewise.
class Descent {
  public:
    Descent(const natural::RayField& field, const Search& search, std::size_t elements,
            Counts& counts)
        : field_(field), search_(search), elements_(elements), counts_(counts) {}

    Isolation run() {
        waiting_[depth_++] = search_.span;
        while (depth_ > 0) {
            const Span t = waiting_[--depth_];
            if (is_over()) {
                return search_.result(Status::unresolved, {t.lo, search_.span.hi});
            }
            if (look_at(t)) return result_;
        }
        return search_.answer;
    }

  private:
    [[nodiscard]] bool is_over() const {
        return evaluations_ >= evaluation_budget || counts_.stop.requested();
    }
    void count() {
        ++evaluations_;
        counts_.add(1, elements_);
    }
    Dual over(const Span& t) {
        count();
        return natural::extension(field_, Dual{t, Span(1.0)});
    }
    Span at(double t) {
        count();
        return natural::extension(field_, natural::Range{Span(t)}).x;
    }

    bool found(Status status, const Span& t) {
        result_ = search_.result(status, t);
        return true;
    }

    bool sign_changes(const Span& t) {
        const Span a = at(t.lo), b = at(t.hi);
        return (a.hi < 0 && b.lo > 0) || (a.lo > 0 && b.hi < 0);
    }

    // True: the first root of the search is found.
    bool look_at(const Span& t) {
        const Dual f = over(t);
        if (excludes_zero(f.x)) return false;
        const double middle = midpoint(t);
        const bool atom = middle <= t.lo || middle >= t.hi;
        if (width(t) <= search_.tolerance || atom) {
            return found(sign_changes(t) ? Status::hit : Status::claimed_hit, t);
        }
        if (excludes_zero(f.slope)) return close_in(t, f.slope);
        waiting_[depth_++] = {middle, t.hi};
        waiting_[depth_++] = {t.lo, middle};
        return false;
    }

    // [t] holds one root at the most.
    bool close_in(const Span& all, Span slope) {
        if (excludes_zero(hull(at(all.lo), at(all.hi)))) return false;
        Span t = all;
        // Half of the width is kept for the ends, which then stand clear of the root.
        while (width(t) > 0.5 * search_.tolerance) {
            const double middle = midpoint(t);
            if (middle <= t.lo || middle >= t.hi) break;
            if (is_over()) {
                return found(Status::unresolved, {t.lo, search_.span.hi});
            }
            const Span f = at(middle);
            const Span rising = slope.lo > 0 ? slope : -slope;
            const Span step = quick::div(slope.lo > 0 ? f : -f, rising);
            const Span next = intersection(t, quick::sub(Span(middle), step));
            if (is_empty(next)) return false;
            if (next.lo <= t.lo && next.hi >= t.hi) break;  // rounding hides the rest
            t = next;
            if (width(t) > 0.5 * search_.tolerance) {
                const Dual again = over(t);
                if (excludes_zero(again.x)) return false;
                slope = intersection(slope, again.slope);
            }
        }
        const double margin = 0.24 * search_.tolerance;
        const Span ends{std::max(all.lo, t.lo - margin), std::min(all.hi, t.hi + margin)};
        if (width(ends) <= search_.tolerance && sign_changes(ends)) {
            return found(Status::hit, ends);
        }
        return found(Status::claimed_hit, t);
    }

    const natural::RayField& field_;
    const Search& search_;
    const std::size_t elements_;
    Counts& counts_;
    std::uint64_t evaluations_ = 0;
    std::array<Span, 2200> waiting_;
    std::size_t depth_ = 0;
    Isolation result_{};
};

}  // namespace

Isolation IntervalNewton::isolate(const Field& field, const ElementList& list, const Ray& ray,
                                  const MethodOptions& options, Counts& counts) const {
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return search.answer;
    thread_local natural::RayField along;
    along.build(field, list, ray, search.ray);
    return Descent(along, search, list.elements.size(), counts).run();
}

}  // namespace ivory
