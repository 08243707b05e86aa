// What every method begins with: the part of the ray that can meet the surface.
#pragma once

#include <cmath>

#include "core/trace/clip.h"
#include "core/trace/methods/method.h"

namespace ivory {

// A miss that is proved already (`span` empty), or the ray and the part of it that is left.
struct Search {
    ScaledRay ray;
    Interval<double> span;  // of the scaled t; f < 0 certainly holds on the rest of t >= 0
    double speed = 0;       // |direction|, rounded up
    double tolerance = 0;   // E times the least width over |direction|, rounded down
    Isolation answer{};     // where there is nothing to be searched

    [[nodiscard]] bool over() const { return is_empty(span); }

    // The scaled t as the caller's.
    [[nodiscard]] Isolation result(Status status, const Interval<double>& t) const {
        return {status, ray.unscaled(t)};
    }
};

[[nodiscard]] inline Search begin_search(const Field& field, const ElementList& list,
                                         const Ray& ray, const MethodOptions& options) {
    Search search;
    search.answer = {Status::miss, Interval<double>::empty_set()};
    search.span = Interval<double>::empty_set();
    if (list.certainly_empty) return search;
    search.ray = scaled(ray);
    const Interval<double> span = clip(search.ray, field.box);
    if (is_empty(span)) return search;
    if (!(span.hi < 1e100)) {
        search.answer = {Status::unresolved, {0.0, infinity<double>}};
        return search;
    }
    search.span = span;
    const Vec3d& d = search.ray.direction;
    search.speed = std::sqrt(dot(d, d)) * (1 + 8 * unit_roundoff);
    search.tolerance =
        options.tolerance * field.least_width / search.speed * (1 - 8 * unit_roundoff);
    return search;
}

}  // namespace ivory
