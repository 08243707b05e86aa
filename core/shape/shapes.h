// The shapes of skeletons. This is the only list of them; a shape is a file, a line among the
// #includes, a word in `Shape` and one in `Shapes`.

#include "core/shape/circle.h"
#include "core/shape/disc.h"
#include "core/shape/point.h"
#include "core/shape/segment.h"
#include "core/shape/taper.h"

// Of the parts of those, or of others:
#include "core/shape/curve.h"
#include "core/shape/polygon.h"
#include "core/shape/polyline.h"

#ifndef IVORY_CORE_SHAPE_SHAPES_H
#define IVORY_CORE_SHAPE_SHAPES_H

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "core/math/type_list.h"

namespace ivory {

enum class Shape : std::uint8_t {
    point,
    segment,
    circle,
    disc,
    polygon,
    curve,
    polyline,
    taper,
    tapered_polyline
};
using Shapes = TypeList<PointSkeleton, SegmentSkeleton, CircleSkeleton, DiscSkeleton,
                        PolygonSkeleton, CurveSkeleton, PolylineSkeleton>;
// What fields are made of: those, and what becomes of a list of widths.
using FieldShapes =
    TypeList<PointSkeleton, SegmentSkeleton, CircleSkeleton, DiscSkeleton, PolygonSkeleton,
             CurveSkeleton, PolylineSkeleton, TaperedSegment, TaperedPolyline>;

static_assert(index_in<PointSkeleton, Shapes> == static_cast<std::size_t>(Shape::point));
static_assert(index_in<SegmentSkeleton, Shapes> == static_cast<std::size_t>(Shape::segment));
static_assert(index_in<CircleSkeleton, Shapes> == static_cast<std::size_t>(Shape::circle));
static_assert(index_in<DiscSkeleton, Shapes> == static_cast<std::size_t>(Shape::disc));
static_assert(index_in<PolygonSkeleton, Shapes> == static_cast<std::size_t>(Shape::polygon));
static_assert(index_in<CurveSkeleton, Shapes> == static_cast<std::size_t>(Shape::curve));
static_assert(index_in<PolylineSkeleton, Shapes> == static_cast<std::size_t>(Shape::polyline));
static_assert(index_in<TaperedSegment, FieldShapes> == static_cast<std::size_t>(Shape::taper));
static_assert(index_in<TaperedPolyline, FieldShapes> ==
              static_cast<std::size_t>(Shape::tapered_polyline));

// The one alternative that an element has; its index is the Shape.
using Skeleton = Shapes::Into<std::variant>;

// What the file of a shape has to say. Meanings and units: core/shape/skeleton_values.h, along_ray.h
// and natural.h; the quick forms for SIMD, which are at the end of the same file, are asked for in
// core/shape/shape_lanes.inl.
template <class S>
concept FieldShape = requires(const SkeletonColumns& columns, const SeenFrom& ray,
                              SkeletonAlongRay& along, const natural::Span& span,
                              const natural::Vector& v, natural::RaySkeleton& on_ray,
                              double width) {
    { S::has_kinks } -> std::convertible_to<bool>;
    { S::has_axis } -> std::convertible_to<bool>;
    { S::is_taper } -> std::convertible_to<bool>;
    { S::is_joined } -> std::convertible_to<bool>;  // several parts: core/shape/joined.h
    {
        S::has_numbers
        } -> std::convertible_to<bool>;  // beside the columns: SkeletonColumns::numbers
    { S::m_power } -> std::convertible_to<int>;
    { S::parameter_power } -> std::convertible_to<int>;
    { S::surroundings(columns) } -> std::same_as<Surroundings>;
    { S::box(columns) } -> std::same_as<Box3>;
    { S::ball(columns) } -> std::same_as<Ball>;
    { S::farthest(columns, columns.a, columns.a) } -> std::same_as<Vec3d>;
    { S::nearest(columns, columns.a, width) } -> std::same_as<Nearest>;
    { S::along_ray(columns, width, ray, along) } -> std::same_as<bool>;
    S::see(columns, span, v, v, v, on_ray);
};

// The parts that a skeleton is to a field: one, but of joined ones. Where these have numbers, they are
// found all at once.
template <class S>
[[nodiscard]] std::size_t part_count(const S& skeleton) {
    if constexpr (S::has_numbers)
        return skeleton.split().size();
    else if constexpr (S::is_joined)
        return skeleton.parts();
    else
        return 1;
}
template <class S>
[[nodiscard]] SkeletonColumns part_of(const S& skeleton, std::size_t part) {
    if constexpr (S::is_joined)
        return skeleton.part(part);
    else
        return skeleton.columns();
}
template <class S>
[[nodiscard]] std::vector<SkeletonPart> parts_of(const S& skeleton) {
    std::vector<SkeletonPart> parts;
    if constexpr (S::has_numbers) {
        parts = skeleton.split();
    } else {
        for (std::size_t part = 0; part < part_count(skeleton); ++part) {
            parts.push_back({part_of(skeleton, part), {}});
        }
    }
    return parts;
}

template <class S>
concept SkeletonShape = std::equality_comparable<S> && FieldShape<S> && requires(const S& s) {
    { S::word } -> std::convertible_to<std::string_view>;      // in scene files
    { S::label } -> std::convertible_to<std::string_view>;     // in the viewer
    { S::distance } -> std::convertible_to<std::string_view>;  // the formula of d
    std::tuple_size<decltype(S::members())>::value;
    { S::may_taper } -> std::convertible_to<bool>;  // its width may be a list
    { s.middle() } -> std::same_as<Vec3d>;
    { parts_of(s) } -> std::same_as<std::vector<SkeletonPart>>;
};

// So many numbers are read of a part at the most.
inline constexpr std::size_t most_part_numbers =
    std::max(convex_part::most_numbers, curve_arc::most_numbers);

inline constexpr std::size_t shape_count = Shapes::size;
inline constexpr std::size_t field_shape_count = FieldShapes::size;

namespace shapes_detail {

struct Traits {
    bool is_taper, is_joined, has_numbers;
};
inline constexpr auto traits = []<class... S>(TypeList<S...>) {
    return std::array<Traits, sizeof...(S)>{Traits{S::is_taper, S::is_joined, S::has_numbers}...};
}(FieldShapes{});

}  // namespace shapes_detail

[[nodiscard]] constexpr bool is_taper(Shape shape) {
    return shapes_detail::traits[static_cast<std::size_t>(shape)].is_taper;
}
[[nodiscard]] constexpr bool is_joined(Shape shape) {
    return shapes_detail::traits[static_cast<std::size_t>(shape)].is_joined;
}
[[nodiscard]] constexpr bool has_numbers(Shape shape) {
    return shapes_detail::traits[static_cast<std::size_t>(shape)].has_numbers;
}

template <class S>
inline constexpr Shape shape_of = static_cast<Shape>(index_in<S, FieldShapes>);
template <Shape shape>
using SkeletonOf = TypeAt<static_cast<std::size_t>(shape), FieldShapes>;

// visit.operator()<S>() of that shape.
template <class Visit>
constexpr decltype(auto) with_shape(Shape shape, const Visit& visit) {
    return with_type(Shapes{}, static_cast<std::size_t>(shape), visit);
}

// The same of what fields are made of.
template <class Visit>
constexpr decltype(auto) with_field_shape(Shape shape, const Visit& visit) {
    return with_type(FieldShapes{}, static_cast<std::size_t>(shape), visit);
}

// Calls visit(member) for each member of S, in order.
template <class S, class Visit>
constexpr void for_members(const Visit& visit) {
    std::apply([&](const auto&... member) { (visit(member), ...); }, S::members());
}

// "point", ..., in the order of `Shape`: the words of the file format.
inline constexpr auto shape_words = []<class... S>(TypeList<S...>) {
    static_assert((SkeletonShape<S> && ...) && FieldShape<TaperedSegment> &&
                  FieldShape<TaperedPolyline>);
    return std::array<std::string_view, sizeof...(S)>{S::word...};
}(Shapes{});

[[nodiscard]] inline Shape shape_of_skeleton(const Skeleton& skeleton) {
    return static_cast<Shape>(skeleton.index());
}
[[nodiscard]] inline const char* shape_word(const Skeleton& skeleton) {
    return shape_words[skeleton.index()].data();  // a literal: it ends with a 0
}

}  // namespace ivory
#endif
