#include "core/field/support.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/field/bundle_steps.h"
#include "core/field/left_out.h"
#include "core/math/direction.h"

namespace ivory {

ElementList all_elements(const Field& field) {
    ElementList list;
    list.elements.resize(field.size());
    std::iota(list.elements.begin(), list.elements.end(), 0u);
    list.certainly_empty = field.box.empty();
    return list;
}

ElementList all_clusters(const Field& field) {
    if (field.clusters.empty()) return all_elements(field);
    ElementList list;
    list.clusters.resize(field.clusters.size());
    std::iota(list.clusters.begin(), list.clusters.end(), 0u);
    list.certainly_empty = field.box.empty();
    return list;
}

// Two unit vectors an angle a <= 30 degrees apart have ends 2 sin(a / 2) apart, at most 1.036 sin
// a. The axis' own rounding to length 1 is far below the rest of the margin.
double spread_of(const Cone& cone) { return cone.sine <= 0.45 ? 1.04 * cone.sine + 0x1p-48 : 1; }

namespace {

// The bounds of core/field/bundle_field.h hold on the cone.
bool is_bounded(const Field& field, const Cone& cone) {
    const Vec3d& o = cone.apex;
    return field.compact && spread_of(cone) <= 0.5 && cone.radius < 1e30 &&
           std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < 1e30;
}

// What the rays are parametrized by does not matter to distances; beyond its far end an element
// only gets farther away.
Stretch all_of(const Field& field, const Cone& cone, const Interval<double>& part) {
    double far = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        far += std::max(std::abs(field.skeletons.lo[k] - cone.apex[k]),
                        std::abs(field.skeletons.hi[k] - cone.apex[k]));
    }
    return {
        cone.apex,       unit(cone.axis),
        spread_of(cone), cone.radius,
        part.lo,         std::max(part.lo, std::min(part.hi, (far + cone.radius) * (1 + 0x1p-46)))};
}

// Each element is dropped once, alone or with its cluster, whatever the number of lists between:
// all together stay below 2^-52 T.
double share_of(const Field& field) {
    return field.threshold * 0x1p-52 / (1 + static_cast<double>(field.size()));
}

// What is kept of `candidates`, without the indices.
ElementList list_of(const Field& field, const ElementList& parent, std::size_t candidates,
                    const PeakSums& peaks) {
    ElementList list;
    const LeftOut left_out =
        LeftOut{parent.left_out.hi, -parent.left_out.lo}.with(peaks, candidates, 0x1p-52);
    list.left_out = {-left_out.below, left_out.above};
    list.certainly_empty = certainly_below(field.threshold, peaks, left_out, candidates, 0x1p-52);
    return list;
}

// More of them are not looked at one by one to see whether a list is empty.
constexpr std::size_t most_tested = 8192;

// Nor where their clusters add up to more than this times T: hardly any such list is empty.
constexpr double most_tested_above = 1024;

// The greatest that the clusters' members can add up to on the cone, times Field::scale.
PeakSums peaks_of_members(const Field& field, const Cone& cone, const ActiveElements& clusters) {
    const Stretch rays = all_of(field, cone, {0.0, infinity<double>});
    const double middle = 0.5 * rays.end, per_unit = 1 / field.unit;
    const LocalStretch near{rays.axis,          {},
                            rays.spread,        rays.radius * (1 + 0x1p-46) * per_unit,
                            -middle * per_unit, (rays.end - middle) * (1 + 0x1p-50) * per_unit,
                            middle * per_unit};
    return bundle_steps().bound_members(field, rays, middle, near, 0, clusters, nullptr);
}

void give(const ActiveElements& kept, std::vector<std::uint32_t>& indices) {
    indices.assign(kept.element.begin(),
                   kept.element.begin() + static_cast<std::ptrdiff_t>(kept.size()));
}

}  // namespace

ElementList reaching_elements(const Field& field, const ElementList& parent, const Cone& cone,
                              const Interval<double>& part) {
    if (parent.certainly_empty || parent.size() == 0) return parent;
    thread_local ActiveElements clusters, near_clusters, candidates, kept;
    ElementList from_clusters = parent;  // what the clusters left out is out
    if (!parent.clusters.empty()) {
        clusters.take(field.clusters.first_of_group, parent.clusters);
        if (is_bounded(field, cone)) {
            const PeakSums peaks = bundle_steps().bound_clusters(
                field, all_of(field, cone, part), 1, share_of(field), clusters, near_clusters);
            from_clusters = list_of(field, parent, clusters.size(), peaks);
            if (from_clusters.certainly_empty) return from_clusters;
            candidates.take_members(field.clusters, near_clusters);
        } else {
            from_clusters.clusters.clear();
            candidates.take_members(field.clusters, clusters);
            give(candidates, from_clusters.elements);
        }
    } else {
        candidates.take(field.first, parent.elements);
    }
    if (!is_bounded(field, cone)) return from_clusters;
    const PeakSums peaks = bundle_steps().bound(field, all_of(field, cone, part), 1,
                                                share_of(field), candidates, kept);
    ElementList list = list_of(field, from_clusters, candidates.size(), peaks);
    if (!list.certainly_empty) give(kept, list.elements);
    return list;
}

ElementList reaching_clusters(const Field& field, const ElementList& parent, const Cone& cone) {
    if (parent.clusters.empty()) return reaching_elements(field, parent, cone);
    if (parent.certainly_empty || !is_bounded(field, cone)) return parent;
    thread_local ActiveElements candidates, kept;
    candidates.take(field.clusters.first_of_group, parent.clusters);
    const PeakSums peaks = bundle_steps().bound_clusters(
        field, all_of(field, cone, {0.0, infinity<double>}), 1, share_of(field), candidates, kept);
    ElementList list = list_of(field, parent, candidates.size(), peaks);
    if (list.certainly_empty) return list;
    if (!field.suits_float) {
        give(kept, list.clusters);
        return list.most_elements() < least_clustered ? reaching_elements(field, parent, cone)
                                                      : list;
    }
    // The clusters' members may be too far away all the same.
    if (kept.size() * cluster_size < most_tested &&
        peaks.above < most_tested_above * field.threshold) {
        const PeakSums closer = peaks_of_members(field, cone, kept);
        const LeftOut left_out{list.left_out.hi * field.scale, -list.left_out.lo * field.scale};
        list.certainly_empty = certainly_below(field.threshold * field.scale, closer, left_out,
                                               kept.size() * cluster_size + 60, 0x1p-22);
        if (list.certainly_empty) return list;
    }
    give(kept, list.clusters);
    return list;
}

}  // namespace ivory
