// A circle (the curve, not the disc) about c with the unit normal n = N / |N| and radius r: with
// v = p - c, h = n.v and rho = |v - h n|, s = ((rho - r)^2 + h^2) / w^2. The expanded form
// r^2 + |v|^2 - 2 r rho cancels to nothing near the circle.
#ifndef IVORY_CORE_SHAPE_CIRCLE_H
#define IVORY_CORE_SHAPE_CIRCLE_H

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>

#include "core/math/direction.h"
#include "core/shape/along_ray.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// The unit normal is normal / |normal| in exact arithmetic.
struct CircleSkeleton {
    Vec3d center;
    Vec3d normal{0, 0, 1};  // any length but 0, kept as written
    double radius = 1;      // >= 0
    friend bool operator==(const CircleSkeleton&, const CircleSkeleton&) = default;

    static constexpr std::string_view word = "circle";
    static constexpr std::string_view label = "Circle";
    static constexpr std::string_view distance =
        "((rho - r)² + h²)^½, h above the plane, rho from the axis";
    static constexpr auto members() {
        return std::tuple{place("center", "Centre", &CircleSkeleton::center),
                          direction("normal", "Normal", &CircleSkeleton::normal),
                          length("radius", "Radius", &CircleSkeleton::radius)};
    }

    // On the axis the direction to the nearest point jumps.
    static constexpr bool has_kinks = true;
    // m = n; parameter = r.
    static constexpr bool may_taper = false, is_taper = false, is_joined = false,
                          has_numbers = false;
    static constexpr bool has_axis = true;
    static constexpr int m_power = 0, parameter_power = 1;

    [[nodiscard]] Vec3d middle() const { return center; }
    [[nodiscard]] SkeletonColumns columns() const {
        return {center, normal, unit(normal), radius, 0, radius};
    }

    static Surroundings surroundings(const SkeletonColumns& c) { return {{c.a, c.a}, c.radius}; }
    // Along axis k it reaches r sqrt(1 - n_k^2), written without its cancellation.
    static Box3 box(const SkeletonColumns& c) {
        const double largest =
            std::fmax(std::abs(c.b.x), std::fmax(std::abs(c.b.y), std::abs(c.b.z)));
        int exponent = 0;
        std::frexp(largest, &exponent);
        const Vec3d n{std::ldexp(c.b.x, -exponent), std::ldexp(c.b.y, -exponent),
                      std::ldexp(c.b.z, -exponent)};
        const double length = std::sqrt(dot(n, n));
        Box3 box;
        for (std::size_t k = 0; k < 3; ++k) {
            const double across = std::hypot(n[(k + 1) % 3], n[(k + 2) % 3]) / length;
            const double extent = c.radius * across * (1 + 32 * unit_roundoff);
            box.lo[k] = sub_down(c.a[k], extent);
            box.hi[k] = add_up(c.a[k], extent);
        }
        return box;
    }
    static Ball ball(const SkeletonColumns& c) { return {c.a, c.radius}; }

    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        const Vec3d to_center = c.a - from;
        const Vec3d along = direction - dot(direction, c.m) * c.m;
        return dot(along, along) > 0 ? to_center + c.radius * unit(along) : to_center;
    }

    // Half the gradient of s is (rho - r) across / rho + h n.
    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        const Vec3d v{from_a.x / width, from_a.y / width, from_a.z / width};
        const Vec3d n = unit(c.b);
        const double r = c.radius / width;
        const double h = dot(v, n);
        const Vec3d across = v - h * n;
        const double rho = std::sqrt(dot(across, across));
        const double off = rho - r;
        const Vec3d outward = rho > 0 ? (1 / rho) * across : Vec3d{};
        return {off * off + h * h, off * outward + h * n, rho > 0 || r == 0};
    }

    static bool along_ray(const SkeletonColumns& skeleton, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        using namespace along_ray_detail;
        const Interval<double>& span = ray.span;
        const double cut = ray.cut;
        const Relative r = relative_to(skeleton.a, width, ray.origin, ray.direction);
        if (skeleton.radius == 0) return set_point(e, r, 0, span, cut);
        const Vec3d n = unit(skeleton.b);
        const FromAxis axial = from_axis(r, n, span);
        CircleAlongRay& c = e.form.emplace<CircleAlongRay>();
        c.across = axial.across;
        c.height = axial.height;
        c.rise = axial.rise;
        const MovingSquare& q = c.across;
        c.radius = Interval<double>(skeleton.radius) / Interval<double>(width);

        // |d|^2 / w^2 of the exact direction and width.
        const MovingSquare whole = from_point(r, span);
        c.curvature = whole.curvature();

        // rho_0^2 = |v|^2 - (v.e)^2 / |e|^2 at t_r; only an upper bound where the ray hardly moves
        // across.
        const SquareAt here = q.at(q.reference);
        const double speed = q.kappa * (1 - 16 * u) - q.nu - 1e-149;
        if (speed > 0.999 * q.kappa) {
            const double along = 0.5 * std::abs(here.ds), error = 0.5 * here.ds_radius;
            const double most = (along + error) / speed;
            const double fewest = std::max(along - error, 0.0) / (q.kappa + q.nu);
            const double lo = here.s - here.s_radius - most * most * (1 + 16 * u);
            const double hi = here.s + here.s_radius - fewest * fewest * (1 - 16 * u);
            c.least_across = {lo > 0 ? lo * (1 - 4 * u) : 0, hi > 0 ? hi * (1 + 4 * u) : 1e-290};
        } else {
            c.least_across = {0.0, here.s + here.s_radius};
        }

        // The circle lies on the sphere |v| = r: |v| <= r + sqrt(cut) where s <= cut.
        const double reach = (c.radius.hi + std::sqrt(cut)) * (1 + 8 * u);
        e.active = intersection(sublevel(whole, reach * reach * (1 + 4 * u)),
                                sublevel(q, reach * reach * (1 + 4 * u)));
        return usable(whole.kappa, r.offset_norm + whole.rho + c.radius.hi, mag(span));
    }

    static void see(const SkeletonColumns& c, const natural::Span& scale, const natural::Vector&,
                    const natural::Vector& start, const natural::Vector& rate,
                    natural::RaySkeleton& e) {
        using namespace natural;
        if (c.radius == 0) {
            e.collapsed = true;
            return;
        }
        const Vector n = natural::unit(c.b);
        e.radius = quick::mul(scale, Span(c.radius));
        e.along = {inner(n, start), inner(n, rate)};
        e.across =
            moving(minus(start, times(e.along.start, n)), minus(rate, times(e.along.rate, n)));
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return sqr(less(sqrt(natural::square(e.across, t)), e.radius)) + sqr(linear(e.along, t));
    }
    // As the paper prints it, 3-3: d^2 = r^2 + |C - P|^2 - 2 r |P - C - (N.(P - C)) N|, expanded as printed.
    template <class Number>
    static Number square_as_printed(const natural::RaySkeleton& e, const Number& t) {
        const Number whole = natural::square(e.from, t) + Number{quick::sqr(e.radius)};
        return less(whole, quick::scale(
                               2, quick::mul(e.radius, range(sqrt(natural::square(e.across, t))))));
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
struct ShapeLanes<CircleSkeleton> {
    static constexpr Shape shape = shape_of<CircleSkeleton>;

    // The s'' of a circle is bounded where r / rho stays below this; else the element counts as
    // kinked.
    static constexpr double greatest_outward = 32;

    // away = v - r across / rho, its square from (rho - r)^2 + h^2. On the axis itself there is no
    // direction: any finite one, which nobody relies on.
    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        using Real = hn::TFromD<Tag>;
        const Vec3v<Tag> v = from_first_place(d, e, p);
        const Vec3v<Tag> m{hn::Set(d, e.mx), hn::Set(d, e.my), hn::Set(d, e.mz)};
        const V<Tag> along = dot<Tag>(v, m);
        const V<Tag> parameter = hn::Set(d, e.parameter);
        const Vec3v<Tag> across = less_share(v, m, along);
        const Root<Tag> rho =
            root(d, hn::Max(dot<Tag>(across, across), hn::Set(d, least_square<Real>)));
        const V<Tag> off = hn::Sub(rho.root, parameter);
        square = hn::MulAdd(off, off, hn::Mul(along, along));
        return less_share(v, across, hn::Mul(parameter, rho.inverse));
    }

    // Whether `away` has a direction at p: near the axis it is lost.
    static HWY_INLINE M<D> is_defined(D d, const BundleEntry<double>& e, double inverse_square,
                                      const Vec3v<D>& p) {
        const Vec3v<D> m{hn::Set(d, e.mx), hn::Set(d, e.my), hn::Set(d, e.mz)};
        const Vec3v<D> v = from_first_place(d, e, p);
        const V<D> along = dot<D>(v, m);
        const V<D> across_square = hn::NegMulAdd(along, along, dot<D>(v, v));
        return hn::Gt(across_square, hn::Set(d, 1e-12 / inverse_square));
    }

    // The distance of the axis' point at t, and that from the circle's own axis.
    template <class Tag>
    static HWY_INLINE V<Tag> distance_at(const Seen<Tag, shape>& e,
                                         const Vec3<hn::TFromD<Tag>>& axis, hn::TFromD<Tag> t) {
        const Vec3v<Tag> from = e.from_axis(axis, t);
        const V<Tag> along = dot<Tag>(from, e.m);
        const V<Tag> off = hn::Sub(length_of(Tag(), less_share(from, e.m, along)), e.parameter);
        return hn::Sqrt(hn::MulAdd(off, off, square_of(along)));
    }
    template <class Tag>
    static HWY_INLINE V<Tag> rho_at(const Seen<Tag, shape>& e, const Vec3<hn::TFromD<Tag>>& axis,
                                    hn::TFromD<Tag> t) {
        const Vec3v<Tag> from = e.from_axis(axis, t);
        return length_of(Tag(), less_share(from, e.m, dot<Tag>(from, e.m)));
    }

    // The distance to any set changes by at most the length of the way.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using Real = hn::TFromD<Tag>;
        const Tag d;
        const Real L = (s.end - s.begin) * Margins<Real>::more;
        const V<Tag> d0 = distance_at(e, s.axis, s.begin), d1 = distance_at(e, s.axis, s.end);
        const V<Tag> far = hn::Mul(constant(d, 0.5), hn::Add(hn::Add(d0, d1), hn::Set(d, L)));
        return range_of_rays(d, e.magnitude,
                             nearest_of_ends_and_ball(d, d0, d1, e.v, e.size, s, error), far, s,
                             error);
    }

    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    // s'' w^2 / 2 = 1 - r rho'' lies in 1 - r / rho .. 1. `inverse` is an upper bound of 1 / rho.
    template <class Tag>
    static HWY_INLINE Turning<Tag> turning(const Seen<Tag, shape>& e,
                                           const Reach<hn::TFromD<Tag>>& s, V<Tag> error, V<Tag>) {
        using Real = hn::TFromD<Tag>;
        using Margin = Margins<Real>;
        const Tag d;
        const V<Tag> zero = hn::Zero(d);
        const V<Tag> rho0 = rho_at(e, s.axis, s.begin), rho1 = rho_at(e, s.axis, s.end);
        const V<Tag> rho = hn::Sub(
            least_between(d, at_least_0(hn::Sub(rho0, error)), at_least_0(hn::Sub(rho1, error)),
                          (s.end - s.begin) * Margin::more),
            hn::Set(d, s.aside()));
        const V<Tag> unrounded = hn::Div(constant(d, 1), rho);
        const M<Tag> bounded = hn::And(hn::Gt(rho, zero), hn::Lt(hn::Mul(e.parameter, unrounded),
                                                                 constant(d, greatest_outward)));
        const M<Tag> is_point = hn::Eq(e.parameter, zero);
        const V<Tag> inverse = hn::IfThenZeroElse(
            is_point,
            hn::IfThenElse(bounded, hn::Mul(unrounded, hn::Set(d, Margin::more)), constant(d, -1)));
        return {inverse,
                hn::Mul(hn::Mul(e.parameter, at_least_0(inverse)), hn::Set(d, Margin::more))};
    }

    // The axis moves `away` by 10 u |p - c| more at the most, as a segment's foot does; rho and
    // 1 / rho are off by 6 u, and rho by `least_rho` below which it does not come.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag> inverse) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const double u = on.u;
        eta =
            hn::MulAdd(c(3), eta, hn::MulAdd(c(24 * u), v_length, hn::Mul(c(10 * u), e.parameter)));
        eta = hn::Add(eta, c(on.least_rho));
        return {eta, hn::Mul(hn::Mul(e.parameter, at_least_0(inverse)),
                             hn::MulAdd(c(4), eta, hn::Mul(c(24 * u), v_length)))};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
