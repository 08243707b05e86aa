// A point: s = |p - c|^2 / w^2.
#ifndef IVORY_CORE_SHAPE_POINT_H
#define IVORY_CORE_SHAPE_POINT_H

#include <string_view>
#include <tuple>

#include "core/shape/along_ray.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

struct PointSkeleton {
    Vec3d position;
    friend bool operator==(const PointSkeleton&, const PointSkeleton&) = default;

    static constexpr std::string_view word = "point";
    static constexpr std::string_view label = "Point";
    static constexpr std::string_view distance = "|p - c|";
    static constexpr auto members() {
        return std::tuple{place("position", "Position", &PointSkeleton::position)};
    }

    // A convex skeleton without a medial axis: d^2 is smooth along each piece of a ray.
    static constexpr bool has_kinks = false;
    // m and parameter are not used.
    static constexpr bool may_taper = false, is_taper = false, is_joined = false,
                          has_numbers = false;
    static constexpr bool has_axis = false;
    static constexpr int m_power = 0, parameter_power = 0;

    [[nodiscard]] Vec3d middle() const { return position; }
    [[nodiscard]] SkeletonColumns columns() const { return {position, {}, {}}; }

    static Surroundings surroundings(const SkeletonColumns& c) { return {{c.a, c.a}}; }
    static Box3 box(const SkeletonColumns& c) { return {c.a, c.a}; }
    static Ball ball(const SkeletonColumns& c) { return {c.a}; }

    // The place of the skeleton that is farthest along a direction, relative to `from`; to nearest.
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d&) {
        return c.a - from;
    }

    // From the vector a -> p.
    static Nearest nearest(const SkeletonColumns&, const Vec3d& from_a, double width) {
        const Vec3d v{from_a.x / width, from_a.y / width, from_a.z / width};
        return {dot(v, v), v};
    }

    static bool along_ray(const SkeletonColumns& c, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        using namespace along_ray_detail;
        return set_point(e, relative_to(c.a, width, ray.origin, ray.direction), 0, ray.span,
                         ray.cut);
    }

    static void see(const SkeletonColumns&, const natural::Span&, const natural::Vector&,
                    const natural::Vector&, const natural::Vector&, natural::RaySkeleton&) {}
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return natural::square(e.from, t);
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
struct ShapeLanes<PointSkeleton> {
    static constexpr Shape shape = shape_of<PointSkeleton>;

    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        const Vec3v<Tag> v = from_first_place(d, e, p);
        square = dot<Tag>(v, v);
        return v;
    }

    // `far` is not asked for.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        const Tag d;
        const FromAxis<Tag> c(e.v, s.axis);
        return {nearest_of_rays(d, c, aside_of(d, e.magnitude, s), s, error), hn::Zero(d)};
    }

    // s = y + h^2, y measured along the ray's line and h across it. A ray of the bundle runs past the
    // point at least h = across - |o - origin| - t |d - axis| away, and its foot slips by no more than
    // that turns and moves it: with c the point, (c - o).d - (c - origin).axis =
    // (c - origin).(d - axis) - (o - origin).d, the latter at most 2 spread radius.
    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>& e,
                                                          const Reach<hn::TFromD<Tag>>& s,
                                                          V<Tag> error, V<Tag> least, V<Tag>) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const Tag d;
        const V<Tag> widened = hn::Set(d, Margin::more), reduced = hn::Set(d, Margin::less);
        const FromAxis<Tag> c(e.v, s.axis);
        const V<Tag> across = hn::Sqrt(c.across_square);
        const V<Tag> offset = hn::Set(d, s.t_offset);
        const V<Tag> spread = hn::Set(d, s.spread * Margin::more);
        const V<Tag> radius = hn::Set(d, s.radius * Margin::more);
        // up to where the ray has passed the point
        const V<Tag> passed = hn::Add(hn::Add(offset, e.magnitude), radius);
        const V<Tag> turn = hn::MulAdd(passed, spread, radius);
        const V<Tag> h = at_least_0(hn::Sub(hn::Sub(across, turn), error));
        const V<Tag> h_square = hn::Mul(hn::Mul(square_of(h), e.inverse_square), reduced);
        const V<Tag> slip = hn::Mul(
            hn::MulAdd(hn::Add(offset, hn::Abs(c.along)), hn::Set(d, s.spread * s.spread),
                       hn::MulAdd(hn::MulAdd(constant(d, 2), radius, across), spread, error)),
            widened);
        const V<Tag> x0 = hn::Sub(hn::Sub(hn::Set(d, s.begin), c.along), slip);
        const V<Tag> x1 = hn::Add(hn::Sub(hn::Set(d, s.end), c.along), slip);
        const V<Tag> near = at_least_0(hn::Max(x0, hn::Neg(x1)));
        const V<Tag> far = hn::Max(hn::Abs(x0), hn::Abs(x1));
        return {least, hn::Mul(hn::Mul(square_of(near), e.inverse_square), reduced),
                hn::Mul(hn::Mul(square_of(far), e.inverse_square), widened), h_square, true};
    }

    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering&, const Seen<Tag, shape>&,
                                              V<Tag> eta, V<Tag>, V<Tag>) {
        return {eta, hn::Zero(d)};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
