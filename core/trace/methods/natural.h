// The natural extension of f along a ray: the distance formulas with p = o + t d put in, evaluated
// for any number type in the place of t, so that intervals, intervals with a derivative, affine
// forms and plain doubles share one body.
//
// A vector from a skeleton is linear in t, start + t rate (core/shape/natural.h); s = q^2 is what the
// shape's file says, in units of the element's width; then f = sum of b k(s) - T.
//
// A Number has: linear(start, rate, t), sum and difference, sqr, sqrt, at_least_0, least, scaled by an
// interval, kernel(kind, s), any_kernel (any k in [0, 1], any slope), enclosed (what is known of
// values and slopes over t alone), range(x), and, where hulling the cases of a clamped foot is not the
// best it can do, segment_square.
#pragma once

#include <cstddef>
#include <vector>

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/interval/interval.h"
#include "core/kernel/kernels.h"
#include "core/math/vec3.h"
#include "core/shape/natural.h"
#include "core/shape/shapes.h"
#include "core/trace/methods/search.h"

namespace ivory::natural {

struct RayElement : RaySkeleton {
    Shape shape = Shape::point;
    KernelKind kernel = KernelKind::blinn;
    Span strength;
    bool joins = false;  // the next one is another part of the same element
};

// All elements of a list seen from one ray. It keeps its memory from ray to ray.
class RayField {
  public:
    void build(const Field& field, const ElementList& list, const Ray& ray,
               const ScaledRay& scaled_ray);

    [[nodiscard]] const std::vector<RayElement>& elements() const { return elements_; }
    // What the list has left out, minus T.
    [[nodiscard]] const Span& constant() const { return constant_; }

  private:
    std::vector<RayElement> elements_;
    Span constant_;
};

// The cases that [lambda] allows, hulled.
template <class Number>
[[nodiscard]] Number segment_square(const RaySkeleton& e, const Number& t) {
    const Span lambda = range(linear(e.along, t));
    const bool before = lambda.lo <= 0, after = lambda.hi >= 1;
    if (lambda.hi <= 0) return square(e.from, t);
    if (lambda.lo >= 1) return square(e.from_b, t);
    Number s = square(e.across, t);
    if (before) s = hull(s, square(e.from, t));
    if (after) s = hull(s, square(e.from_b, t));
    return s;
}

template <class Number>
[[nodiscard]] Number square(const RayElement& e, const Number& t) {
    if (e.collapsed) return square(e.from, t);
    return with_field_shape(e.shape, [&]<class S>() { return S::square(e, t); });
}

// f over t.
template <class Number>
[[nodiscard]] Number extension(const RayField& field, const Number& t) {
    Number sum = constant_like(field.constant(), t);
    const std::vector<RayElement>& elements = field.elements();
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const RayElement& e = elements[i];
        if (!e.joins) {
            sum =
                sum + times(e.strength, e.bounded ? kernel(e.kernel, square(e, t)) : any_kernel(t));
            continue;
        }
        // the least of its parts' squares
        bool bounded = e.bounded;
        Number s = bounded ? square(e, t) : any_kernel(t);
        while (elements[i].joins) {
            const RayElement& part = elements[++i];
            bounded = bounded && part.bounded;
            if (bounded) s = least(s, square(part, t));
        }
        sum = sum + times(e.strength, bounded ? kernel(e.kernel, s) : any_kernel(t));
    }
    return sum;
}

}  // namespace ivory::natural
