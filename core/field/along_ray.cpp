#include "core/field/along_ray.h"

#include <algorithm>

#include "core/shape/shapes.h"

namespace ivory {
namespace {

// A lower bound of s over the span.
double least_square(const ElementAlongRay& e, const Interval<double>& span, double cut) {
    if (e.form == ElementAlongRay::Form::squares) {
        double least = infinity<double>;
        for (int k = 0; k < e.piece_count; ++k) {
            least = std::min(least, e.pieces[static_cast<std::size_t>(k)].square.least);
        }
        return least;
    }
    // Cut the active part into windows: their ranges are tighter than that of the whole.
    const Interval<double> where = intersection(span, e.active);
    if (is_empty(where)) return cut;
    constexpr int windows = 6;
    // Outside of it, all that is known is s >= cut.
    double least = is_subset(span, where) ? infinity<double> : cut;
    const auto look = [&](const auto& along) {
        auto left = along.at(where.lo);
        double t0 = where.lo;
        for (int k = 1; k <= windows; ++k) {
            const double t1 =
                k == windows ? where.hi : where.lo + (where.hi - where.lo) * k / windows;
            const auto right = along.at(t1);
            if (t1 > t0) least = std::min(least, along.over(t0, t1, left, right).s.lo);
            left = right;
            t0 = t1;
        }
    };
    if (e.form == ElementAlongRay::Form::circle) {
        look(e.circle);
    } else {
        look(e.taper);
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
        e.form = ElementAlongRay::Form::unbounded;
        e.active = Interval<double>::entire();
        e.least = 0;
        e.peak = 1;
        return;
    }
    e.active = intersection(e.active, span);
    e.least = is_empty(e.active) ? cut : least_square(e, span, cut);
    e.peak = kernel_at(e.kernel, e.least).hi;
}

}  // namespace ivory
