// The field of one element along a ray, straight from the formulas of the scene format, for any
// type of interval: RealInterval (256 bits) and OutwardDouble. With q = distance / width, s = q^2:
// F = b k(s), dF/dt = b k'(s) ds/dt.
//
// Every k falls with s and every k' rises with s (that is, k is convex) on s >= 0:
//   blinn      k = exp(-s)                        k' = -exp(-s)
//   nishimura  k = 1 - 3 s            s <= 1/9    k' = -3
//                = 3/2 (1 - q)^2      s <= 1      k' = 3/2 - 3/2 / q
//   wyvill     k = (1 - s)^2 (1 - 4/9 s)  s <= 1  k' = -2/9 (1 - s) (11 - 6 s)
// and each is written with factors that are monotone the same way, so that interval evaluation
// gives the exact ranges but for rounding. (The wyvill polynomial of the format, factored.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory::reference {

template <class I>
using Triple = std::array<I, 3>;

template <class I>
Triple<I> triple(const Vec3d& v, long exponent = 0) {
    return {I::of(v.x, exponent), I::of(v.y, exponent), I::of(v.z, exponent)};
}
template <class I>
Triple<I> minus(const Triple<I>& a, const Triple<I>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class I>
Triple<I> times(const Triple<I>& a, const I& x) {
    return {a[0] * x, a[1] * x, a[2] * x};
}
template <class I>
I inner(const Triple<I>& a, const Triple<I>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class I>
I norm2(const Triple<I>& a) {
    return sqr(a[0]) + sqr(a[1]) + sqr(a[2]);
}
template <class I>
Triple<I> outer(const Triple<I>& a, const Triple<I>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A function and its derivative, at a point or over an interval of its argument.
template <class I>
struct Germ {
    I value, slope;
};

template <class I>
Germ<I> either(const Germ<I>& a, const Germ<I>& b) {
    return {hull(a.value, b.value), hull(a.slope, b.slope)};
}

// k and k' for s in the given interval; s < 0 stands for rounding below 0. A kernel more has to be
// written down here, by its formula.
static_assert(kernel_count == 3);
template <class I>
Germ<I> kernel_germ(KernelKind kind, const I& s) {
    static const I one(1), ninth = I(1) / I(9), two_ninths = I(2) / I(9), four_ninths = I(4) / I(9);
    if (kind == KernelKind::blinn) {
        const I e = exp(-s);
        return {e, -e};
    }
    const bool reaches_beyond = !(s.hi < one.lo);
    const Germ<I> beyond{I(0), I(0)};
    if (s.lo >= one.hi) return beyond;
    const I inside = common(s, from_to(I(-1), one));
    if (kind == KernelKind::wyvill) {
        const I rest = one - inside;
        const Germ<I> germ{sqr(rest) * (one - four_ninths * inside),
                           -(two_ninths * rest) * (I(11) - I(6) * inside)};
        return reaches_beyond ? either(germ, beyond) : germ;
    }
    const bool reaches_core = !(inside.lo > ninth.hi), reaches_rim = !(inside.hi < ninth.lo);
    Germ<I> germ;
    if (reaches_rim) {
        const I q = sqrt(common(inside, from_to(ninth, one)));
        germ = {I(1.5) * sqr(one - q), I(1.5) - I(1.5) / q};
    }
    if (reaches_core) {
        const Germ<I> core{one - I(3) * common(inside, from_to(I(-1), ninth)), I(-3)};
        germ = reaches_rim ? either(germ, core) : core;
    }
    return reaches_beyond ? either(germ, beyond) : germ;
}

// |a + t b|^2
template <class I>
struct Quadratic {
    Triple<I> a, b;
    I least{0};  // its lower end bounds the function from below for every t

    Quadratic() = default;
    // |a x b|^2 / |b|^2 is the minimum over the whole line.
    Quadratic(Triple<I> start, Triple<I> direction) : a(start), b(direction) {
        const I b2 = norm2(b);
        if (certainly_positive(b2)) least = norm2(outer(a, b)) / b2;
    }
    Germ<I> at(const I& t) const {  // t a point
        const Triple<I> v{a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
        return {norm2(v), I(2) * inner(v, b)};
    }
};

// s is a convex function of t with the given germs at the ends of an interval, and not less than
// the lower end of `least`: so it is greatest at an end, and ds/dt rises.
template <class I>
Germ<I> convex_range(const Germ<I>& first, const Germ<I>& last, const I& least) {
    const I ends = hull(first.value, last.value);
    const I slope = from_to(first.slope, last.slope);
    if (first.slope.lo >= 0) return {from_to(first.value, last.value), slope};
    if (last.slope.hi <= 0) return {from_to(last.value, first.value), slope};
    return {from_to(least.lo < ends.lo ? least : ends, ends), slope};
}

// s along the ray o + t d; all lengths are divided by the width.
template <class I>
class PointAlongRay {
  public:
    PointAlongRay(const Triple<I>& from_point, const Triple<I>& d) : square_(from_point, d) {}
    Germ<I> at(const I& t) const { return square_.at(t); }
    Germ<I> over(const I& t) const { return convex_range(at(I(t.lo)), at(I(t.hi)), square_.least); }

  private:
    Quadratic<I> square_;
};

// With u = ((p - a).m) / |m|^2, m = b - a: the distance to a for u <= 0, to b for u >= 1, to the
// line in between; u is affine in t. The distance to a convex set is convex along the ray, and
// where u leaves [0, 1] value and slope pass continuously from one formula to the next.
template <class I>
class SegmentAlongRay {
  public:
    SegmentAlongRay(const Triple<I>& from_a, const Triple<I>& from_b, const Triple<I>& m,
                    const Triple<I>& d)
        : ends_{Quadratic<I>(from_a, d), Quadratic<I>(from_b, d)} {
        const I m2 = norm2(m), inverse = I(1) / sqrt(m2);
        middle_ = Quadratic<I>(times(outer(from_a, m), inverse), times(outer(d, m), inverse));
        u0_ = inner(from_a, m) / m2;
        u1_ = inner(d, m) / m2;
    }
    Germ<I> at(const I& t) const {
        const I u = u0_ + t * u1_;
        Germ<I> germ;
        bool any = false;
        const auto join = [&](const Quadratic<I>& piece) {
            germ = any ? either(germ, piece.at(t)) : piece.at(t);
            any = true;
        };
        if (u.lo <= 0) join(ends_[0]);
        if (u.hi >= 0 && u.lo <= 1) join(middle_);
        if (u.hi >= 1) join(ends_[1]);
        return germ;
    }
    Germ<I> over(const I& t) const {
        const I first(t.lo), last(t.hi);
        const I u = hull(u0_ + first * u1_, u0_ + last * u1_);
        // Each value of s is one of a piece that is in force somewhere on t.
        I least(0);
        bool any = false;
        const auto join = [&](const Quadratic<I>& piece) {
            const I own = convex_range(piece.at(first), piece.at(last), piece.least).value;
            least = any ? hull(least, own) : own;
            any = true;
        };
        if (u.lo <= 0) join(ends_[0]);
        if (u.hi >= 0 && u.lo <= 1) join(middle_);
        if (u.hi >= 1) join(ends_[1]);
        return convex_range(at(first), at(last), least);
    }

  private:
    std::array<Quadratic<I>, 2> ends_;
    Quadratic<I> middle_;
    I u0_, u1_;
};

// s = (rho - r)^2 + h^2 with h = n.(p - c), affine, and rho = |n x (p - c)|, convex; rho has a kink
// where the ray crosses the axis, and there its slope is the hull of the one-sided ones. In general
// d rho/dt rises, and it is never beyond +-|n x d|.
template <class I>
class CircleAlongRay {
  public:
    CircleAlongRay(const Triple<I>& from_center, const Triple<I>& unit_normal, const I& radius,
                   const Triple<I>& d)
        : rho2_(outer(unit_normal, from_center), outer(unit_normal, d)),
          h0_(inner(unit_normal, from_center)),
          h1_(inner(unit_normal, d)),
          r_(radius) {
        const I steepest = sqrt(norm2(rho2_.b));
        slopes_ = from_to(-steepest, steepest);
    }
    Germ<I> at(const I& t) const { return square(rho(t), h0_ + t * h1_); }
    Germ<I> over(const I& t) const {
        const I first(t.lo), last(t.hi);
        const I least = sqrt(rho2_.least);
        return square(convex_range(rho(first), rho(last), least),
                      hull(h0_ + first * h1_, h0_ + last * h1_));
    }

  private:
    Germ<I> rho(const I& t) const {
        const Germ<I> square = rho2_.at(t);
        const I value = sqrt(square.value);
        if (!certainly_positive(value)) return {value, slopes_};
        return {value, common(square.slope / (I(2) * value), slopes_)};
    }
    Germ<I> square(const Germ<I>& rho, const I& h) const {
        const I off = rho.value - r_;
        return {sqr(off) + sqr(h), I(2) * (off * rho.slope + h * h1_)};
    }

    Quadratic<I> rho2_;
    I h0_, h1_, r_, slopes_;
};

// One element along the ray o + t d 2^exponent.
template <class I>
class ElementAlongRay {
  public:
    ElementAlongRay(const Element& element, const Ray& ray, long exponent)
        : kernel_(element.kernel),
          strength_(element.strength),
          s_(std::visit(
              [&](const auto& skeleton) {
                  return along(skeleton, triple<I>(ray.origin), triple<I>(ray.direction, exponent),
                               I(element.width));
              },
              element.skeleton)) {}

    // s and ds/dt for all t of the interval.
    Germ<I> square(const I& t) const {
        return std::visit(
            [&](const auto& shape) { return t.is_point() ? shape.at(t) : shape.over(t); }, s_);
    }

    // F and dF/dt for all t of the interval.
    Germ<I> over(const I& t) const {
        const Germ<I> s = square(t);
        const Germ<I> k = kernel_germ(kernel_, s.value);
        return {strength_ * k.value, strength_ * (k.slope * s.slope)};
    }

  private:
    using Shape = std::variant<PointAlongRay<I>, SegmentAlongRay<I>, CircleAlongRay<I>>;

    static Triple<I> divided(const Triple<I>& a, const I& x) {
        return {a[0] / x, a[1] / x, a[2] / x};
    }
    static Shape along(const PointSkeleton& point, const Triple<I>& o, const Triple<I>& d,
                       const I& w) {
        return PointAlongRay<I>(divided(minus(o, triple<I>(point.position)), w), divided(d, w));
    }
    static Shape along(const SegmentSkeleton& segment, const Triple<I>& o, const Triple<I>& d,
                       const I& w) {
        if (segment.a == segment.b) return along(PointSkeleton{segment.a}, o, d, w);
        const Triple<I> a = triple<I>(segment.a), b = triple<I>(segment.b);
        return SegmentAlongRay<I>(divided(minus(o, a), w), divided(minus(o, b), w),
                                  divided(minus(b, a), w), divided(d, w));
    }
    static Shape along(const CircleSkeleton& circle, const Triple<I>& o, const Triple<I>& d,
                       const I& w) {
        return CircleAlongRay<I>(divided(minus(o, triple<I>(circle.center)), w),
                                 unit_normal(circle.normal), I(circle.radius) / w, divided(d, w));
    }

  public:
    // N / |N|, scaled by a power of two first so that no square leaves the range of double.
    static Triple<I> unit_normal(const Vec3d& n) {
        const Triple<I> m = triple<I>(n, -binary_exponent(n));
        return divided(m, sqrt(norm2(m)));
    }
    // e with the greatest component in [2^(e-1), 2^e).
    static long binary_exponent(const Vec3d& v) {
        int exponent = 0;
        std::frexp(std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}), &exponent);
        return exponent;
    }

  private:
    KernelKind kernel_;
    I strength_;
    Shape s_;
};

}  // namespace ivory::reference
