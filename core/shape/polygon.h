// A filled polygon, in a plane and simple: with the height h above its plane and delta what is between the
// foot there and the polygon, s = (h^2 + delta^2) / w^2. It is the union of a few convex parts
// (core/shape/convex_part.h), which are joined (core/shape/joined.h); d to each is convex along a line.
#ifndef IVORY_CORE_SHAPE_POLYGON_H
#define IVORY_CORE_SHAPE_POLYGON_H

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/shape/along_ray.h"
#include "core/shape/convex_part.h"
#include "core/shape/natural.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

struct PolygonSkeleton {
    // 3 or more, as written. The skeleton is their projection on the plane through the first one with
    // the Newell normal.
    std::vector<Vec3d> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

    PolygonSkeleton() = default;
    explicit PolygonSkeleton(std::vector<Vec3d> around) : vertices(std::move(around)) {}
    friend bool operator==(const PolygonSkeleton&, const PolygonSkeleton&) = default;

    static constexpr std::string_view word = "polygon";
    static constexpr std::string_view label = "Polygon";
    static constexpr std::string_view distance =
        "(h² + δ²)^½, h above the plane, δ from the foot to the polygon";
    static constexpr auto members() {
        return std::tuple{places<3>("vertices", "Vertices", &PolygonSkeleton::vertices)};
    }
    [[nodiscard]] std::optional<std::string> fault() const { return polygon_fault(vertices); }

    static constexpr bool has_kinks = false;
    // m = n; parameter = the vertices' greatest distance from the first; numbers: convex_part.h.
    static constexpr bool may_taper = false, is_taper = false;
    static constexpr bool is_joined = true, has_numbers = true, has_axis = true;
    static constexpr int m_power = 0, parameter_power = 1;

    [[nodiscard]] Vec3d middle() const { return middle_of(vertices); }

    [[nodiscard]] std::vector<SkeletonPart> split() const { return convex_parts(vertices); }
    static std::size_t size_of(const SkeletonColumns& c) { return convex_part::size_of(c.numbers); }
    static float in_units(const SkeletonColumns&, std::size_t k, double value, double per_unit) {
        return convex_part::in_units(k, value, per_unit);
    }

    static Surroundings surroundings(const SkeletonColumns& c) {
        return {box_of_vertices(c), off_by(c)};
    }
    static Box3 box(const SkeletonColumns& c) { return widened(box_of_vertices(c), off_by(c)); }
    static Ball ball(const SkeletonColumns& c) {
        using namespace convex_part;
        return {in_space(c, c.numbers[at_center], c.numbers[at_center + 1]),
                (c.numbers[at_radius] + off_by(c)) * (1 + 0x1p-40)};
    }
    static Vec3d farthest(const SkeletonColumns& c, const Vec3d& from, const Vec3d& direction) {
        Vec3d best;
        double most = -infinity<double>;
        for_vertices(c, [&](const Vec3d& vertex) {
            const Vec3d to_vertex = vertex - from;
            const double along = dot(to_vertex, direction);
            if (along > most) best = to_vertex;
            most = std::max(most, along);
        });
        return best;
    }

    static Nearest nearest(const SkeletonColumns& c, const Vec3d& from_a, double width) {
        using namespace convex_part;
        const double h = dot(from_a, axis(c, at_n));
        const OffPart off = nearest_in_plane(c.numbers, c.parameter, dot(from_a, axis(c, at_e1)),
                                             dot(from_a, axis(c, at_e2)));
        const Vec3d away = h * axis(c, at_n) + off.x * axis(c, at_e1) + off.y * axis(c, at_e2);
        const double height = h / width, x = off.x / width, y = off.y / width;
        return {height * height + (x * x + y * y),
                {away.x / width, away.y / width, away.z / width}};
    }

    static bool along_ray(const SkeletonColumns& c, double width, const SeenFrom& ray,
                          SkeletonAlongRay& e) {
        const BallAlongRay around(ball(c), width, ray);
        if (!around.fits || !(c.parameter < 1e75)) return false;
        e.form = ConvexAlongRay{c.a, ray.origin, ray.direction, width, c.parameter, c.numbers};
        e.active = around.active(ray.cut);
        return true;
    }

    static void see(const SkeletonColumns& c, const natural::Span& scale, const natural::Vector&,
                    const natural::Vector&, const natural::Vector&, natural::RaySkeleton& e) {
        e.numbers = c.numbers;
        e.per_width = scale;
        e.size = c.parameter;
    }
    template <class Number>
    static Number square(const natural::RaySkeleton& e, const Number& t) {
        return natural::as_number(
            t, [&](const natural::Span& x) { return natural::convex_part_over(e, x); });
    }

    // visit(place) of the part's.
    template <class Visit>
    static void for_vertices(const SkeletonColumns& c, const Visit& visit) {
        using namespace convex_part;
        const auto edge_count = static_cast<std::size_t>(c.numbers[at_count]);
        for (std::size_t k = 0; k < edge_count; ++k) {
            const double* const edge = &c.numbers[at_edges + per_edge * k];
            visit(in_space(c, edge[0], edge[1]));
        }
    }

  private:
    static Vec3d axis(const SkeletonColumns& c, std::size_t k) {
        return {c.numbers[k], c.numbers[k + 1], c.numbers[k + 2]};
    }
    static Vec3d in_space(const SkeletonColumns& c, double x, double y) {
        return c.a + (x * axis(c, convex_part::at_e1) + y * axis(c, convex_part::at_e2));
    }
    // No place `in_space` is farther from where it should be in any direction: coordinates and axes are
    // off by 2 E u each, the sums by 4 u, and the last by u of the place.
    static double off_by(const SkeletonColumns& c) {
        const double largest =
            std::max({std::abs(c.a.x), std::abs(c.a.y), std::abs(c.a.z)}) + c.parameter;
        return 4 * c.numbers[convex_part::at_margin] * c.parameter + 0x1p-51 * largest;
    }
    static Box3 box_of_vertices(const SkeletonColumns& c) {
        Box3 box;
        for_vertices(c, [&](const Vec3d& vertex) { box.include({vertex, vertex}); });
        return box;
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
struct ShapeLanes<PolygonSkeleton> {
    static constexpr Shape shape = shape_of<PolygonSkeleton>;

    // As convex_part::nearest_in_plane. number(k) is one of the frame's, edge(k, i) the i-th of an edge.
    template <class Tag>
    struct InPlane {
        V<Tag> x, y;
    };
    template <class Tag, class Number, class Edge>
    static HWY_INLINE InPlane<Tag> nearest_in_plane(Tag d, std::size_t edge_count,
                                                    const Number& number, const Edge& edge,
                                                    V<Tag> size, V<Tag> x, V<Tag> y) {
        const V<Tag> zero = hn::Zero(d);
        const V<Tag> tau =
            hn::Mul(number(convex_part::at_margin), hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), size));
        const V<Tag> taken = constant(d, -1);
        V<Tag> nearest = hn::Set(d, infinity<hn::TFromD<Tag>>);
        InPlane<Tag> off{zero, zero};
        M<Tag> beside = hn::FirstN(d, 0);
        for (std::size_t k = 0; k < edge_count; ++k) {
            const V<Tag> tx = edge(k, 2), ty = edge(k, 3), end = edge(k, 4);
            const V<Tag> from_x = hn::Sub(x, edge(k, 0)), from_y = hn::Sub(y, edge(k, 1));
            const V<Tag> along = hn::MulAdd(from_x, tx, hn::Mul(from_y, ty));
            const V<Tag> above = hn::MulSub(from_y, tx, hn::Mul(from_x, ty));
            const V<Tag> foot = hn::Min(at_least_0(along), end);
            const V<Tag> off_x = hn::NegMulAdd(foot, tx, from_x),
                         off_y = hn::NegMulAdd(foot, ty, from_y);
            const M<Tag> outside = hn::Not(hn::Ge(above, tau));
            beside = hn::Or(beside, outside);
            const M<Tag> takes = hn::And(outside, hn::And(hn::Gt(along, zero), hn::Lt(along, end)));
            const V<Tag> square =
                hn::IfThenElse(takes, taken, hn::MulAdd(off_x, off_x, hn::Mul(off_y, off_y)));
            const M<Tag> nearer = hn::Lt(square, nearest);
            nearest = hn::IfThenElse(nearer, square, nearest);
            off = {hn::IfThenElse(nearer, off_x, off.x), hn::IfThenElse(nearer, off_y, off.y)};
        }
        return {hn::IfThenElseZero(beside, off.x), hn::IfThenElseZero(beside, off.y)};
    }
    template <class Tag, class Number>
    static HWY_INLINE Vec3v<Tag> axis(const Number& number, std::size_t k) {
        return {number(k), number(k + 1), number(k + 2)};
    }

    template <class Tag>
    static HWY_INLINE Vec3v<Tag> away(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                      const Vec3v<Tag>& p, V<Tag>& square) {
        using namespace convex_part;
        const hn::TFromD<Tag>* const numbers = e.numbers();
        const auto number = [&](std::size_t k) HWY_ATTR { return hn::Set(d, numbers[k]); };
        const auto edge = [&](std::size_t k, std::size_t i)
                              HWY_ATTR { return hn::Set(d, numbers[at_edges + per_edge * k + i]); };
        const Vec3v<Tag> v = from_first_place(d, e, p);
        const Vec3v<Tag> up = axis<Tag>(number, at_n), right = axis<Tag>(number, at_e1),
                         top = axis<Tag>(number, at_e2);
        const V<Tag> h = dot<Tag>(v, up);
        const InPlane<Tag> off =
            nearest_in_plane(d, static_cast<std::size_t>(numbers[at_count]), number, edge,
                             hn::Set(d, e.parameter), dot<Tag>(v, right), dot<Tag>(v, top));
        square = hn::MulAdd(h, h, hn::MulAdd(off.x, off.x, hn::Mul(off.y, off.y)));
        return {hn::MulAdd(h, up.x, hn::MulAdd(off.x, right.x, hn::Mul(off.y, top.x))),
                hn::MulAdd(h, up.y, hn::MulAdd(off.x, right.y, hn::Mul(off.y, top.y))),
                hn::MulAdd(h, up.z, hn::MulAdd(off.x, right.z, hn::Mul(off.y, top.z)))};
    }

    // What nearest_in_plane and its frame cost a distance, beside `error`.
    template <class Tag>
    static HWY_INLINE V<Tag> lost(Tag d, const Seen<Tag, shape>& e,
                                  const Reach<hn::TFromD<Tag>>& s) {
        return hn::Mul(hn::Mul(e.number(convex_part::at_margin), constant(d, 8)),
                       hn::Add(hn::Add(e.magnitude, e.parameter), hn::Set(d, s.magnitude)));
    }

    // Between two places the distance to a convex set is at most the greater of those there.
    template <class Tag>
    static HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e,
                                                   const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
        using namespace convex_part;
        const Tag d;
        error = hn::Add(error, lost(d, e, s));
        const auto number = [&](std::size_t k) HWY_ATTR { return e.number(k); };
        const auto edge = [&](std::size_t k, std::size_t i) HWY_ATTR {
            // Lanes beyond the last element may have any number for a count.
            const V<Tag> last = at_least_0(hn::Sub(e.number(at_count), constant(d, 1)));
            return e.number_at(hn::MulAdd(hn::Min(constant(d, static_cast<double>(k)), last),
                                          constant(d, static_cast<double>(per_edge)),
                                          constant(d, static_cast<double>(at_edges + i))));
        };
        const std::size_t edge_count =
            std::min(most_edges, static_cast<std::size_t>(std::fmax(
                                     0, hn::GetLane(hn::MaxOfLanes(d, e.number(at_count))))));
        const Vec3v<Tag> right = axis<Tag>(number, at_e1), top = axis<Tag>(number, at_e2);
        const auto distance_at = [&](hn::TFromD<Tag> t) HWY_ATTR {
            const Vec3v<Tag> from = e.from_axis(s.axis, t);
            const V<Tag> h = dot<Tag>(from, e.m);
            const InPlane<Tag> off = nearest_in_plane(d, edge_count, number, edge, e.parameter,
                                                      dot<Tag>(from, right), dot<Tag>(from, top));
            return hn::Sqrt(hn::MulAdd(h, h, hn::MulAdd(off.x, off.x, hn::Mul(off.y, off.y))));
        };
        const V<Tag> d0 = distance_at(s.begin), d1 = distance_at(s.end);
        const V<Tag> x = e.number(at_center), y = e.number(at_center + 1);
        const Vec3v<Tag> middle{hn::Add(e.v.x, hn::MulAdd(x, right.x, hn::Mul(y, top.x))),
                                hn::Add(e.v.y, hn::MulAdd(x, right.y, hn::Mul(y, top.y))),
                                hn::Add(e.v.z, hn::MulAdd(x, right.z, hn::Mul(y, top.z)))};
        const V<Tag> near =
            nearest_of_ends_and_ball(d, d0, d1, middle, e.number(at_radius), s, error);
        return range_of_rays(d, e.magnitude, near, hn::Max(d0, d1), s, error);
    }

    // x^2 <= s: mathematics of core/field/bundle_field.h. Where s'' jumps it stays between 0 and 2 / w^2.
    template <class Tag>
    static HWY_INLINE CurvatureRange<Tag> curvature_range(const Seen<Tag, shape>&,
                                                          const Reach<hn::TFromD<Tag>>&, V<Tag>,
                                                          V<Tag> least, V<Tag> most) {
        return {least, least, most, hn::Zero(Tag()), false};
    }

    // value_error and turn_error of core/shape/convex_part.h; 8 u |away| more for its sums.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                              V<Tag> eta, V<Tag> v_length, V<Tag>) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const V<Tag> margin = hn::Add(e.number(convex_part::at_margin), c(8 * on.u));
        const V<Tag> value =
            hn::MulAdd(margin, hn::MulAdd(c(6.5), v_length, hn::Mul(c(3.5), e.parameter)), eta);
        const V<Tag> all = hn::Add(v_length, e.parameter);
        const V<Tag> turned =
            hn::Mul(hn::Mul(margin, all),
                    hn::MulAdd(c(12), hn::Div(all, e.number(convex_part::at_least)), c(7)));
        return {value, turned};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
