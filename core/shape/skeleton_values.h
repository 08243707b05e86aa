// What the files of the shapes share: the members of a skeleton as files, panels and messages know
// them, and what the compiled field keeps of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/interval/rounding.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"

namespace ivory {

enum class MemberKind : unsigned char {
    place,      // a Vec3d, finite
    places,     // a list of such, at least so many as the member says
    direction,  // a Vec3d, finite and not 0; its length does not matter
    length,     // a double, finite and at least 0
};

// One member of a skeleton: its key in scene files, what a panel calls it, what it may be.
template <class Skeleton, class Value>
struct Member {
    std::string_view key, label;
    MemberKind kind;
    Value Skeleton::*value;
    // Of a list: so many at the least and at the most.
    std::size_t least = 1, most = std::size_t(-1);
};

template <class Skeleton>
constexpr Member<Skeleton, Vec3d> place(std::string_view key, std::string_view label,
                                        Vec3d Skeleton::*value) {
    return {key, label, MemberKind::place, value};
}
template <std::size_t least, std::size_t most = std::size_t(-1), class Skeleton>
constexpr Member<Skeleton, std::vector<Vec3d>> places(std::string_view key, std::string_view label,
                                                      std::vector<Vec3d> Skeleton::*value) {
    return {key, label, MemberKind::places, value, least, most};
}
template <class Skeleton>
constexpr Member<Skeleton, Vec3d> direction(std::string_view key, std::string_view label,
                                            Vec3d Skeleton::*value) {
    return {key, label, MemberKind::direction, value};
}
template <class Skeleton>
constexpr Member<Skeleton, double> length(std::string_view key, std::string_view label,
                                          double Skeleton::*value) {
    return {key, label, MemberKind::length, value};
}

// A skeleton as numbers side by side: one column of the field for each component.
struct SkeletonColumns {
    Vec3d a, b;                       // as written
    Vec3d m;                          // computed to nearest, for the quick bounds
    double radius = 0;                // as written
    double length = 0;                // of m, where it has one that matters
    double parameter = 0;             // what else the quick bounds need
    double width_a = 0, width_b = 0;  // of tapers, as written: at a and at b
    std::span<const double> numbers =
        {};  // where the shape has_numbers: from the part's first one on
};

// One part of a skeleton with numbers of its own, which its columns do not point to.
struct SkeletonPart {
    SkeletonColumns columns;
    std::vector<double> numbers;

    // For as long as the part lives.
    [[nodiscard]] SkeletonColumns seen() const {
        SkeletonColumns c = columns;
        if (!numbers.empty()) c.numbers = numbers;
        return c;
    }
};

// The numbers of all elements of a field, side by side: where those of one begin. Any offset may be
// read from for as long as a part can be.
template <class Real>
struct PartNumbers {
    const Real* all = nullptr;
    const std::int32_t* first = nullptr;  // of each element
    std::uint32_t elements = 0;

    [[nodiscard]] const Real* of(std::size_t element) const { return all + first[element]; }
    friend bool operator==(const PartNumbers&, const PartNumbers&) = default;
};

// What a number of that power of lengths has to be multiplied by to be in units.
template <int power>
[[nodiscard]] constexpr double unit_factor(double unit) {
    static_assert(power == -2 || power == 0 || power == 1);
    return power == -2 ? unit * unit : power == 0 ? 1 : 1 / unit;
}

// All of a skeleton lies within `radius` of the box; both as written, so that only sums have to be
// rounded.
struct Surroundings {
    Box3 box;
    double radius = 0;
};

// A ball that holds the skeleton, its radius rounded up.
struct Ball {
    Vec3d center;
    double radius = 0;
};

// Of the box around places.
[[nodiscard]] inline Vec3d middle_of(std::span<const Vec3d> places) {
    Box3 box;
    for (const Vec3d& place : places) box.include({place, place});
    return 0.5 * box.lo + 0.5 * box.hi;
}
// The box of all that is off by so much at the most, in each direction.
[[nodiscard]] inline Box3 widened(Box3 box, double by) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lo[axis] = sub_down(box.lo[axis], by);
        box.hi[axis] = add_up(box.hi[axis], by);
    }
    return box;
}

// From the skeleton's nearest point to p, in units of the element's width, and the square s of its
// length; half the gradient of s is that vector.
struct Nearest {
    double s;
    Vec3d away;
    bool defined = true;  // false: on a medial axis
};

}  // namespace ivory
