// The compiled field: f(p) = sum of F_i(p) - T over the visible elements, as a structure of arrays.
// F_i(p) = b_i k_i(d_i(p) / w_i); kernels k in core/kernel, distances d in core/shape.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/field/clusters.h"
#include "core/field/groups.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "core/scene/scene.h"

namespace ivory {

// Visible elements only, sorted by group; within a group in file order, but where there are
// clusters by their places (core/field/clusters.h). The doubles are those of the scene, unchanged:
// every proof is about them. An element of several parts (core/shape/joined.h) stands as these, one
// after the other: what is called an element here is one of them, whose F is the element's where it
// is the nearest.
struct Field {
    double threshold = 0;    // T
    double least_width = 0;  // the least w_i; 1 where there is no element
    double greatest_width = 0;
    double greatest_size = 0;  // of the skeletons: lengths and radii
    // No number is so large or so small, nor any strength so far above T or any two widths so far
    // apart, that products of four of them could leave the range of double: what
    // core/field/bundle_field.h asks for.
    bool compact = false;
    // Of a compact field: the greatest power of two up to the greatest width, and what T times it
    // is in [1/2, 1).
    double unit = 1, scale = 1;
    // And neither widths nor skeletons are so different that what float takes from a distance,
    // 2^-17 of lengths up to 100 units, would be much beside the thinnest element.
    bool suits_float = false;

    std::vector<Shape> shape;
    std::vector<KernelKind> kernel;
    std::vector<double> strength;    // b_i
    std::vector<double> width;       // w_i
    std::vector<double> ax, ay, az;  // SkeletonColumns::a, and so on
    std::vector<double> bx, by, bz;
    std::vector<double> radius;
    // Of tapers: SkeletonColumns::width_a and so on, and the least width of the whole element; none
    // where there are no tapers.
    std::vector<double> width_a, width_b, width_of_all;
    // SkeletonColumns::numbers of all elements and, of a compact field, the same with lengths in units;
    // where each element's begin. None where no shape has any.
    std::vector<double> numbers;
    std::vector<float> numbers_in_units;
    std::vector<std::int32_t> numbers_first;
    std::vector<Color> color;           // linear RGB
    std::vector<std::uint32_t> source;  // index in Scene::elements
    GroupStarts first{};
    // The s = q^2 beyond which element i counts as nothing and joins the rest that is kept as an
    // interval: |F_i| is about 2^-50 T / n there, so that all rests together stay near 2^-50 T.
    std::vector<double> cut;

    // What core/field/bundle_field.h asks for again and again, computed to nearest.
    std::vector<double> mx, my, mz, parameter, length;  // SkeletonColumns::m, and so on
    std::vector<double> inverse_width;                  // 1 / w
    std::vector<double> inverse_square;                 // 1 / w^2
    std::vector<float> red, green, blue;                // `color`, for what is only looked at
    bool one_color = true;                              // all elements have the same

    Clusters clusters;

    // Around all skeletons.
    Box3 skeletons;
    // The box around all balls d_i <= reach_i, and that box shrunk: all of {f >= 0} lies in either,
    // proved. Empty: the surface is empty. mathematics: core/field/bounding_box.h
    Box3 reach_box;
    Box3 box;

    // Of a scene near the ends of the doubles, that with all lengths times 2^exponent
    // (core/field/middle_scale.h); else null.
    std::shared_ptr<const Field> middle;
    int exponent_to_middle = 0;

    friend bool operator==(const Field&, const Field&) = default;

    [[nodiscard]] std::size_t size() const { return shape.size(); }
    [[nodiscard]] Vec3d a(std::size_t i) const { return {ax[i], ay[i], az[i]}; }
    [[nodiscard]] Vec3d b(std::size_t i) const { return {bx[i], by[i], bz[i]}; }
    [[nodiscard]] SkeletonColumns columns(std::size_t i) const {
        SkeletonColumns c{a(i), b(i), {mx[i], my[i], mz[i]}, radius[i], length[i], parameter[i]};
        if (is_taper(shape[i])) {
            c.width_a = width_a[i];
            c.width_b = width_b[i];
        }
        if (has_numbers(shape[i])) c.numbers = numbers_of(i);
        return c;
    }
    [[nodiscard]] std::span<const double> numbers_of(std::size_t i) const {
        return std::span(numbers).subspan(static_cast<std::size_t>(numbers_first[i]));
    }
    [[nodiscard]] PartNumbers<double> all_numbers() const {
        return {numbers.data(), numbers_first.data(), static_cast<std::uint32_t>(size())};
    }
    [[nodiscard]] PartNumbers<float> all_numbers_in_units() const {
        return {numbers_in_units.data(), numbers_first.data(), static_cast<std::uint32_t>(size())};
    }
    // Of a taper `width` is the least.
    [[nodiscard]] double greatest_width_of(std::size_t i) const {
        return is_taper(shape[i]) ? std::max(width_a[i], width_b[i]) : width[i];
    }
    // What a text calls the width of the scene's element that i is of.
    [[nodiscard]] double width_of_element(std::size_t i) const {
        return is_taper(shape[i]) ? width_of_all[i] : width[i];
    }
    // i + 1 is another part of the same.
    [[nodiscard]] bool joins_next(std::size_t i) const {
        return is_joined(shape[i]) && i + 1 < size() && source[i + 1] == source[i];
    }
};

// Calls visit(parts) for each element of the scene that a list, sorted, names parts of: a span of these.
template <class Visit>
void for_elements(const Field& field, std::span<const std::uint32_t> list, const Visit& visit) {
    for (std::size_t first = 0; first < list.size();) {
        std::size_t end = first + 1;
        if (is_joined(field.shape[list[first]])) {
            while (end < list.size() && field.source[list[end]] == field.source[list[first]]) ++end;
        }
        visit(list.subspan(first, end - first));
        first = end;
    }
}

// Does not throw (but for memory); the scene has been validated by its reader. The field is the
// same for any number of threads.
[[nodiscard]] Field compile(const Scene& scene, int threads = 1);

enum class Refit : std::uint8_t {
    impossible,  // the field is what it was: compile
    as_compiled,
    // Elements have moved that compile would put elsewhere among the others: all holds, but
    // clusters are larger than they need be.
    stretched,
};

// Makes the field that was compiled from `before` (or refitted since) that of `after`. Possible
// where these differ in the threshold and in numbers and colours of elements, and where there are
// clusters of no more than a few elements.
Refit refit(Field& field, const Scene& before, const Scene& after);

// The colours of a scene that differs in nothing else from the one that `field` was compiled from.
// Which elements have another than before, or all, where they share one now or did: indices into
// `field`, ascending.
std::vector<std::uint32_t> recolor(Field& field, const Scene& scene);

}  // namespace ivory
