#include "core/field/clusters.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <variant>

#include "core/field/field.h"
#include "core/math/box3.h"
#include "core/math/parallel.h"
#include "core/scene/scene.h"

namespace ivory {
namespace {

// Far more than the roundings of a sum or a length here.
constexpr double more = 1 + 0x1p-40;

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// 10 bits, two zeros between each and the next.
std::uint32_t spread_bits(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

Ball ball_of(const Field& field, std::size_t i) {
    return with_field_shape(field.shape[i], [&]<class S>() { return S::ball(field.columns(i)); });
}

// The element relative to its cluster's centre.
void put_member(const Field& field, std::size_t i, const Vec3d& center, LocalElements& members) {
    const double per_unit = 1 / field.unit;
    const auto narrow = [](double x) { return static_cast<float>(x); };
    const Vec3d v = field.a(i) - center;
    members.element[i] = static_cast<std::int32_t>(i);
    members.x[i] = narrow(v.x * per_unit);
    members.y[i] = narrow(v.y * per_unit);
    members.z[i] = narrow(v.z * per_unit);
    members.strength[i] = narrow(field.strength[i] * field.scale);
    members.inverse_square[i] = narrow(field.inverse_square[i] * field.unit * field.unit);
    with_field_shape(field.shape[i], [&]<class S>() {
        const double m_factor = unit_factor<S::m_power>(field.unit);
        members.mx[i] = narrow(field.mx[i] * m_factor);
        members.my[i] = narrow(field.my[i] * m_factor);
        members.mz[i] = narrow(field.mz[i] * m_factor);
        members.parameter[i] = narrow(
            std::min(field.parameter[i] * unit_factor<S::parameter_power>(field.unit), 1e30));
    });
    members.length[i] = narrow(field.length[i] * per_unit);
    members.source[i] = static_cast<std::int32_t>(field.source[i]);
    if (is_taper(field.shape[i])) {
        members.taper_rate[i] =
            narrow((field.width_b[i] - field.width_a[i]) * field.inverse_width[i]);
    }
}

}  // namespace

std::uint32_t Clusters::of(std::uint32_t element) const {
    return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), element) -
                                      first.begin() - 1);
}

Vec3d place_of(const Element& element) {
    return std::visit([](const auto& skeleton) { return skeleton.middle(); }, element.skeleton);
}

void fit(const Field& field, std::size_t cluster, Clusters& clusters) {
    const std::size_t first = clusters.first[cluster], end = clusters.first[cluster + 1];
    Box3 box;
    double above = 0, below = 0, widest = 0;
    for (std::size_t i = first; i < end; ++i) {
        const Vec3d middle = ball_of(field, i).center;
        box.include({middle, middle});
        // of the parts of one element, side by side, only one counts
        if (i == first || !field.joins_next(i - 1)) {
            (field.strength[i] > 0 ? above : below) += std::abs(field.strength[i]);
        }
        widest = std::max(widest, field.greatest_width_of(i));
    }
    const Vec3d center = 0.5 * box.lo + 0.5 * box.hi;
    double radius = 0;
    for (std::size_t i = first; i < end; ++i) {
        const auto [middle, reach] = ball_of(field, i);
        radius = std::max(radius, (length(middle - center) + reach) * more);
        if (field.suits_float) put_member(field, i, center, clusters.members);
    }
    clusters.x[cluster] = center.x;
    clusters.y[cluster] = center.y;
    clusters.z[cluster] = center.z;
    clusters.radius[cluster] = radius;
    clusters.above[cluster] = above * more;
    clusters.below[cluster] = below * more;
    clusters.inverse_square[cluster] = 1 / (widest * widest) * (1 - 0x1p-40);
}

Clusters clusters_of(const Field& field, int threads) {
    Clusters clusters;
    if (!field.compact || field.size() < least_clustered) return clusters;
    for (std::size_t group = 0; group < field_groups; ++group) {
        if (!field.first.has(group)) continue;
        const auto [begin, end] = field.first.range(group);
        clusters.first_of_group.begin(group, clusters.first.size());
        for (std::uint32_t first = begin; first < end; first += cluster_size) {
            clusters.first.push_back(first);
        }
    }
    const std::size_t count = clusters.first.size();
    clusters.first_of_group.end(count);
    clusters.first.push_back(static_cast<std::uint32_t>(field.size()));
    for (auto* column : {&clusters.x, &clusters.y, &clusters.z, &clusters.radius, &clusters.above,
                         &clusters.below, &clusters.inverse_square}) {
        column->resize(count);
    }
    if (field.suits_float) {
        clusters.members.make_room(field.size());
        clusters.members.first = field.first;
    }
    for_ranges(count, threads, least_range / cluster_size, [&](std::size_t from, std::size_t to) {
        for (std::size_t cluster = from; cluster < to; ++cluster) fit(field, cluster, clusters);
    });
    return clusters;
}

void sort_by_place(const Scene& scene, int threads, std::vector<std::uint32_t>& elements) {
    std::mutex mutex;
    Box3 box;
    for_ranges(elements.size(), threads, least_range, [&](std::size_t first, std::size_t end) {
        Box3 of_range;
        for (std::size_t k = first; k < end; ++k) {
            const Vec3d place = place_of(scene.elements[elements[k]]);
            of_range.include({place, place});
        }
        const std::lock_guard lock(mutex);
        box.include(of_range);
    });
    const auto cell = [&](double x, std::size_t axis) {
        const double share = (x - box.lo[axis]) / (box.hi[axis] - box.lo[axis]);
        // Not a number, or beyond them, where the box is empty or too large.
        return share > 0 && share <= 1 ? static_cast<std::uint32_t>(share * 1023) : 0;
    };
    // The key above the index: one number to compare, no two alike.
    std::vector<std::uint64_t> keys(elements.size());
    std::vector<std::size_t> ends;  // of sorted ranges
    for_ranges(elements.size(), threads, least_range, [&](std::size_t first, std::size_t end) {
        for (std::size_t k = first; k < end; ++k) {
            const Vec3d place = place_of(scene.elements[elements[k]]);
            const std::uint32_t key = spread_bits(cell(place.x, 0)) |
                                      spread_bits(cell(place.y, 1)) << 1 |
                                      spread_bits(cell(place.z, 2)) << 2;
            keys[k] = std::uint64_t{key} << 32 | elements[k];
        }
        const auto begin = keys.begin();
        std::sort(begin + static_cast<std::ptrdiff_t>(first),
                  begin + static_cast<std::ptrdiff_t>(end));
        const std::lock_guard lock(mutex);
        ends.push_back(end);
    });
    std::sort(ends.begin(), ends.end());
    for (std::size_t range = 1; range < ends.size(); ++range) {
        const auto end = [&](std::size_t n) {
            return keys.begin() + static_cast<std::ptrdiff_t>(ends[n]);
        };
        std::inplace_merge(keys.begin(), end(range - 1), end(range));
    }
    for (std::size_t k = 0; k < keys.size(); ++k) {
        elements[k] = static_cast<std::uint32_t>(keys[k]);
    }
}

}  // namespace ivory
