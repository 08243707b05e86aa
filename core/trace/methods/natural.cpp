#include "core/trace/methods/natural.h"

#include <cmath>
#include <limits>

#include "core/interval/quick.h"

namespace ivory::natural {
void RayField::build(const Field& field, const ElementList& list, const Ray& ray,
                     const ScaledRay& scaled_ray) {
    elements_.clear();
    constant_ = list.left_out - Span(field.threshold);
    const Vector origin = vector(scaled_ray.origin);
    Vector direction = vector(scaled_ray.direction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // A component that underflowed when the ray was scaled.
        const double d = scaled_ray.direction[axis];
        if (std::abs(d) < std::numeric_limits<double>::min() && ray.direction[axis] != 0) {
            direction[axis] = {next_down(d), next_up(d)};
        }
    }
    std::uint32_t last = 0;  // source of the one before
    for (const std::uint32_t i : list.elements) {
        RayElement& e = elements_.emplace_back();
        e.shape = field.shape[i];
        e.kernel = field.kernel[i];
        if (elements_.size() > 1 && is_joined(e.shape) && field.source[i] == last) {
            elements_[elements_.size() - 2].joins = true;
        }
        last = field.source[i];
        e.strength = Span(field.strength[i]);
        const Span scale = quick::div(Span(1.0), Span(field.width[i]));
        const Vector rate = times(scale, direction);
        const Vector start = times(scale, minus(origin, vector(field.a(i))));
        e.from = moving(start, rate);
        e.curve.origin = scaled_ray.origin;
        e.curve.direction = scaled_ray.direction;
        e.curve.width = field.width[i];
        with_field_shape(
            e.shape, [&]<class S>() { S::see(field.columns(i), scale, origin, start, rate, e); });
    }
}

}  // namespace ivory::natural
