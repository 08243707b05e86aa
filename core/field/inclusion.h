// The inclusion function: f, f' and f'' of the whole field over an interval of a ray.
// Each element's own field is enclosed without the dependency problem (along_ray.h gives the range
// of s, the kernel is monotone in s; Blinn's along a parabola has closed ranges of f' and f'' too),
// so only the sum over the elements loses anything.
#pragma once

#include <vector>

#include "core/field/along_ray.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/interval/interval.h"

namespace ivory {

// What is known of f on [t0, t1]. The elements that count as nothing there are left out of the
// derivatives: f = g + r with g the sum over the others minus T and r a function with values in
// `rest`, which is part of left, right and value but has no derivative here. So, with x = t - t0,
//     f(t) <= left.hi + left_slope.hi x + curvature.hi x^2 / 2,
//     f(t) <= left.hi + slope.hi x,
// and likewise from below. slope and curvature are those of g; a downward jump of g' leaves
// curvature.lo = -inf, an upward one curvature.hi = +inf, unless it is from one part of an element to
// another (core/shape/joined.h): left_slope and curvature are of all parts that may be the nearest.
struct Enclosure {
    Interval<double> left, right, value;
    Interval<double> left_slope, slope, curvature;
};

// The elements of one list seen from one ray, in units of 2^exponent(): the power of two that
// brings T into [1/2, 1), so that no strength is too large or too small. Reused from ray to ray: it
// keeps its memory.
class FieldAlongRay {
  public:
    // origin + t direction for t in the finite `span`; the largest component of `direction` lies in
    // [1, 2).
    void build(const Field& field, const ElementList& list, const Vec3d& origin,
               const Vec3d& direction, const Interval<double>& span);

    // The sum of the peaks stays below T: f has no root on the span (mathematics: early miss).
    [[nodiscard]] bool certainly_outside() const { return peaks_ < 0; }

    // t0 < t1, both in the span.
    [[nodiscard]] Enclosure over(double t0, double t1) const;

    // f(t), enclosed.
    [[nodiscard]] Interval<double> at(double t) const;

    // f in scene units is 2^exponent() times what is enclosed here.
    [[nodiscard]] int exponent() const { return exponent_; }

    // T and the sum of the elements' peaks of |F|, in units of 2^exponent().
    [[nodiscard]] double threshold() const { return threshold_; }
    [[nodiscard]] double magnitude() const { return magnitude_; }

    // Elements that take part in an evaluation.
    [[nodiscard]] std::size_t size() const { return elements_.size(); }

  private:
    std::vector<ElementAlongRay> elements_;
    Interval<double> rest_{0.0, 0.0};  // of the elements that are not in elements_
    double threshold_ = 0;             // T / 2^exponent_
    int exponent_ = 0;
    double peaks_ = 0;  // upper bound of f over the span
    double magnitude_ = 0;
};

}  // namespace ivory
