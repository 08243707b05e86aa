// What a scene file calls the members of each shape's skeleton: one table for its reader and its
// writer.
#pragma once

#include <array>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "core/scene/scene.h"

namespace ivory {

template <class Shape, class Value>
struct SkeletonMember {
    std::string_view key;
    Value Shape::*value;
};

// Of each alternative of `Skeleton`, in the order in which they are written. All are required.
template <class Shape>
inline constexpr std::tuple<> skeleton_members{};

template <>
inline constexpr std::tuple skeleton_members<PointSkeleton>{
    SkeletonMember{"position", &PointSkeleton::position}};

template <>
inline constexpr std::tuple skeleton_members<SegmentSkeleton>{
    SkeletonMember{"a", &SegmentSkeleton::a}, SkeletonMember{"b", &SegmentSkeleton::b}};

template <>
inline constexpr std::tuple skeleton_members<CircleSkeleton>{
    SkeletonMember{"center", &CircleSkeleton::center},
    SkeletonMember{"normal", &CircleSkeleton::normal},
    SkeletonMember{"radius", &CircleSkeleton::radius}};

// `visit(key, value)` for each member of the skeleton, constant or not.
template <class Shape, class Visit>
void for_each_member(Shape& skeleton, Visit visit) {
    std::apply([&](const auto&... member) { (visit(member.key, skeleton.*member.value), ...); },
               skeleton_members<std::remove_const_t<Shape>>);
}

template <class Shape>
inline constexpr auto skeleton_keys =
    std::apply([](const auto&... member) { return std::array{member.key...}; },
               skeleton_members<Shape>);

}  // namespace ivory
