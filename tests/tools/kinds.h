// Every shape and every kernel, from core's own lists, and what skeletons of any shape consist of.
#pragma once

#include <array>
#include <cstddef>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "core/kernel/kernels.h"
#include "core/scene/scene.h"
#include "core/shape/shapes.h"

namespace ivory::tools {

// Of fields: segments of two widths are one of their own.
inline constexpr auto every_shape = [] {
    std::array<Shape, field_shape_count> all{};
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Shape>(n);
    return all;
}();

inline constexpr auto every_kernel = [] {
    std::array<KernelKind, kernel_count> all{};
    for (std::size_t n = 0; n < kernel_count; ++n) all[n] = static_cast<KernelKind>(n);
    return all;
}();

// What an element can be, and the name of tests of such: "point_blinn".
struct ElementKind {
    Shape shape;
    KernelKind kernel;
};

inline constexpr auto every_kind = [] {
    std::array<ElementKind, every_shape.size() * kernel_count> all{};
    for (std::size_t n = 0; n < all.size(); ++n) {
        all[n] = {every_shape[n / kernel_count], every_kernel[n % kernel_count]};
    }
    return all;
}();

inline std::string word_of(Shape shape) {
    if (shape == Shape::taper) return "taper";
    if (shape == Shape::tapered_polyline) return "tapered_polyline";
    return std::string(shape_words[static_cast<std::size_t>(shape)]);
}
inline std::string word_of(KernelKind kernel) { return kernel_word(kernel); }
inline std::string word_of(const ElementKind& kind) {
    return word_of(kind.shape) + '_' + word_of(kind.kernel);
}
inline void PrintTo(const ElementKind& kind, std::ostream* out) { *out << word_of(kind); }

// The name of a parameterised test.
inline constexpr auto name_of_kind = [](const auto& info) { return word_of(info.param); };

// A skeleton of that shape, its members as they are by default.
inline Skeleton skeleton_of(Shape shape) {
    if (shape == Shape::taper) return SegmentSkeleton{};
    if (shape == Shape::tapered_polyline) return PolylineSkeleton();
    return with_shape(shape, []<class S>() { return Skeleton(S{}); });
}

// So many widths as the skeleton has places for them, 0 where it has no list of them.
inline std::size_t width_places(const Skeleton& skeleton) {
    return std::visit(
        []<class S>(const S& s) -> std::size_t {
            if constexpr (S::may_taper)
                return s.width_places();
            else
                return 0;
        },
        skeleton);
}

// The members of a skeleton by what they may be, each kind in the order of the file format.
struct Members {
    std::vector<Vec3d*> places, directions;
    std::vector<double*> lengths;

    explicit Members(Skeleton& skeleton) {
        std::visit(
            [&]<class S>(S& s) {
                for_members<S>([&](const auto& member) { add(member.kind, s.*member.value); });
            },
            skeleton);
    }

  private:
    void add(MemberKind kind, Vec3d& value) {
        (kind == MemberKind::direction ? directions : places).push_back(&value);
    }
    void add(MemberKind, double& value) { lengths.push_back(&value); }
    void add(MemberKind, std::vector<Vec3d>& list) {
        for (Vec3d& value : list) places.push_back(&value);
    }
};

}  // namespace ivory::tools
