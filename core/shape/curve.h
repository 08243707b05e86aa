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
    static float in_units(std::size_t k, double value, double per_unit) {
        return curve_arc::in_units(k, value, per_unit);
    }
    static float in_units(const SkeletonColumns&, std::size_t k, double value, double per_unit) {
        return in_units(k, value, per_unit);
    }

    // What it is narrowed down to: m.x and m.y are the middle and the half of a piece.
    static void numbers_of_piece(const double* numbers, double middle, double half,
                                 std::span<double, curve_arc::most_numbers> piece) {
        curve_arc::numbers_of_piece({numbers, curve_arc::most_numbers}, middle, half, piece);
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
#include "core/shape/curve_foot.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <>
struct ShapeLanes<CurveSkeleton> {
    static constexpr Shape shape = shape_of<CurveSkeleton>;

    // Asks an entry's arc for the foot of p.
    template <class Tag, class Ask>
    static HWY_INLINE auto ask_entry(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                     const Vec3v<Tag>& p, const Ask& ask) {
        using namespace curve_arc;
        const hn::TFromD<Tag>* const numbers = e.numbers();
        const auto number = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return hn::Set(d, numbers[k]);
        };
        const Vec3v<Tag> from = from_first_place(d, e, p);
        return ask(
            ArcFoot(d, number,
                    Vec3v<Tag>{hn::Sub(from.x, number(at_k0)), hn::Sub(from.y, number(at_k0 + 1)),
                               hn::Sub(from.z, number(at_k0 + 2))}));
    }
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        const auto off = ask_entry(
            d, e, p,
            [](const auto& arc) HWY_ATTR __attribute__((always_inline)) { return arc.off(); });
        square = off.square;
        return off.from;
    }
    template <class Tag>
    static HWY_INLINE ProvedFoot<Tag> proved_foot(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                                  const Vec3v<Tag>& p, V<Tag> reach) {
        return ask_entry(
            d, e, p, [&](const auto& arc) HWY_ATTR __attribute__((always_inline)) {
                return arc.proved(reach).foot;
            });
    }

    // Some arcs' middles, from where places are relative to; and the axis' point at t from there.
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> middle_of(const Seen<Tag, shape>& e, const ArcPiece<Tag>& number) {
        using namespace curve_arc;
        return {hn::Add(e.v.x, number(at_k0)), hn::Add(e.v.y, number(at_k0 + 1)),
                hn::Add(e.v.z, number(at_k0 + 2))};
    }
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> from_middle(const Vec3v<Tag>& middle,
                                             const Vec3<hn::TFromD<Tag>>& axis, hn::TFromD<Tag> t) {
        const Tag d;
        return {hn::Sub(hn::Set(d, t * axis.x), middle.x),
                hn::Sub(hn::Set(d, t * axis.y), middle.y),
                hn::Sub(hn::Set(d, t * axis.z), middle.z)};
    }

    template <class Tag>
    static HWY_INLINE PartFoot<Tag> part_foot(const Seen<Tag, shape>& e,
                                              const Reach<hn::TFromD<Tag>>& s, hn::TFromD<Tag> t,
                                              V<Tag> reach, V<Tag> error) {
        const Tag d;
        const ArcPiece<Tag> number(e);
        PartFoot<Tag> part;
        part.error = of_curve(e, s, error);
        const ProvedArc<Tag> arc = ArcFoot(d, number, from_middle(middle_of(e, number), s.axis, t))
                                       .proved(hn::Add(reach, part.error));
        part.foot = arc.foot;
        part.length = hn::Mul(number(curve_arc::at_radius), constant(d, 2));
        // Where D is concave no place is the nearest but the curve's own ends.
        // Where no q is known 2 reach |y - at| is bounded by the length alone.
        const M<Tag> is_known = hn::Or(arc.is_end, hn::Gt(arc.q, hn::Zero(d)));
        part.foot.pull =
            hn::IfThenElse(is_known, part.foot.pull, hn::Add(part.length, part.length));
        part.never = hn::And(arc.is_end, hn::Eq(number(curve_arc::at_own_end), hn::Zero(d)));
        part.at = arc.x;
        part.q = arc.q;
        part.pull = hn::MulAdd(reach, number(curve_arc::at_fastest), arc.G);
        return part;
    }
    // What places are off by, with c and the choice of the nearest.
    template <class Tag>
    static HWY_INLINE V<Tag> of_curve(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                                      V<Tag> error) {
        using Real = hn::TFromD<Tag>;
        const Tag d;
        return hn::MulAdd(
            hn::Add(hn::Add(e.magnitude, hn::Set(d, s.magnitude)), e.number(curve_arc::at_fastest)),
            hn::Set(d, 16 * Margins<Real>::margin), error);
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
        error = of_curve(e, s, error);
        const ArcPiece<Tag> number(e);
        const Vec3v<Tag> middle = middle_of(e, number);
        const V<Tag> fastest = number(at_fastest), turn = number(at_turn);
        struct AtEnd {
            V<Tag> least, here, at_other;
        };
        const auto at_end = [&](Real t, Real other) HWY_ATTR __attribute__((always_inline)) {
            const auto off = ArcFoot(d, number, from_middle(middle, s.axis, t)).off();
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
        const ArcPiece<Tag> number(e);
        const V<Tag> slowest = number(at_slowest), fastest = number(at_fastest),
                     turn = number(at_turn), radius = number(at_radius);
        const V<Tag> farthest =
            hn::Sqrt(hn::Div(hn::Mul(most, hn::Set(d, Margin::more)), e.inverse_square));
        const V<Tag> square = hn::Max(square_of(slowest), hn::Set(d, least_square<Real>));
        const Vec3v<Tag> middle = middle_of(e, number);
        const Vec3v<Tag> k1{number(at_k1), number(at_k1 + 1), number(at_k1 + 2)},
            k2{number(at_k2), number(at_k2 + 1), number(at_k2 + 2)};
        const Vec3v<Tag> v0 = from_middle(middle, s.axis, s.begin),
                         v1 = from_middle(middle, s.axis, s.end);
        const V<Tag> g0 = dot<Tag>(v0, k1), g1 = dot<Tag>(v1, k1);
        const V<Tag> aside = hn::Add(
            hn::MulAdd(hn::Add(e.parameter, fastest), hn::Set(d, 4 * Margin::margin), error),
            hn::Set(d, s.aside()));
        const V<Tag> reach = hn::Add(hn::Max(length_of(d, v0), length_of(d, v1)), aside);
        const V<Tag> third = number(at_third), speeding = number(at_speeding);
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
    // makes `own`, twice as much for the coefficients of a piece; g by 12 u (L + S) |c'| and what v is off by, and x, where B < 1, by that over |g'| >=
    // |c'|^2 (1 - B), which moves c(x) by 24 u (L + S) / (1 - B). Newton's steps from the middle leave,
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
        const ArcPiece<Tag> number(e);
        const V<Tag> slowest = number(at_slowest), fastest = number(at_fastest),
                     all = hn::Add(v_length, e.parameter);
        const M<Tag> is_smooth = hn::Gt(inverse, zero), is_proved = hn::Lt(inverse, zero),
                     is_point = hn::Not(hn::Gt(slowest, zero));
        const V<Tag> steeper = hn::Max(hn::Mul(inverse, fastest), one);
        const V<Tag> square = hn::Max(square_of(slowest), square_of(tiny));
        const V<Tag> speeds = speed_change(d, number(at_speeding), square);
        const V<Tag> n =
            hn::Mul(hn::Div(speeds, hn::Add(square, square)), hn::Mul(steeper, c(1 + 0x1p-10)));
        V<Tag> steps = one;
        for (int step = 0;
             step < (in_float ? newton_steps_of_arcs<float> : newton_steps_of_arcs<double>);
             ++step) {
            steps = hn::Min(hn::Mul(n, square_of(steps)), one);
        }
        const V<Tag> of_steps = hn::Mul(fastest, hn::IfThenElseZero(is_smooth, steps));
        const V<Tag> own =
            hn::MulAdd(c(8 * u), all, hn::Mul(c(32 * u), e.number(curve_arc::at_fastest)));
        const V<Tag> of_place =
            hn::IfThenZeroElse(is_proved, hn::Mul(hn::Mul(c(24 * u), all), steeper));
        const V<Tag> of_point = hn::IfThenElseZero(is_point, hn::Mul(c(2), number(at_radius)));
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
