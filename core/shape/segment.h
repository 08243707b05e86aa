// A segment from a to b: with v = p - a, M = b - a and the foot lambda = v.M / |M|^2 clamped to [0, 1],
// s = |v - lambda M|^2 / w^2.
#ifndef IVORY_CORE_SHAPE_SEGMENT_H
#define IVORY_CORE_SHAPE_SEGMENT_H

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>

#include "core/shape/along_ray.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

struct SegmentSkeleton {
    Vec3d a, b;  // may coincide
    friend bool operator==(const SegmentSkeleton&, const SegmentSkeleton&) = default;

    static constexpr std::string_view word = "segment";
    static constexpr std::string_view label = "Segment";
    static constexpr std::string_view distance =
        "to the foot of p on the line, kept between the ends";
    static constexpr auto members() {
        return std::tuple{place("a", "End a", &SegmentSkeleton::a),
                          place("b", "End b", &SegmentSkeleton::b)};
    }

    static constexpr bool has_kinks = false;
    // m = b - a; parameter = 1 / |m|^2, 0 where that is shorter than 1e-40 and stands for its end a.
    // With a list of widths: core/shape/taper.h.
    static constexpr bool may_taper = true, is_taper = false, is_joined = false,
                          has_numbers = false;
    static constexpr std::size_t width_places() { return 2; }
    static constexpr bool has_axis = true;
    static constexpr int m_power = 1, parameter_power = -2;

    [[nodiscard]] const SegmentSkeleton& segment(std::size_t) const { return *this; }

    [[nodiscard]] Vec3d middle() const { return 0.5 * a + 0.5 * b; }
    [[nodiscard]] SkeletonColumns columns() const {
        SkeletonColumns c{a, b, b - a};
        const double square = dot(c.m, c.m);
        c.length = std::sqrt(square);
        c.parameter = c.length > 1e-40 ? 1 / square : 0;
        return c;
    }

    static Surroundings surroundings(const SkeletonColumns& c) { return {box(c)}; }
    static Box3 box(const SkeletonColumns& c) {
        Box3 box{c.a, c.a};
        box.include({c.b, c.b});
        return box;
    }
    static Ball ball(const SkeletonColumns& c) {
        constexpr double more = 1 + 0x1p-40;  // far more than the roundings of a length
        const Vec3d middle = 0.5 * c.a + 0.5 * c.b;
        const Vec3d to_a = c.a - middle, to_b = c.b - middle;
        return {middle, std::max(std::sqrt(dot(to_a, to_a)), std::sqrt(dot(to_b, to_b))) * more};
    }

    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        const Vec3d to_a = c.a - from, to_b = c.b - from;
        return dot(to_b, direction) > dot(to_a, direction) ? to_b : to_a;
    }

    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        const Vec3d v{from_a.x / width, from_a.y / width, from_a.z / width};
        const Vec3d along = c.b - c.a;
        const Vec3d m{along.x / width, along.y / width, along.z / width};
        const double mm = dot(m, m);
        const double lambda = mm > 0 ? std::fmin(std::fmax(dot(v, m) / mm, 0.0), 1.0) : 0;
        const Vec3d away = v - lambda * m;
        return {dot(away, away), away};
    }

    // The foot of p(t) on the line A + lambda M is lambda(t) = (v(t).M) / |M|^2, affine in t. Where it
    // is below 0 or above 1 the end is nearest, between the two the line is; at lambda = 0 and 1 the
    // squares meet with equal slopes. The times of the two changes are known within an error, so the
    // pieces overlap by it.
    static bool along_ray(const SkeletonColumns& c, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        using namespace along_ray_detail;
        const Interval<double>& span = ray.span;
        const double cut = ray.cut;
        const Relative from_a = relative_to(c.a, width, ray.origin, ray.direction);
        const Vec3d m = from_a.scale * (c.b - c.a);  // within 3.01 u
        const double m_norm = one_norm(m);
        if (!(m_norm > 1e-120)) return set_point(e, from_a, 2 * m_norm, span, cut);
        if (!(m_norm < 1e100)) return false;
        const Relative from_b = relative_to(c.b, width, ray.origin, ray.direction);
        const double mm = dot(m, m);
        const double length = std::sqrt(mm);

        const double lambda0 = dot(from_a.offset_vector, m) / mm;
        const double lambda1 = dot(from_a.direction, m) / mm;
        // |d lambda| over the span: the data err by 3.01 u each, the dot products by 3 u, the quotient
        // by 5 u, the product with t and the sum by 2 u, all of (|offset| + |t direction|) / |M|.
        const double lambda_error =
            32 * u * (from_a.offset_norm + mag(span) * from_a.direction_norm) / length + 1e-300;
        const double at_start = lambda0 + lambda1 * span.lo;
        const double at_end = lambda0 + lambda1 * span.hi;
        const Interval<double> lambda{std::min(at_start, at_end) - lambda_error,
                                      std::max(at_start, at_end) + lambda_error};

        // The time at which lambda(t) = value, within the error; the whole span where lambda hardly
        // moves.
        const auto crossing = [&](double value) -> Interval<double> {
            const double speed = std::abs(lambda1);
            if (!(speed * (span.hi - span.lo) > 8 * lambda_error)) return span;
            const double t = (value - lambda0) / lambda1;
            const double error = 2 * lambda_error / speed + 8 * u * std::abs(t);
            return {t - error, t + error};
        };
        const bool forward = lambda1 > 0;
        const Interval<double> enters = crossing(forward ? 0 : 1);
        const Interval<double> leaves = crossing(forward ? 1 : 0);
        const Relative& first = forward ? from_a : from_b;
        const Relative& last = forward ? from_b : from_a;
        const bool first_possible = forward ? lambda.lo < 0 : lambda.hi > 1;
        const bool last_possible = forward ? lambda.hi > 1 : lambda.lo < 0;
        const bool middle_possible = lambda.hi >= 0 && lambda.lo <= 1;

        SquaresAlongRay& squares = e.form.emplace<SquaresAlongRay>();
        bool fits = true;
        e.active = Interval<double>::empty_set();
        const auto add = [&](const MovingSquare& square, const Interval<double>& where,
                             double reach) {
            e.active = hull(e.active, intersection(sublevel(square, cut), where));
            squares.add({square, where});
            fits = fits && usable(square.kappa, reach + square.rho, mag(span));
        };
        const auto within = [&](double lo, double hi) {
            return intersection(span, Interval<double>(lo, hi));
        };
        if (const auto where = within(span.lo, enters.hi); first_possible && !is_empty(where)) {
            add(from_point(first, where), where, first.offset_norm);
        }
        if (const auto where = within(enters.lo, leaves.hi); middle_possible && !is_empty(where)) {
            const Vec3d axis{m.x / length, m.y / length, m.z / length};
            const MovingSquare square = from_axis(from_a, axis, where).across;
            // A ray along the segment leaves no speed across it, which the lemma allows.
            e.active = hull(e.active, intersection(sublevel(square, cut), where));
            squares.add({square, where});
            fits =
                fits && usable(from_a.direction_norm, from_a.offset_norm + square.rho, mag(span));
        }
        if (const auto where = within(leaves.lo, span.hi); last_possible && !is_empty(where)) {
            add(from_point(last, where), where, last.offset_norm);
        }
        return fits && squares.count > 0;
    }

    // `scale` = 1 / w; `start` + t `rate` leads from a to p(t), in widths.
    static void see(const SkeletonColumns& c, const natural::Span& scale,
                    const natural::Vector& origin, const natural::Vector& start,
                    const natural::Vector& rate, natural::RaySkeleton& e) {
        using namespace natural;
        e.axis = times(scale, minus(vector(c.b), vector(c.a)));
        const Span length_square = inner(e.axis, e.axis);
        if (c.a == c.b) {
            e.collapsed = true;
        } else if (!(length_square.lo > 1e-250)) {
            e.bounded = false;
        } else {
            e.from_b = moving(times(scale, minus(origin, vector(c.b))), rate);
            e.along = {quick::div(inner(e.axis, start), length_square),
                       quick::div(inner(e.axis, rate), length_square)};
            e.across = moving(minus(start, times(e.along.start, e.axis)),
                              minus(rate, times(e.along.rate, e.axis)));
        }
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return segment_square(e, t);  // as each number type has it
    }
};

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/shape/shape_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// Of any shape whose elements are segments to a field.
template <Shape shape>
struct SegmentLanes {
    template <class Tag>
    static HWY_INLINE V<Tag> clamped(V<Tag> along, V<Tag> parameter) {
        return hn::Min(at_least_0(hn::Mul(along, parameter)), constant(Tag(), 1));
    }

    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        const Vec3v<Tag> v = from_first_place(d, e, p);
        const Vec3v<Tag> m{hn::Set(d, e.mx), hn::Set(d, e.my), hn::Set(d, e.mz)};
        const V<Tag> foot = clamped<Tag>(dot<Tag>(v, m), hn::Set(d, e.parameter));
        const Vec3v<Tag> away = less_share(v, m, foot);
        square = dot<Tag>(away, away);
        return away;
    }

    // Of a convex set's other places y |p - y|^2 >= |p - foot|^2 + |foot - y|^2. One whose 1 / |m|^2 counts as 0
    // stands for its end a.
    template <class Tag>
    static HWY_INLINE PartFoot<Tag> part_foot(const Seen<Tag, shape>& e,
                                              const Reach<hn::TFromD<Tag>>& s, hn::TFromD<Tag> t,
                                              V<Tag>, V<Tag> error) {
        const Tag d;
        const Vec3v<Tag> from = e.from_axis(s.axis, t);
        PartFoot<Tag> part;
        part.foot.away = less_share(from, e.m, clamped<Tag>(dot<Tag>(from, e.m), e.parameter));
        part.foot.square = dot<Tag>(part.foot.away, part.foot.away);
        part.foot.slack = part.foot.pull = hn::Zero(d);
        part.foot.bend = constant(d, 2);
        part.error = hn::Add(error, hn::IfThenElseZero(hn::Eq(e.parameter, hn::Zero(d)), e.size));
        part.length = e.size;
        part.never = hn::FirstN(d, 0);
        return part;
    }

    // The distance of the axis' point at t.
    template <class Tag>
    static HWY_INLINE V<Tag> distance_at(const Seen<Tag, shape>& e,
                                         const Vec3<hn::TFromD<Tag>>& axis, hn::TFromD<Tag> t) {
        const Vec3v<Tag> from = e.from_axis(axis, t);
        return length_of(Tag(),
                         less_share(from, e.m, clamped<Tag>(dot<Tag>(from, e.m), e.parameter)));
    }

    // On a long stretch a ball around the skeleton, or its whole line, says more than (1). Between
    // two places the distance to a convex set is at most the greater of those there.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using Real = hn::TFromD<Tag>;
        const Tag d;
        const V<Tag> d0 = distance_at(e, s.axis, s.begin), d1 = distance_at(e, s.axis, s.end);
        const V<Tag> half = constant(d, 0.5);
        const Vec3v<Tag> center{hn::MulAdd(half, e.m.x, e.v.x), hn::MulAdd(half, e.m.y, e.v.y),
                                hn::MulAdd(half, e.m.z, e.v.z)};
        V<Tag> near = nearest_of_ends_and_ball(d, d0, d1, center, hn::Mul(half, e.size), s, error);
        if constexpr (sizeof(Real) == sizeof(double)) {
            // |v . (axis x m)| / |axis x m|, unless they are nearly parallel
            const Vec3v<D> n{
                hn::Sub(hn::Mul(constant(s.axis.y), e.m.z), hn::Mul(constant(s.axis.z), e.m.y)),
                hn::Sub(hn::Mul(constant(s.axis.z), e.m.x), hn::Mul(constant(s.axis.x), e.m.z)),
                hn::Sub(hn::Mul(constant(s.axis.x), e.m.y), hn::Mul(constant(s.axis.y), e.m.x))};
            const V<D> n_square = dot<D>(n, n);
            const V<D> line = hn::Div(hn::Abs(dot<D>(e.v, n)), hn::Sqrt(n_square));
            const auto crosses = hn::Gt(n_square, hn::Mul(constant(0x1p-12), square_of(e.size)));
            near = hn::IfThenElse(
                crosses, hn::Max(near, hn::NegMulAdd(constant(0x1p-38), e.magnitude, line)), near);
        }
        return range_of_rays(d, e.magnitude, near, hn::Max(d0, d1), s, error);
    }

    // x^2 <= s: mathematics of core/field/bundle_field.h.
    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    // The foot moves away by 10 u |p - c| more at the most. One whose 1 / |m|^2 counts as 0 stands for
    // its end a.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag>) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const double u = on.u;
        eta = hn::MulAdd(c(2), eta, hn::MulAdd(c(12 * u), v_length, hn::Mul(c(3 * u), e.size)));
        return {hn::Add(eta, hn::IfThenElseZero(hn::Eq(e.parameter, hn::Zero(d)), e.size)),
                hn::Zero(d)};
    }
};

template <>
struct ShapeLanes<SegmentSkeleton> : SegmentLanes<shape_of<SegmentSkeleton>> {};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
