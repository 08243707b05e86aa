// A disc about c with the unit normal n = N / |N| and radius r, the circle filled: with v = p - c,
// h = n.v and rho = |v - h n|, s = (max(rho - r, 0)^2 + h^2) / w^2. A convex set, so that d and s are
// convex along every line; s' passes continuously from h^2, above the disc, to what is beyond its rim.
#ifndef IVORY_CORE_SHAPE_DISC_H
#define IVORY_CORE_SHAPE_DISC_H

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <variant>

#include "core/math/direction.h"
#include "core/shape/along_ray.h"
#include "core/shape/circle.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// The unit normal is normal / |normal| in exact arithmetic.
struct DiscSkeleton {
    Vec3d center;
    Vec3d normal{0, 0, 1};  // any length but 0, kept as written
    double radius = 1;      // >= 0
    friend bool operator==(const DiscSkeleton&, const DiscSkeleton&) = default;

    static constexpr std::string_view word = "disc";
    static constexpr std::string_view label = "Disc";
    static constexpr std::string_view distance =
        "(max(rho - r, 0)² + h²)^½, h above the plane, rho from the axis";
    static constexpr auto members() {
        return std::tuple{place("center", "Centre", &DiscSkeleton::center),
                          direction("normal", "Normal", &DiscSkeleton::normal),
                          length("radius", "Radius", &DiscSkeleton::radius)};
    }

    static constexpr bool has_kinks = false;
    // m = n; parameter = r.
    static constexpr bool may_taper = false, is_taper = false, is_joined = false,
                          has_numbers = false;
    static constexpr bool has_axis = true;
    static constexpr int m_power = 0, parameter_power = 1;

    [[nodiscard]] Vec3d middle() const { return center; }
    [[nodiscard]] SkeletonColumns columns() const {
        return {center, normal, unit(normal), radius, 0, radius};
    }

    // No linear function is greater on the disc than on its rim.
    static Surroundings surroundings(const SkeletonColumns& c) {
        return CircleSkeleton::surroundings(c);
    }
    static Box3 box(const SkeletonColumns& c) { return CircleSkeleton::box(c); }
    static Ball ball(const SkeletonColumns& c) { return CircleSkeleton::ball(c); }
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        return CircleSkeleton::farthest(c, from, direction);
    }

    // Half the gradient of s is max(rho - r, 0) across / rho + h n.
    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        const Vec3d v{from_a.x / width, from_a.y / width, from_a.z / width};
        const Vec3d n = unit(c.b);
        const double h = dot(v, n);
        const Vec3d across = v - h * n;
        const double rho = std::sqrt(dot(across, across));
        const double off = std::max(rho - c.radius / width, 0.0);
        const Vec3d outward = rho > 0 ? (1 / rho) * across : Vec3d{};
        return {off * off + h * h, off * outward + h * n};
    }

    // It lies in the ball |v| <= r and in the cylinder rho <= r, as the circle does, and in its plane.
    static bool along_ray(const SkeletonColumns& skeleton, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        const bool fits = CircleSkeleton::along_ray(skeleton, width, ray, e);
        if (auto* const circle = std::get_if<CircleAlongRay>(&e.form)) {  // not one of radius 0
            circle->filled = true;
            e.active = intersection(e.active, circle->within_height(std::sqrt(ray.cut)));
        }
        return fits;
    }

    static void see(const SkeletonColumns& c, const natural::Span& scale,
                    const natural::Vector& origin, const natural::Vector& start,
                    const natural::Vector& rate, natural::RaySkeleton& e) {
        CircleSkeleton::see(c, scale, origin, start, rate, e);
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return sqr(at_least_0(less(sqrt(natural::square(e.across, t)), e.radius))) +
               sqr(linear(e.along, t));
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
struct ShapeLanes<DiscSkeleton> {
    static constexpr Shape shape = shape_of<DiscSkeleton>;

    // away = v - min(r / rho, 1) across, its square from max(rho - r, 0)^2 + h^2.
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
        const V<Tag> off = at_least_0(hn::Sub(rho.root, parameter));
        square = hn::MulAdd(off, off, hn::Mul(along, along));
        return less_share(v, across, hn::Min(hn::Mul(parameter, rho.inverse), constant(d, 1)));
    }

    // The axis' point at t, above the disc's plane and from the disc's axis.
    template <class Tag>
    struct Place {
        V<Tag> height, rho, distance;

        HWY_INLINE Place(const Seen<Tag, shape>& e, const Vec3<hn::TFromD<Tag>>& axis,
                         hn::TFromD<Tag> t) {
            const Tag d;
            const Vec3v<Tag> from = e.from_axis(axis, t);
            height = dot<Tag>(from, e.m);
            rho = length_of(d, less_share(from, e.m, height));
            const V<Tag> off = at_least_0(hn::Sub(rho, e.parameter));
            distance = hn::Sqrt(hn::MulAdd(off, off, square_of(height)));
        }
    };

    // Between two places the distance to a convex set is at most the greater of those there; rho,
    // that from a line, obeys (1), and the height is between the two.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const Place<Tag> a(e, s.axis, s.begin), b(e, s.axis, s.end);
        const V<Tag> rho =
            least_between(d, at_least_0(hn::Sub(a.rho, error)), at_least_0(hn::Sub(b.rho, error)),
                          (s.end - s.begin) * Margin::more);
        const V<Tag> off = at_least_0(hn::Sub(hn::Sub(rho, e.parameter), error));
        const V<Tag> lower = hn::Min(hn::Abs(a.height), hn::Abs(b.height));
        const M<Tag> one_side = hn::Gt(hn::Mul(a.height, b.height), hn::Zero(d));
        const V<Tag> height = hn::IfThenElseZero(one_side, at_least_0(hn::Sub(lower, error)));
        const V<Tag> near = hn::Max(
            hn::Mul(hn::Sqrt(hn::MulAdd(off, off, square_of(height))), hn::Set(d, Margin::less)),
            nearest_of_ends_and_ball(d, a.distance, b.distance, e.v, e.size, s, error));
        return range_of_rays(d, e.magnitude, near, hn::Max(a.distance, b.distance), s, error);
    }

    // x^2 <= s: mathematics of core/field/bundle_field.h. Where s'' jumps, at rho = r, it stays between 0
    // and 2 / w^2.
    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    // What leads from the nearest point of a convex set moves by no more than p does: v by eta moves
    // `away` by eta. The axis moves it by 10 u |p - c| at the most, as a segment's foot does. Of
    // across the share min(r / rho, 1) is taken away, which is its nearest point in a disc of radius
    // r: an error of across goes through that unenlarged, rim or not; the share itself is off by 8 u
    // and that times across, no longer than |p - c|. rho - r is off by 6 u rho and u r more than
    // across is, and the clamp only lessens that. Below `least_rho`, where rho does not come, either
    // share is between 0 and 1 and across that short.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag>) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const double u = on.u;
        eta =
            hn::MulAdd(c(2), eta, hn::MulAdd(c(24 * u), v_length, hn::Mul(c(10 * u), e.parameter)));
        return {hn::Add(eta, c(on.least_rho)), hn::Zero(d)};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
