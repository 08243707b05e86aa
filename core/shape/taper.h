// A segment from a to b whose width goes linearly from w_a to w_b >= w_a (its ends are named so): with
// c(u) = a + u M and w(u) = w_a + u (w_b - w_a), 0 <= u <= 1,
//     q = min over u of |p - c(u)| / w(u).
// Level sets are cones with round ends. With v = p - a, alpha = v.M, A = |v|^2 and d = w_b - w_a, the
// derivative of (|p - c| / w)^2 by u is 2 / w^3 times
//     psi(u) = u (|M|^2 w_a + alpha d) - (alpha w_a + A d),                                      (1)
// which is linear in u: the foot is its zero, kept between the ends, where it rises; else the ends
// decide. |p - c(u)| - q0 w(u) is convex in u for every q0: that is what lower bounds of q rest on.
//
// What the bounds on a bundle rest on, with w the least width, D = w q and kappa = |d| / |M|:
//     for each u, w^2 |p - c(u)|^2 / w(u)^2 has a second derivative of at most 2 along a line of
//         speed 1; so has their minimum D^2, as far as that can fall: (1) of
//         core/field/bundle_field.h holds of D, which changes by no more than p does;
//     where kappa q < 1, along a line of speed 1,
//         (D^2)'' / 2 = (w / w*)^2 - w^2 (m.v' + 2 (p - c).v' d / w*)^2 / (w* (|M|^2 w_a + alpha d))
//     with w* = w(u*) and |M|^2 w_a + alpha d = |M|^2 w* (1 - kappa^2 q^2), so that
//         (D^2)'' / 2 >= 1 - (1 + 2 kappa q)^2 / (1 - kappa^2 q^2);                               (2)
//     there is no kink where kappa q < 1: W = w_a + alpha d / |M|^2 <= 0, beyond the apex, is where
//         q >= 1 / kappa.
#ifndef IVORY_CORE_SHAPE_TAPER_H
#define IVORY_CORE_SHAPE_TAPER_H

#include <algorithm>
#include <cmath>

#include "core/shape/along_ray.h"
#include "core/shape/natural.h"
#include "core/shape/segment.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// Not a skeleton of its own: what a field makes of a segment with two widths.
struct TaperedSegment {
    static constexpr bool has_kinks = true;  // beyond kappa q = 1
    static constexpr bool is_taper = true, is_joined = false, has_numbers = false;
    static constexpr bool has_axis = true;  // m = b - a
    static constexpr int m_power = 1, parameter_power = 0;

    static SkeletonColumns columns(const SegmentSkeleton& segment, double at_a, double at_b) {
        const bool narrows = at_a > at_b;
        SkeletonColumns c = (narrows ? SegmentSkeleton{segment.b, segment.a} : segment).columns();
        c.width_a = narrows ? at_b : at_a;
        c.width_b = narrows ? at_a : at_b;
        return c;
    }

    static Surroundings surroundings(const SkeletonColumns& c) {
        return SegmentSkeleton::surroundings(c);
    }
    static Box3 box(const SkeletonColumns& c) { return SegmentSkeleton::box(c); }
    static Ball ball(const SkeletonColumns& c) { return SegmentSkeleton::ball(c); }
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        return SegmentSkeleton::farthest(c, from, direction);
    }

    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        const Vec3d v{from_a.x / width, from_a.y / width, from_a.z / width};
        const Vec3d along = c.b - c.a;
        const Vec3d m{along.x / width, along.y / width, along.z / width};
        const double rate = (c.width_b - c.width_a) / width;
        const double alpha = dot(v, m), rises = dot(m, m) + alpha * rate;
        const double foot = rises > 0 ? (alpha + dot(v, v) * rate) / rises : 1;
        const double u = std::fmin(std::fmax(foot, 0.0), 1.0);
        const double widths = 1 + u * rate;
        const Vec3d from = v - u * m;
        const Vec3d away{from.x / (widths * widths), from.y / (widths * widths),
                         from.z / (widths * widths)};
        return {dot(from, from) / (widths * widths), away};
    }

    static bool along_ray(const SkeletonColumns& c, double, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        auto& taper = e.form.emplace<TaperAlongRay>();
        if (!taper.see(ray.origin, ray.direction, c.a, c.b, c.width_a, c.width_b, ray.span)) {
            return false;
        }
        // q is at least what it is for the ball around the segment, all of it as wide as its widest.
        const BallAlongRay around(ball(c), std::max(c.width_a, c.width_b), ray);
        if (!around.fits) return false;
        e.active = around.active(ray.cut);
        return true;
    }

    static void see(const SkeletonColumns& c, const natural::Span& scale, const natural::Vector&,
                    const natural::Vector&, const natural::Vector&, natural::RaySkeleton& e) {
        using namespace natural;
        e.axis = times(scale, minus(vector(c.b), vector(c.a)));
        e.taper_rate = quick::mul(scale, quick::sub(Span(c.width_b), Span(c.width_a)));
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return natural::as_number(
            t, [&](const natural::Span& x) { return natural::taper_over(e, x); });
    }
};

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/shape/shape_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// Of any shape whose elements are tapers to a field.
template <Shape shape>
struct TaperLanes {
    // (kappa q)^2 up to which the bounds below are told, and 1 - that.
    static constexpr double most_bent = 0.8, least_straight = 0.19;

    // p - c(u) at the foot u that rounding makes of (1), and 1 / w(u) in least widths: every u makes
    // |p - c| / w at least q. Beyond the apex, where (1) does not rise, the broader end is nearest.
    template <class Tag>
    struct Foot {
        Vec3v<Tag> from;
        V<Tag> u, per_width;
    };
    template <class Tag>
    static HWY_INLINE Foot<Tag> foot(Tag d, const Vec3v<Tag>& v, const Vec3v<Tag>& m, V<Tag> rate) {
        const V<Tag> one = constant(d, 1);
        const V<Tag> alpha = dot<Tag>(v, m);
        const V<Tag> rises = hn::MulAdd(alpha, rate, dot<Tag>(m, m));
        const V<Tag> wanted = hn::MulAdd(dot<Tag>(v, v), rate, alpha);
        const M<Tag> has_foot = hn::Gt(rises, hn::Set(d, least_square<hn::TFromD<Tag>>));
        const V<Tag> zero_of_it = hn::Div(wanted, hn::IfThenElse(has_foot, rises, one));
        const V<Tag> u = hn::IfThenElse(has_foot, hn::Min(at_least_0(zero_of_it), one), one);
        return {less_share(v, m, u), u, hn::Div(one, hn::MulAdd(u, rate, one))};
    }

    // So that its square is D^2 and, divided by w^2, half the gradient of s.
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        const Foot<Tag> at = foot<Tag>(d, from_first_place(d, e, p),
                                       {hn::Set(d, e.mx), hn::Set(d, e.my), hn::Set(d, e.mz)},
                                       hn::Set(d, e.taper_rate));
        const V<Tag> share = square_of(at.per_width);
        square = hn::Mul(dot<Tag>(at.from, at.from), share);
        return {hn::Mul(at.from.x, share), hn::Mul(at.from.y, share), hn::Mul(at.from.z, share)};
    }

    // At the axis' point at t: a lower bound of D, and how far the foot's place is, counted likewise,
    // from there and from the axis' point at `other`: along the way between no D is greater.
    //
    // |p - c(u)| - q0 w(u) is convex in u. With q that of the computed u, gamma its derivative there
    // for q0 = q, and q0 = q - e, it is at least e w(u') + gamma (u' - u) at any u', which is not below
    // 0 if e w >= max(-gamma (1 - u), gamma u): then no q is below q - e.
    template <class Tag>
    struct AtEnd {
        V<Tag> least, here, at_other;
    };
    template <class Tag>
    static HWY_INLINE AtEnd<Tag> at_end(const Seen<Tag, shape>& e,
                                        const Vec3<hn::TFromD<Tag>>& axis, hn::TFromD<Tag> t,
                                        hn::TFromD<Tag> other, V<Tag> error) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const Foot<Tag> at = foot<Tag>(d, e.from_axis(axis, t), e.m, e.taper_rate);
        const hn::TFromD<Tag> way = other - t;
        const Vec3v<Tag> there{hn::Add(at.from.x, hn::Set(d, way * axis.x)),
                               hn::Add(at.from.y, hn::Set(d, way * axis.y)),
                               hn::Add(at.from.z, hn::Set(d, way * axis.z))};
        const V<Tag> away = hn::Max(length_of(d, at.from), constant(d, 1e-18));
        const V<Tag> distance = hn::Mul(away, at.per_width);
        const V<Tag> turns = hn::Mul(distance, e.taper_rate);
        const V<Tag> gamma = hn::Neg(hn::Add(hn::Div(dot<Tag>(at.from, e.m), away), turns));
        const V<Tag> gain = at_least_0(
            hn::Max(hn::Mul(hn::Neg(gamma), hn::Sub(constant(d, 1), at.u)), hn::Mul(gamma, at.u)));
        // What rounding does to gamma, and to the direction that it is told by.
        const V<Tag> lost = hn::MulAdd(
            hn::Add(e.size, hn::Abs(turns)), hn::Set(d, 4 * Margin::margin),
            hn::Div(
                hn::Mul(hn::Add(hn::Add(e.size, hn::Abs(turns)), hn::Add(e.size, hn::Abs(turns))),
                        error),
                away));
        return {hn::Sub(distance, hn::Add(hn::Add(gain, lost), error)), hn::Add(distance, error),
                hn::MulAdd(length_of(d, there), at.per_width, error)};
    }

    // On a long stretch a ball around the skeleton says more than (1) of core/field/bundle_field.h.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const V<Tag> broadest = hn::Add(constant(d, 1), e.taper_rate);
        const AtEnd<Tag> first = at_end(e, s.axis, s.begin, s.end, error),
                         last = at_end(e, s.axis, s.end, s.begin, error);
        const V<Tag> half = constant(d, 0.5);
        const Vec3v<Tag> center{hn::MulAdd(half, e.m.x, e.v.x), hn::MulAdd(half, e.m.y, e.v.y),
                                hn::MulAdd(half, e.m.z, e.v.z)};
        const V<Tag> ball = hn::Sub(FromAxis<Tag>(center, s.axis).nearest(s.begin, s.end),
                                    hn::MulAdd(half, e.size, error));
        const V<Tag> near =
            hn::Max(least_between(d, at_least_0(first.least), at_least_0(last.least),
                                  (s.end - s.begin) * Margin::more),
                    hn::Mul(at_least_0(ball), hn::Div(hn::Set(d, Margin::less), broadest)));
        const V<Tag> far =
            hn::Min(hn::Max(first.here, first.at_other), hn::Max(last.here, last.at_other));
        return range_of_rays(d, e.magnitude, near, far, s, error);
    }

    // (kappa q)^2, for the greatest q.
    template <class Tag>
    static HWY_INLINE V<Tag> bent(Tag d, const Seen<Tag, shape>& e, V<Tag> most) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const V<Tag> in_lengths =
            hn::Mul(hn::Mul(square_of(e.taper_rate), most), hn::Set(d, Margin::more));
        return hn::Div(in_lengths, hn::Max(hn::Mul(square_of(e.size), e.inverse_square),
                                           hn::Set(d, least_square<hn::TFromD<Tag>>)));
    }

    // Of a ray of the bundle on the stretch, at least W = w_a + alpha d / |M|^2 in least widths: linear
    // along it, and off by what the ray is off the axis.
    template <class Tag>
    static HWY_INLINE V<Tag> least_cone(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                                        V<Tag> error) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const V<Tag> alpha = hn::Min(dot<Tag>(e.from_axis(s.axis, s.begin), e.m),
                                     dot<Tag>(e.from_axis(s.axis, s.end), e.m));
        const V<Tag> aside = hn::Add(error, hn::Set(d, s.aside()));
        const V<Tag> least = hn::NegMulAdd(hn::Mul(e.size, hn::Set(d, Margin::more)), aside, alpha);
        const V<Tag> share =
            hn::Div(hn::Mul(e.taper_rate, least),
                    hn::Max(square_of(e.size), hn::Set(d, least_square<hn::TFromD<Tag>>)));
        // rounding of the quotient, and of its sum with 1
        return hn::Sub(hn::NegMulAdd(hn::Abs(share), hn::Set(d, Margin::margin), share),
                       hn::Set(d, Margin::margin - 1));
    }

    // Whether the foot is b for all rays on the stretch, and for what rounding makes of (1): there s is
    // that of a point. So it is from kappa q = 1 on, where the ball around b holds all others, but for
    // the apex. psi(1) <= 0 says so: with r the rate and A = |v|^2, in least widths,
    //     E = r A + (1 - r) alpha - |m|^2 >= 0,
    // which is convex along the axis with a second derivative of 2 r.
    template <class Tag>
    static HWY_INLINE M<Tag> ends_at_b(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                                       V<Tag> error) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const V<Tag> one = constant(d, 1), r = e.taper_rate;
        const V<Tag> m_square = square_of(e.size);
        const auto at = [&](hn::TFromD<Tag> t) HWY_ATTR {
            const Vec3v<Tag> v = e.from_axis(s.axis, t);
            return hn::Sub(
                hn::MulAdd(r, dot<Tag>(v, v), hn::Mul(hn::Sub(one, r), dot<Tag>(v, e.m))),
                m_square);
        };
        const hn::TFromD<Tag> half = (s.end - s.begin) / 2 * Margin::more;
        const V<Tag> sag = hn::Mul(r, hn::Set(d, half * half));
        // |v| at most, and how far a ray is from the axis there
        const V<Tag> far = hn::Add(e.magnitude, hn::Set(d, s.magnitude));
        const V<Tag> aside = hn::Add(error, hn::Set(d, s.aside()));
        const V<Tag> reach = hn::Add(far, aside);
        const V<Tag> steepest = hn::MulAdd(hn::Add(r, one), e.size, hn::Mul(hn::Add(r, r), reach));
        const V<Tag> size = hn::MulAdd(
            r, square_of(reach), hn::MulAdd(hn::Mul(hn::Add(r, one), e.size), reach, m_square));
        const V<Tag> off =
            hn::MulAdd(size, hn::Set(d, Margin::margin), hn::MulAdd(steepest, aside, sag));
        return hn::Gt(hn::Min(at(s.begin), at(s.end)), hn::Mul(off, hn::Set(d, Margin::more)));
    }

    // (2), or with w* (|m|^2 + alpha r) = w* |m|^2 W in its place
    //     (D^2)'' / 2 >= 1 - (1 + 2 kappa q)^2 / (W max(W, 1)),
    // or that of a point, whichever says more; `inverse` is what `errors` needs of g, over |m|, with
    // g = w* / W = 1 / (1 - kappa^2 q^2). Where neither says anything nothing is known of f''; the gradient
    // is defined but at the apex itself.
    template <class Tag>
    static HWY_INLINE Turning<Tag> turning(const Seen<Tag, shape>& e,
                                           const Reach<hn::TFromD<Tag>>& s, V<Tag> error,
                                           V<Tag> most) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const V<Tag> square = bent(d, e, most), one = constant(d, 1);
        const V<Tag> widened = hn::Set(d, Margin::more);
        const V<Tag> cone = least_cone(e, s, error);
        const M<Tag> is_low = hn::Lt(square, constant(d, most_bent)),
                     is_wide = hn::Gt(cone, constant(d, least_straight));
        const V<Tag> steeper = hn::MulAdd(constant(d, 2), hn::Sqrt(square), one);
        const V<Tag> wide = hn::Max(cone, constant(d, least_straight));
        const V<Tag> huge = constant(d, 1e12);
        const V<Tag> by_q = hn::IfThenElse(
            is_low, hn::Div(widened, hn::Max(hn::Sub(one, square), constant(d, least_straight))),
            huge);
        const V<Tag> by_cone =
            hn::IfThenElse(is_wide, hn::Div(widened, hn::Mul(wide, hn::Max(wide, one))), huge);
        // The other term of (D^2)'' / 2 is not below 0, which leaves 1 more.
        const V<Tag> steepness = hn::Mul(square_of(steeper), widened);
        const V<Tag> outward = hn::Mul(
            hn::Min(hn::Mul(steepness, by_q), hn::MulAdd(steepness, by_cone, one)), widened);
        // kappa q, at most
        const V<Tag> turn = hn::Mul(hn::Sqrt(square), widened);
        const V<Tag> turned = hn::Mul(
            hn::MulAdd(constant(d, 2), turn, constant(d, 3)),
            hn::Max(hn::Mul(hn::MulAdd(constant(d, 2), turn, one), constant(d, 0.36)), one));
        const V<Tag> of_foot = hn::Min(
            hn::Mul(by_q, constant(d, 5)),
            hn::IfThenElse(
                is_wide,
                hn::Mul(turned, hn::Div(hn::Mul(hn::Add(one, e.taper_rate), widened), wide)),
                huge));
        // Ends that coincide, or nearly, leave the foot open.
        const M<Tag> has_length =
            hn::Gt(e.size, constant(d, sizeof(hn::TFromD<Tag>) == sizeof(float) ? 1e-20 : 1e-150));
        const V<Tag> size = hn::IfThenElse(has_length, e.size, one);
        const V<Tag> known = hn::IfThenElse(hn::And(has_length, hn::Or(is_low, is_wide)),
                                            hn::Div(hn::Mul(of_foot, widened), size), hn::Neg(one));
        // Of a point (D^2)'' is above 0, and nothing turns with the foot.
        const M<Tag> at_b = ends_at_b(e, s, error);
        return {hn::IfThenElse(at_b, hn::Div(widened, size), known),
                hn::IfThenElse(at_b, hn::Min(outward, widened), outward)};
    }
    template <class Tag>
    static HWY_INLINE M<Tag> is_defined(Tag d, const BundleEntry<hn::TFromD<Tag>>&, double,
                                        const Vec3v<Tag>&) {
        return hn::FirstN(d, hn::Lanes(d));
    }

    // x = (p - c*) . d w / w*^2, and w <= w*.
    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    // With r the rate, omega = 1 + u r and g = 1 / (1 - kappa^2 q^2), what stands before u in (1) is
    // |m|^2 omega / g, all in least widths. With v = p - a off by eta and m by 3 u |m|, alpha is off by
    // |m| (eta + 12 u |v|) and A by 2 |v| eta + 10 u |v|^2; so u is off by du with
    //     |m| du <= g / omega ((1 + u r + 2 r |v| / |m|) (eta + 12 u |v|) + 8 u omega |m|),
    // and since |v| <= u |m| + omega D and r D = kappa q |m|, by
    //     X = (3 + 2 kappa q) g (eta + 12 u |v| + 2 u |m|),
    // with kappa q <= 0.9, 4.8 g, where the first bound of `turning` holds. D^2 is then larger by
    // |m|^2 omega du^2 / omega^3 at most, and so D by X at most; rounding takes some 8 u |v| + 4 u |m|
    // more, and moves widths by 2 u of themselves. `away` turns with the place of the foot, and with
    // its width twice, by no more than (1 + 2 kappa q) times all that: 2.8 times, or `inverse` has
    // the rest (0.36 > 1 / 2.8).
    // Where nothing is known the slope counts as unknown too, and there are two cases. If kappa q <=
    // 0.9 for a place of the stretch, g <= 5.3 there, and D is larger by 26.5 (eta + ...). Else, with d
    // the error of both sides of (1), |m| K (eta + 12 u |v|) where K = 1 + 2 r + 2 r |v| / |m|, D^2 is
    // larger by no more than the factor times du^2, where du <= 1 and du <= d over that factor: by d,
    // and D by d / (2 D), where |m| / D <= 1.12 r.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag> inverse) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const double u = on.u;
        eta = hn::MulAdd(c(24 * u), v_length, hn::MulAdd(c(8 * u), e.size, eta));
        const V<Tag> per_size = hn::Div(hn::Add(v_length, v_length),
                                        hn::Max(e.size, hn::Set(d, least_square<hn::TFromD<Tag>>)));
        const V<Tag> k = hn::MulAdd(e.taper_rate, hn::Add(c(2), per_size), c(1));
        const V<Tag> known = hn::MulAdd(c(1.01), hn::Mul(inverse, e.size), c(1));
        const V<Tag> unknown = hn::MulAdd(e.taper_rate, k, c(28));
        const V<Tag> value =
            hn::Mul(eta, hn::IfThenElse(hn::Lt(inverse, hn::Zero(d)), unknown, known));
        return {value, hn::Mul(value, c(1.9))};
    }
};

template <>
struct ShapeLanes<TaperedSegment> : TaperLanes<shape_of<TaperedSegment>> {};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
