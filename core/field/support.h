// Where the field can matter: the elements that reach a bundle of rays, and what all others could
// add. Skipping of elements, all of it proved: an upper bound of |F_i| over the bundle comes from
// the least distance between skeleton and bundle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/field/field.h"
#include "core/interval/interval.h"
#include "core/math/vec3.h"

namespace ivory {

// A sorted list of elements that stands for the whole field on some set of rays:
// sum over the list + [left_out.lo, left_out.hi] encloses the sum of all F_i at every point of these rays,
// unless the list is certainly empty. A list of many elements may name clusters of them instead.
struct ElementList {
    std::vector<std::uint32_t> elements;  // indices into Field, ascending
    std::vector<std::uint32_t> clusters;  // likewise, into Field::clusters; then no elements
    Interval<double> left_out{0.0, 0.0};
    bool certainly_empty = false;  // f < 0 on all these rays: every one is a miss, none needs more

    // No fewer elements than there are on the list, and how many indices.
    [[nodiscard]] std::size_t most_elements() const {
        return elements.size() + clusters.size() * cluster_size;
    }
    [[nodiscard]] std::size_t size() const { return elements.size() + clusters.size(); }
};

// All rays from within `radius` of `apex` whose direction makes an angle of at most asin(sine) with
// `axis`.
struct Cone {
    Vec3d apex;
    Vec3d axis;         // any length but 0
    double sine = 0;    // rounded up; > 1: every direction
    double radius = 0;  // rounded up
};

// No unit vector of the cone ends farther than this from that along its axis; above 1/2 where the
// cone is too wide for core/field/bundle.h.
[[nodiscard]] double spread_of(const Cone& cone);

[[nodiscard]] ElementList all_elements(const Field& field);

// The same as clusters, where the field has any.
[[nodiscard]] ElementList all_clusters(const Field& field);

// The elements of `parent` that matter on the cone's rays, none of them as clusters; the others
// join `left_out`. `parent` has to be valid on these rays. The result depends on the arguments
// alone; it has all elements of `parent` where the cone is too wide for bounds, or the field not
// compact. Of rays with directions of length 1 within 2^-50 also on the part with t in `part`
// alone; then `certainly_empty` is about that part.
[[nodiscard]] ElementList reaching_elements(const Field& field, const ElementList& parent,
                                            const Cone& cone,
                                            const Interval<double>& part = {0.0, infinity<double>});

// The same for a list of clusters: those that matter, if they are many; else, and of any other
// list, the elements.
[[nodiscard]] ElementList reaching_clusters(const Field& field, const ElementList& parent,
                                            const Cone& cone);

}  // namespace ivory
