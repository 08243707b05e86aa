// The natural extension of f along a ray: the distance formulas with p = o + t d put in, evaluated
// for any number type in the place of t, so that intervals, intervals with a derivative, affine
// forms and plain doubles share one body.
//
// A vector from a skeleton is linear in t, start + t rate, and so are the foot of the perpendicular
// on a segment and the height above a circle's plane:
//   point    s = |v|^2
//   segment  lambda = M.v / |M|^2; s = |v|^2 for lambda <= 0, |v - M|^2 for lambda >= 1, between
//            them |v - lambda M|^2
//   circle   h = N.v, rho = |v - h N|; s = (rho - r)^2 + h^2
// all in units of the element's width; then f = sum of b k(s) - T.
//
// A Number has: linear(start, rate, t), sum and difference, sqr, sqrt, scaled by an interval,
// kernel(kind, s), either_kernel (any k in [0, 1], any slope), segment_square, range(x).
#pragma once

#include <cstddef>
#include <vector>

#include "core/field/field.h"
#include "core/field/kernel.h"
#include "core/field/support.h"
#include "core/interval/interval.h"
#include "core/math/vec3.h"
#include "core/trace/methods/search.h"

namespace ivory::natural {

using Span = Interval<double>;

// start + t rate; the intervals hold the exact numbers and are as wide as rounding made them.
struct Linear {
    Span start, rate;
};

struct LinearVector {
    Linear x, y, z;
};

struct RayElement {
    Shape shape = Shape::point;
    KernelKind kernel = KernelKind::blinn;
    bool bounded = true;  // false: numbers too small to divide by; 0 <= k <= 1 is all that is known
    Span strength;
    LinearVector from;    // a point, the end a of a segment, the centre of a circle
    LinearVector from_b;  // the end b of a segment
    LinearVector across;  // from a segment's line, from a circle's axis
    Linear along;         // lambda of a segment, h of a circle
    Vec3<Span> axis;      // M of a segment
    Span radius;          // of a circle
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

template <class Number>
[[nodiscard]] Number square(const LinearVector& v, const Number& t) {
    return sqr(linear(v.x, t)) + sqr(linear(v.y, t)) + sqr(linear(v.z, t));
}

// (rho - r)^2 + h^2: the expanded form r^2 + |v|^2 - 2 r rho cancels near the circle.
template <class Number>
[[nodiscard]] Number circle_square(const RayElement& e, const Number& t) {
    return sqr(less(sqrt(square(e.across, t)), e.radius)) + sqr(linear(e.along, t));
}

// The cases that [lambda] allows, hulled.
template <class Number>
[[nodiscard]] Number segment_square(const RayElement& e, const Number& t) {
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
    switch (e.shape) {
        case Shape::point:
            break;
        case Shape::segment:
            return segment_square(e, t);
        case Shape::circle:
            return circle_square(e, t);
    }
    return square(e.from, t);
}

// f over t.
template <class Number>
[[nodiscard]] Number extension(const RayField& field, const Number& t) {
    Number sum = constant_like(field.constant(), t);
    for (const RayElement& e : field.elements()) {
        sum = sum + times(e.strength, e.bounded ? kernel(e.kernel, square(e, t)) : any_kernel(t));
    }
    return sum;
}

}  // namespace ivory::natural
