// A hierarchy of one level over the elements: neighbours of one group stand side by side in the
// field, and up to `cluster_size` of them are bounded together. Of 100,000 elements the lists of
// regions, blocks and tiles then look at clusters, and only a window at elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/field/groups.h"
#include "core/field/local_elements.h"
#include "core/math/vec3.h"

namespace ivory {

struct Element;
struct Field;
struct Scene;

inline constexpr std::size_t cluster_size = 16;

// Fields of fewer elements have no clusters, and lists of fewer name each by itself: to look at
// each of them costs less than the wider bounds of clusters do.
inline constexpr std::size_t least_clustered = 2048;

// Below so many elements another thread costs more to start than it saves.
inline constexpr std::size_t least_range = 8192;

// As a structure of arrays, sorted by group. At every point p with distance d from the ball, the
// elements' F_i(p) add up to no more than above k(d^2 inverse_square), and to no less than
// -below k(d^2 inverse_square).
struct Clusters {
    std::vector<std::uint32_t> first;  // element of each; one more: the field's size
    GroupStarts first_of_group{};
    std::vector<double> x, y, z, radius;  // of a ball that holds the skeletons
    std::vector<double> above, below;     // sums of the b_i > 0 and of the -b_i > 0
    std::vector<double> inverse_square;   // 1 / w^2 of the widest
    // All elements of the field, each relative to the centre of its cluster; none where widths or
    // skeletons differ too much for float (core/field/bundle_field.h).
    LocalElements members;

    [[nodiscard]] std::size_t size() const { return x.size(); }
    [[nodiscard]] bool empty() const { return x.empty(); }
    // The cluster that holds an element.
    [[nodiscard]] std::uint32_t of(std::uint32_t element) const;
    friend bool operator==(const Clusters&, const Clusters&) = default;
};

// Those of a compact field with that many elements; of others none.
[[nodiscard]] Clusters clusters_of(const Field& field, int threads);

// The bounds of one of them anew, and its members, after elements of the field have changed.
void fit(const Field& field, std::size_t cluster, Clusters& clusters);

// Where an element is, for that order.
[[nodiscard]] Vec3d place_of(const Element& element);

// Indices of elements of the scene, put in the order of their places along a curve through space
// (Morton 1966): those that follow each other are near each other. Equal places keep their order.
void sort_by_place(const Scene& scene, int threads, std::vector<std::uint32_t>& elements);

}  // namespace ivory
