#include "core/field/along_ray.h"

#include <algorithm>

#include "core/shape/shapes.h"

namespace ivory {
namespace {

// A lower bound of s over the span.
double least_square(const UnboundedAlongRay&, const ElementAlongRay&, const Interval<double>&,
                    double) {
    return 0;
}

double least_square(const SquaresAlongRay& squares, const ElementAlongRay&, const Interval<double>&,
                    double) {
    double least = infinity<double>;
    for (const Piece& piece : squares.all()) least = std::min(least, piece.square.least);
    return least;
}

// Its parts are many, and their feet dear.
double least_square(const CurveAlongRay& arc, const ElementAlongRay&, const Interval<double>&,
                    double) {
    return arc.rough_least();
}

template <class Form>
double least_square(const Form& form, const ElementAlongRay& e, const Interval<double>& span,
                    double cut) {
    // Cut the active part into windows: their ranges are tighter than that of the whole.
    const Interval<double> where = intersection(span, e.active);
    if (is_empty(where)) return cut;
    constexpr int windows = 6;
    // Outside of it, all that is known is s >= cut.
    double least = is_subset(span, where) ? infinity<double> : cut;
    auto left = form.at(where.lo);
    double t0 = where.lo;
    for (int k = 1; k <= windows; ++k) {
        const double t1 = k == windows ? where.hi : where.lo + (where.hi - where.lo) * k / windows;
        const auto right = form.at(t1);
        if (t1 > t0) least = std::min(least, form.over(t0, t1, left, right).s.lo);
        left = right;
        t0 = t1;
    }
    return least < infinity<double> ? std::max(least, 0.0) : 0;
}

}  // namespace

void along_ray(const Field& field, std::size_t i, const Vec3d& origin, const Vec3d& direction,
               const Interval<double>& span, double cut, ElementAlongRay& e) {
    e.kernel = field.kernel[i];
    e.strength = field.strength[i];
    const double beyond = e.strength * kernel_at(e.kernel, cut).hi;
    e.beyond = {std::min(beyond, 0.0), std::max(beyond, 0.0)};
    const bool fits = with_field_shape(field.shape[i], [&]<class S>() {
        return S::along_ray(field.columns(i), field.width[i], {origin, direction, span, cut}, e);
    });
    if (!fits) {
        e.form = UnboundedAlongRay();
        e.active = Interval<double>::entire();
        e.least = 0;
        e.peak = 1;
        return;
    }
    e.active = intersection(e.active, span);
    e.least = is_empty(e.active)
                  ? cut
                  : std::visit([&](const auto& form) { return least_square(form, e, span, cut); },
                               e.form);
    e.peak = kernel_at(e.kernel, e.least).hi;
}

}  // namespace ivory
