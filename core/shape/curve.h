// A Bezier curve, quadratic or cubic: with c(u) its place that is nearest to p, s = |p - c(u)|^2 / w^2. It is
// the union of short arcs (core/shape/curve_arc.h), which are joined (core/shape/joined.h).
#ifndef IVORY_CORE_SHAPE_CURVE_H
#define IVORY_CORE_SHAPE_CURVE_H

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/shape/along_ray.h"
#include "core/shape/curve_arc.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

struct CurveSkeleton {
    std::vector<Vec3d> control_points{{0, 0, 0}, {0.5, 1, 0}, {1, 0, 0}};  // 3 or 4

    CurveSkeleton() = default;
    explicit CurveSkeleton(std::vector<Vec3d> points) : control_points(std::move(points)) {}
    friend bool operator==(const CurveSkeleton&, const CurveSkeleton&) = default;

    static constexpr std::string_view word = "curve";
    static constexpr std::string_view label = "Curve";
    static constexpr std::string_view distance = "to the nearest place of the Bézier curve";
    static constexpr auto members() {
        return std::tuple{
            places<3, 4>("control_points", "Control points", &CurveSkeleton::control_points)};
    }

    // Where p is farther away than the curve is bent, two places of an arc may be equally near.
    static constexpr bool has_kinks = true;
    // parameter = the control points' greatest distance from the first; numbers: curve_arc.h.
    static constexpr bool may_taper = false, is_taper = false;
    static constexpr bool is_joined = true, has_numbers = true, has_axis = true;
    static constexpr int m_power = 0, parameter_power = 1;

    [[nodiscard]] Vec3d middle() const { return middle_of(control_points); }

    [[nodiscard]] std::vector<SkeletonPart> split() const { return curve_arcs(control_points); }
    static std::size_t size_of(const SkeletonColumns&) { return curve_arc::most_numbers; }
    static float in_units(const SkeletonColumns&, std::size_t k, double value, double per_unit) {
        return curve_arc::in_units(k, value, per_unit);
    }

    static Surroundings surroundings(const SkeletonColumns& c) {
        return {box_of_arc(c), off_by(c)};
    }
    static Box3 box(const SkeletonColumns& c) { return widened(box_of_arc(c), off_by(c)); }
    static Ball ball(const SkeletonColumns& c) {
        using namespace curve_arc;
        return {c.a + vector(c, at_k0), (c.numbers[at_radius] + off_by(c)) * (1 + 0x1p-40)};
    }
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        using namespace curve_arc;
        Vec3d best;
        double most = -infinity<double>;
        const auto look = [&](double x) {
            const Vec3d to_place = (c.a - from) + place(c, x);
            const double along = dot(to_place, direction);
            if (along > most) best = to_place;
            most = std::max(most, along);
        };
        look(-1);
        look(1);
        const double half = dot(vector(c, at_k2), direction),
                     first = dot(vector(c, at_k1), direction),
                     last = 3 * dot(vector(c, at_k3), direction);
        for_turns(first, half, last, look);
        return best;
    }

    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        const curve_arc::OffArc off =
            curve_arc::off_arc(c.numbers, from_a - vector(c, curve_arc::at_k0));
        const Vec3d away{off.away.x / width, off.away.y / width, off.away.z / width};
        return {dot(away, away), away, off.one_place};
    }

    static bool along_ray(const SkeletonColumns& c, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        const BallAlongRay around(ball(c), width, ray);
        if (!around.fits) return false;
        e.form = CurveAlongRay{c.a,       ray.origin,    ray.direction, width,
                               c.numbers, around.middle, around.radius};
        e.active = around.active(ray.cut);
        return true;
    }

    static void see(const SkeletonColumns& c, const natural::Span&, const natural::Vector&,
                    const natural::Vector&, const natural::Vector&, natural::RaySkeleton& e) {
        e.curve.a = c.a;
        e.curve.numbers = c.numbers;
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return natural::as_number(
            t, [&](const natural::Span& x) { return natural::curve_arc_over(e, x); });
    }

  private:
    static Vec3d vector(const SkeletonColumns& c, std::size_t k) {
        return {c.numbers[k], c.numbers[k + 1], c.numbers[k + 2]};
    }
    // Relative to a.
    static Vec3d place(const SkeletonColumns& c, double x) {
        using namespace curve_arc;
        return vector(c, at_k0) +
               x * (vector(c, at_k1) + x * (vector(c, at_k2) + x * vector(c, at_k3)));
    }
    // Numbers are off by u of themselves, none is larger than 8 sizes, and the sums by as much.
    static double off_by(const SkeletonColumns& c) {
        const double largest =
            std::max({std::abs(c.a.x), std::abs(c.a.y), std::abs(c.a.z)}) + c.parameter;
        return 0x1p-46 * c.parameter + 0x1p-50 * largest;
    }
    // Of the arc itself: its ends, and where a coordinate turns. A place beside one where it does is off by
    // the square of that.
    static Box3 box_of_arc(const SkeletonColumns& c) {
        using namespace curve_arc;
        Box3 box;
        const auto include = [&](double x) {
            const Vec3d at = c.a + place(c, x);
            box.include({at, at});
        };
        include(-1);
        include(1);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for_turns(c.numbers[at_k1 + axis], c.numbers[at_k2 + axis], 3 * c.numbers[at_k3 + axis],
                      include);
        }
        return box;
    }
    // visit(x) of the zeros of first + 2 half x + last x^2 between the ends.
    template <class Visit>
    static void for_turns(double first, double half, double last, const Visit& visit) {
        const double root = std::sqrt(std::max(half * half - first * last, 0.0));
        const double larger = -(half + std::copysign(root, half));
        for (const double x : {larger / last, first / larger}) {
            if (x > -1 && x < 1) visit(x);
        }
    }
};

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/shape/shape_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <>
struct ShapeLanes<CurveSkeleton> {
    static constexpr Shape shape = shape_of<CurveSkeleton>;

    template <class Real>
    static constexpr int newton_steps = sizeof(Real) == sizeof(float) ? 5 : 8;

    // From the nearest place of an arc to k0 + v, its square, and nothing proved of it: of the two ends,
    // the middle and where Newton leads from there, the last unless another is clearly nearer.
    template <class Tag>
    struct OffArc {
        Vec3v<Tag> from;
        V<Tag> square;
    };
    template <class Tag, class Number>
    static HWY_INLINE OffArc<Tag> off_arc(Tag d, const Number& number, const Vec3v<Tag>& v) {
        using namespace curve_arc;
        using Real = hn::TFromD<Tag>;
        const auto vector = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return Vec3v<Tag>{number(k), number(k + 1), number(k + 2)};
        };
        const Vec3v<Tag> k1 = vector(at_k1), k2 = vector(at_k2), k3 = vector(at_k3);
        const V<Tag> one = constant(d, 1), two = constant(d, 2), three = constant(d, 3);
        const V<Tag> g0 = dot<Tag>(v, k1), g1 = hn::MulSub(two, dot<Tag>(v, k2), number(at_g)),
                     g2 = hn::MulSub(three, dot<Tag>(v, k3), number(at_g + 1)),
                     g3 = hn::Neg(number(at_g + 2)), g4 = hn::Neg(number(at_g + 3)),
                     g5 = hn::Neg(number(at_g + 4));
        const V<Tag> s1 = hn::Add(g2, g2), s2 = hn::Mul(three, g3),
                     s3 = hn::Mul(constant(d, 4), g4), s4 = hn::Mul(constant(d, 5), g5);
        const V<Tag> falls = hn::Set(d, -least_square<Real>);
        const auto onward = [&](V<Tag> x, V<Tag> g, V<Tag> slope) HWY_ATTR
            __attribute__((always_inline)) {
            const V<Tag> next = hn::Sub(x, hn::Div(g, hn::Min(slope, falls)));
            return hn::Min(hn::Max(next, hn::Neg(one)), one);
        };
        V<Tag> x = onward(hn::Zero(d), g0, g1);
        for (int step = 1; step < newton_steps<Real>; ++step) {
            const V<Tag> g = hn::MulAdd(
                x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, g5, g4), g3), g2), g1),
                g0);
            const V<Tag> slope =
                hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, s4, s3), s2), s1), g1);
            x = onward(x, g, slope);
        }
        const auto away = [&](V<Tag> k1i, V<Tag> k2i, V<Tag> k3i, V<Tag> vi) HWY_ATTR
            __attribute__((always_inline)) {
            return hn::NegMulAdd(x, hn::MulAdd(x, hn::MulAdd(x, k3i, k2i), k1i), vi);
        };
        OffArc<Tag> best{
            {away(k1.x, k2.x, k3.x, v.x), away(k1.y, k2.y, k3.y, v.y), away(k1.z, k2.z, k3.z, v.z)},
            hn::Zero(d)};
        best.square = dot<Tag>(best.from, best.from);
        const V<Tag> clearly = hn::Set(d, 1 - 16 * Margins<Real>::margin);
        const auto compare = [&](const Vec3v<Tag>& from) HWY_ATTR __attribute__((always_inline)) {
            const V<Tag> square = dot<Tag>(from, from);
            const M<Tag> nearer = hn::Lt(square, hn::Mul(best.square, clearly));
            best = {{hn::IfThenElse(nearer, from.x, best.from.x),
                     hn::IfThenElse(nearer, from.y, best.from.y),
                     hn::IfThenElse(nearer, from.z, best.from.z)},
                    hn::IfThenElse(nearer, square, best.square)};
        };
        const Vec3v<Tag> begin = vector(at_begin), end = vector(at_end);
        compare({hn::Sub(v.x, begin.x), hn::Sub(v.y, begin.y), hn::Sub(v.z, begin.z)});
        compare({hn::Sub(v.x, end.x), hn::Sub(v.y, end.y), hn::Sub(v.z, end.z)});
        compare(v);
        return best;
    }

    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        const hn::TFromD<Tag>* const numbers = e.numbers();
        const auto number = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return hn::Set(d, numbers[k]);
        };
        const Vec3v<Tag> from = from_first_place(d, e, p);
        const OffArc<Tag> off = off_arc(d, number,
                                        Vec3v<Tag>{hn::Sub(from.x, number(curve_arc::at_k0)),
                                                   hn::Sub(from.y, number(curve_arc::at_k0 + 1)),
                                                   hn::Sub(from.z, number(curve_arc::at_k0 + 2))});
        square = off.square;
        return off.from;
    }

    // Of one place c(x), the nearest as far as five of them and Newton's steps tell. With h(y) = (g(y) - g(x)) /
    // (y - x), a polynomial of the fourth degree,
    //     |v - c(y)|^2 = |v - c(x)|^2 - 2 g(x) (y - x) - 2 (integral of (s - x) h(s) from x to y)
    //                 >= square - 2 G |y - x| + q (y - x)^2,
    // -q the greatest of h's Bernstein coefficients on [-1, 1] and G = |g(x)|; at an end that g leads out of G is
    // 0 and q larger by |g|, as |y - x| <= 2. After a way t of the ray that is less by no more than 2 |t| F |y - x|
    // beside what c(x) alone does, F the greatest |c'|: so slack = G^2 / q, and the foot is within |y - x| <= 2 (G
    // + |t| F) / q. Where D is concave along the arc, which it stays while |g'| changes by less than reach |c''|,
    // an end is the nearest: that which no other arc has.
    // What rounding does is as if v and the coefficients of c were others (`errors`), and, with S = (|v| + R) R,
    // R = |k1| + |k2| + |k3| and the sum of all |g_k| <= 3 S, 64 u S in g, 512 u S in q and 2048 u S in g'.
    template <class Tag>
    static HWY_INLINE ProvedFoot<Tag> proved_foot(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                                  const Vec3v<Tag>& p, V<Tag> reach) {
        using namespace curve_arc;
        using Real = hn::TFromD<Tag>;
        using Margin = Margins<Real>;
        const Real* const numbers = e.numbers();
        const auto number = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return hn::Set(d, numbers[k]);
        };
        const auto vector = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return Vec3v<Tag>{number(k), number(k + 1), number(k + 2)};
        };
        const Vec3v<Tag> from = from_first_place(d, e, p);
        const Vec3v<Tag> v{hn::Sub(from.x, number(at_k0)), hn::Sub(from.y, number(at_k0 + 1)),
                           hn::Sub(from.z, number(at_k0 + 2))};
        const Vec3v<Tag> k1 = vector(at_k1), k2 = vector(at_k2), k3 = vector(at_k3);
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const V<Tag> zero = hn::Zero(d), one = c(1), minus_one = c(-1);
        const auto away_at = [&](V<Tag> x) HWY_ATTR __attribute__((always_inline)) {
            const auto away = [&](V<Tag> k1i, V<Tag> k2i, V<Tag> k3i, V<Tag> vi) HWY_ATTR
                __attribute__((always_inline)) {
                return hn::NegMulAdd(x, hn::MulAdd(x, hn::MulAdd(x, k3i, k2i), k1i), vi);
            };
            return Vec3v<Tag>{away(k1.x, k2.x, k3.x, v.x), away(k1.y, k2.y, k3.y, v.y),
                              away(k1.z, k2.z, k3.z, v.z)};
        };
        const auto square_at = [&](V<Tag> x) HWY_ATTR __attribute__((always_inline)) {
            const Vec3v<Tag> away = away_at(x);
            return dot<Tag>(away, away);
        };

        // The nearest of five places, and on from there.
        const V<Tag> at_first = square_at(minus_one), at_last = square_at(one);
        V<Tag> x = hn::IfThenElse(hn::Lt(at_first, at_last), minus_one, one);
        V<Tag> least = hn::Min(at_first, at_last);
        for (const double place : {-0.5, 0.0, 0.5}) {
            const V<Tag> square = square_at(c(place));
            x = hn::IfThenElse(hn::Lt(square, least), c(place), x);
            least = hn::Min(least, square);
        }
        const V<Tag> g0 = dot<Tag>(v, k1), g1 = hn::MulSub(c(2), dot<Tag>(v, k2), number(at_g)),
                     g2 = hn::MulSub(c(3), dot<Tag>(v, k3), number(at_g + 1)),
                     g3 = hn::Neg(number(at_g + 2)), g4 = hn::Neg(number(at_g + 3)),
                     g5 = hn::Neg(number(at_g + 4));
        const V<Tag> s1 = hn::Add(g2, g2), s2 = hn::Mul(c(3), g3), s3 = hn::Mul(c(4), g4),
                     s4 = hn::Mul(c(5), g5);
        const V<Tag> falls = hn::Set(d, -least_square<Real>), begun = x;
        for (int step = 0; step < newton_steps<Real>; ++step) {
            const V<Tag> g = hn::MulAdd(
                x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, g5, g4), g3), g2), g1),
                g0);
            const V<Tag> slope =
                hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, s4, s3), s2), s1), g1);
            x = hn::Min(hn::Max(hn::Sub(x, hn::Div(g, hn::Min(slope, falls))), minus_one), one);
        }
        x = hn::IfThenElse(hn::Lt(least, square_at(x)), begun, x);

        const V<Tag> R = number(at_radius);
        const V<Tag> S =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Add(hn::Abs(v.z), R)), R);
        const V<Tag> error =
            hn::MulAdd(S, c(4 * double{Margin::margin}), hn::Mul(number(at_lost_square), c(64)));
        // On all of the arc and of the reach: g' as far as it is above that, in Bernstein's form.
        const V<Tag> even = hn::Add(g1, hn::Add(s2, s4)), odd = hn::Add(s1, s3),
                     inner = hn::Sub(g1, s4), half_odd = hn::Mul(c(0.5), hn::Sub(s1, s3));
        const V<Tag> least_rise =
            hn::Min(hn::Min(hn::Sub(even, hn::Abs(odd)), hn::Sub(inner, hn::Abs(half_odd))),
                    hn::Add(hn::NegMulAdd(c(1.0 / 3), s2, g1), s4));
        const V<Tag> own_end = number(at_own_end);
        const M<Tag> is_end =
            hn::And(hn::Gt(hn::NegMulAdd(c(4), error, least_rise),
                           hn::Mul(hn::Mul(reach, number(at_turn)), hn::Set(d, Margin::more))),
                    hn::Lt(own_end, c(1.5)));
        const V<Tag> nearer_end = hn::IfThenElse(hn::Lt(at_first, at_last), minus_one, one);
        x = hn::IfThenElse(is_end, hn::IfThenElse(hn::Eq(own_end, zero), nearer_end, own_end), x);

        const V<Tag> h4 = g5, h3 = hn::MulAdd(x, h4, g4), h2 = hn::MulAdd(x, h3, g3),
                     h1 = hn::MulAdd(x, h2, g2), h0 = hn::MulAdd(x, h1, g1),
                     g = hn::MulAdd(x, h0, g0);
        const V<Tag> greatest =
            hn::Max(hn::Max(hn::Add(hn::Add(h0, hn::Add(h2, h4)), hn::Abs(hn::Add(h1, h3))),
                            hn::Add(hn::Sub(h0, h4), hn::Abs(hn::Mul(c(0.5), hn::Sub(h1, h3))))),
                    hn::Add(hn::NegMulAdd(c(1.0 / 3), h2, h0), h4));
        const V<Tag> outward =
            at_least_0(hn::Sub(hn::IfThenElseZero(hn::Eq(hn::Abs(x), one), hn::Mul(g, x)), error));
        const V<Tag> q = hn::Sub(hn::Sub(outward, greatest), error);
        const V<Tag> G =
            hn::IfThenElseZero(hn::Eq(outward, zero), hn::MulAdd(error, c(0.125), hn::Abs(g)));
        const V<Tag> fastest = number(at_fastest), widened = c(1 + 0x1p-10);
        const M<Tag> known = hn::Gt(q, hn::Mul(error, c(0x1p-3)));
        const V<Tag> inverse = hn::Div(widened, hn::IfThenElse(known, q, one));
        const V<Tag> at_most = hn::Mul(hn::Add(G, hn::Abs(hn::Min(q, zero))), c(4 * (1 + 0x1p-10)));
        ProvedFoot<Tag> foot;
        foot.away = away_at(x);
        foot.square = dot<Tag>(foot.away, foot.away);
        // Of an end nothing else is asked, and where nothing is known there is d' <= 1.
        const V<Tag> of_known = hn::Min(at_most, hn::Mul(square_of(G), inverse));
        foot.slack = hn::IfThenZeroElse(is_end, hn::IfThenElse(known, of_known, at_most));
        const M<Tag> is_bounded = hn::AndNot(is_end, known);
        foot.bend =
            hn::IfThenElseZero(is_bounded, hn::Mul(hn::Mul(c(2), square_of(fastest)), inverse));
        const V<Tag> anything =
            hn::Mul(hn::Add(hn::Sqrt(foot.square), reach), c(2 * (1 + 0x1p-10)));
        foot.pull = hn::IfThenZeroElse(
            is_end,
            hn::IfThenElse(known, hn::Mul(hn::Mul(c(2), hn::Mul(fastest, G)), inverse), anything));
        foot.in_reach = hn::Or(is_end, hn::Not(known));
        return foot;
    }

    // Some arcs' middles, from where places are relative to; and the axis' point at t from there.
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> middle_of(const Seen<Tag, shape>& e) {
        using namespace curve_arc;
        return {hn::Add(e.v.x, e.number(at_k0)), hn::Add(e.v.y, e.number(at_k0 + 1)),
                hn::Add(e.v.z, e.number(at_k0 + 2))};
    }
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> from_middle(const Vec3v<Tag>& middle,
                                             const Vec3<hn::TFromD<Tag>>& axis, hn::TFromD<Tag> t) {
        const Tag d;
        return {hn::Sub(hn::Set(d, t * axis.x), middle.x),
                hn::Sub(hn::Set(d, t * axis.y), middle.y),
                hn::Sub(hn::Set(d, t * axis.z), middle.z)};
    }

    // At most so much is (best^2 - d^2), best from one of x = -1, 0, 1 or nearer: where D' = 0 the next of
    // these is half as far away as they are apart, and on the way there |D''| / 2 <= |c'|^2 + (d + |c'| / 2)
    // |c''|; else an end is the nearest.
    template <class Tag>
    static HWY_INLINE V<Tag> excess(Tag d, V<Tag> fastest, V<Tag> turn, V<Tag> distance) {
        const V<Tag> farthest = hn::MulAdd(fastest, constant(d, 0.5), distance);
        return hn::Mul(hn::MulAdd(farthest, turn, square_of(fastest)),
                       constant(d, 0.25 * (1 + 0x1p-10)));
    }

    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using namespace curve_arc;
        using Real = hn::TFromD<Tag>;
        const Tag d;
        // of c, and of the choice
        error =
            hn::MulAdd(hn::Add(hn::Add(e.magnitude, hn::Set(d, s.magnitude)), e.number(at_fastest)),
                       hn::Set(d, 16 * Margins<Real>::margin), error);
        const auto number = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return e.number(k);
        };
        const Vec3v<Tag> middle = middle_of(e);
        const V<Tag> fastest = number(at_fastest), turn = number(at_turn);
        struct AtEnd {
            V<Tag> least, here, at_other;
        };
        const auto at_end = [&](Real t, Real other) HWY_ATTR __attribute__((always_inline)) {
            const OffArc<Tag> off = off_arc(d, number, from_middle(middle, s.axis, t));
            const Real way = other - t;
            const Vec3v<Tag> there{hn::Add(off.from.x, hn::Set(d, way * s.axis.x)),
                                   hn::Add(off.from.y, hn::Set(d, way * s.axis.y)),
                                   hn::Add(off.from.z, hn::Set(d, way * s.axis.z))};
            const V<Tag> here = hn::Sqrt(off.square);
            const V<Tag> least = hn::Sqrt(
                at_least_0(hn::Sub(off.square, excess(d, fastest, turn, hn::Add(here, error)))));
            return AtEnd{at_least_0(hn::Sub(least, error)), here, length_of(d, there)};
        };
        const AtEnd first = at_end(s.begin, s.end), last = at_end(s.end, s.begin);
        const V<Tag> near = hn::Max(
            least_between(d, first.least, last.least, (s.end - s.begin) * Margins<Real>::more),
            hn::Sub(FromAxis<Tag>(middle, s.axis).nearest(s.begin, s.end),
                    hn::Add(number(at_radius), error)));
        const V<Tag> far =
            hn::Min(hn::Max(first.here, first.at_other), hn::Max(last.here, last.at_other));
        return range_of_rays(d, e.magnitude, near, far, s, error);
    }

    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    static constexpr double most_bent = 0.8;

    // 3 |c'.c''|, or what makes no difference beside it.
    template <class Tag>
    static HWY_INLINE V<Tag> speed_change(Tag d, V<Tag> speeding, V<Tag> square) {
        return hn::Max(hn::Mul(constant(d, 3), speeding), hn::Mul(constant(d, 0x1p-5), square));
    }

    // With B < 1 an upper bound of (p - c).c'' / |c'|^2 the foot is unique, and
    // s'' w^2 / 2 >= 1 - 1 / (1 - B), where
    //     (p - c).c'' <= d |c''|,  or  2 v.k2 + |v| |c'''| + |c'.c''| + |c''| (|k2| + |k3|) + |k1| |c'''|,
    // in which v.k2 is linear along the stretch. `inverse` is 1 / (1 - B), once more as large as what
    // d |c'''| is to 3 |c'.c''| in N of `errors`, over the greatest |c'|. It is 0 where an arc counts as a
    // point: of no size; or one end of it is the nearest to all points of the stretch, and Newton's first
    // step leads there. That is so where
    //     |g(x) - v.k1| <= |v| |c' - k1| + (|c'| + ...)^2
    // leaves g one sign and at least |g'| <= |c'|^2 + d |c''|.
    template <class Tag>
    static HWY_INLINE Turning<Tag> turning(const Seen<Tag, shape>& e,
                                           const Reach<hn::TFromD<Tag>>& s, V<Tag> error,
                                           V<Tag> most) {
        using namespace curve_arc;
        using Real = hn::TFromD<Tag>;
        using Margin = Margins<Real>;
        const Tag d;
        const V<Tag> zero = hn::Zero(d), one = constant(d, 1);
        const V<Tag> slowest = e.number(at_slowest), fastest = e.number(at_fastest),
                     turn = e.number(at_turn), radius = e.number(at_radius);
        const V<Tag> farthest =
            hn::Sqrt(hn::Div(hn::Mul(most, hn::Set(d, Margin::more)), e.inverse_square));
        const V<Tag> square = hn::Max(square_of(slowest), hn::Set(d, least_square<Real>));
        const Vec3v<Tag> middle = middle_of(e);
        const Vec3v<Tag> k1{e.number(at_k1), e.number(at_k1 + 1), e.number(at_k1 + 2)},
            k2{e.number(at_k2), e.number(at_k2 + 1), e.number(at_k2 + 2)};
        const Vec3v<Tag> v0 = from_middle(middle, s.axis, s.begin),
                         v1 = from_middle(middle, s.axis, s.end);
        const V<Tag> g0 = dot<Tag>(v0, k1), g1 = dot<Tag>(v1, k1);
        const V<Tag> aside = hn::Add(
            hn::MulAdd(hn::Add(e.parameter, fastest), hn::Set(d, 4 * Margin::margin), error),
            hn::Set(d, s.aside()));
        const V<Tag> reach = hn::Add(hn::Max(length_of(d, v0), length_of(d, v1)), aside);
        const V<Tag> third = e.number(at_third), speeding = e.number(at_speeding);
        // |k2| + |k3| <= |c''| / 2, at the most; and |v.k2| as computed is off by `aside` |k2|
        const V<Tag> across = hn::Max(dot<Tag>(v0, k2), dot<Tag>(v1, k2));
        const V<Tag> inward = hn::Add(hn::MulAdd(hn::Add(reach, fastest), third,
                                                 hn::MulAdd(across, constant(d, 2), speeding)),
                                      hn::Mul(turn, hn::MulAdd(constant(d, 0.5), turn, aside)));
        const V<Tag> bent = hn::Mul(hn::Div(hn::Min(hn::Mul(farthest, turn), inward), square),
                                    hn::Set(d, Margin::more));
        const V<Tag> straight =
            hn::Div(hn::Set(d, Margin::more), hn::Max(hn::Sub(one, bent), constant(d, 0.1)));
        const V<Tag> outward = hn::Max(straight, zero);
        const V<Tag> inverse =
            hn::Mul(hn::Max(straight, one),
                    hn::MulAdd(hn::Div(hn::Mul(farthest, third), speed_change(d, speeding, square)),
                               hn::Set(d, Margin::more), one));
        const M<Tag> is_smooth =
            hn::And(hn::Lt(bent, constant(d, most_bent)), hn::Gt(slowest, zero));
        const V<Tag> least = hn::NegMulAdd(fastest, aside, hn::Min(hn::Abs(g0), hn::Abs(g1)));
        const V<Tag> own = hn::Mul(square_of(hn::Add(fastest, radius)), constant(d, 1.01));
        // |c' - k1| <= |c''|, at most
        const V<Tag> wanted = hn::MulAdd(hn::MulAdd(reach, constant(d, 2), hn::Add(radius, radius)),
                                         turn, hn::Add(own, own));
        const M<Tag> at_an_end = hn::And(hn::Gt(hn::Mul(g0, g1), zero),
                                         hn::Gt(least, hn::Mul(wanted, hn::Set(d, Margin::more))));
        const M<Tag> is_point = hn::Or(at_an_end, hn::Not(hn::Gt(slowest, zero)));
        return {hn::IfThenElse(is_point, zero,
                               hn::IfThenElse(is_smooth, hn::Div(inverse, fastest), hn::Neg(one))),
                hn::IfThenElse(is_point, zero, hn::IfThenElse(is_smooth, outward, zero))};
    }
    template <class Tag>
    static HWY_INLINE M<Tag> is_defined(Tag d, const BundleEntry<hn::TFromD<Tag>>&, double,
                                        const Vec3v<Tag>&) {
        return hn::FirstN(d, hn::Lanes(d));
    }

    // With L = |p - a| and S the size: v is off by eta and 2 u (L + S), c(x) by 8 u |c'|, which with the sums
    // makes `own`; g by 8 u (L + S) |c'| and what v is off by, and x, where B < 1, by that over |g'| >=
    // |c'|^2 (1 - B), which moves c(x) by 16 u (L + S) / (1 - B). Newton's steps from the middle leave,
    // clamped or not,
    //     e' <= N e^2,  N = |g''| / (2 |g'|) <= (3 |c'.c''| + d |c'''|) / (2 |c'|^2 (1 - B)),
    // of a way e <= 1, along the arc |c'| e. Another place is taken where it is nearer by the share m = 16
    // margins of the square: that is for rounding alone, where m d < 8 own: then the two are within
    // sqrt((2 d own + own^2) / (1 - B)) of each other, less than sqrt(17 / m) own / (1 - B)^1/2. Of a foot that
    // is proved for each ray `own` alone counts, and of a point nothing but its size.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag> inverse) {
        using namespace curve_arc;
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const double u = on.u;
        const bool in_float = u > 0x1p-40;  // the stage's lanes, not these
        const double share =
            16 * (in_float ? double{Margins<float>::margin} : Margins<double>::margin);
        const V<Tag> zero = hn::Zero(d), one = c(1), tiny = c(on.least_rho);
        const V<Tag> slowest = e.number(at_slowest), fastest = e.number(at_fastest),
                     all = hn::Add(v_length, e.parameter);
        const M<Tag> is_smooth = hn::Gt(inverse, zero), is_proved = hn::Lt(inverse, zero),
                     is_point = hn::Not(hn::Gt(slowest, zero));
        const V<Tag> steeper = hn::Max(hn::Mul(inverse, fastest), one);
        const V<Tag> square = hn::Max(square_of(slowest), square_of(tiny));
        const V<Tag> speeds = speed_change(d, e.number(at_speeding), square);
        const V<Tag> n =
            hn::Mul(hn::Div(speeds, hn::Add(square, square)), hn::Mul(steeper, c(1 + 0x1p-10)));
        V<Tag> steps = one;
        for (int step = 0; step < (in_float ? newton_steps<float> : newton_steps<double>); ++step) {
            steps = hn::Min(hn::Mul(n, square_of(steps)), one);
        }
        const V<Tag> of_steps = hn::Mul(fastest, hn::IfThenElseZero(is_smooth, steps));
        const V<Tag> own = hn::MulAdd(c(4 * u), all, hn::Mul(c(16 * u), fastest));
        const V<Tag> of_place =
            hn::IfThenZeroElse(is_proved, hn::Mul(hn::Mul(c(16 * u), all), steeper));
        const V<Tag> of_point = hn::IfThenElseZero(is_point, hn::Mul(c(2), e.number(at_radius)));
        const V<Tag> value =
            hn::Add(hn::Add(hn::Add(eta, own), hn::Add(of_place, of_steps)), of_point);
        const V<Tag> of_choice = hn::Mul(hn::Mul(own, c(std::sqrt(17 / share))), hn::Sqrt(steeper));
        const V<Tag> slope = hn::IfThenZeroElse(is_proved, hn::MulAdd(eta, steeper, of_choice));
        return {value, hn::Add(slope, of_point)};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
