// The elements that matter on a stretch of a bundle, with what is known of them there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/field/clusters.h"
#include "core/field/groups.h"
#include "core/field/local_elements.h"

namespace ivory {

// Elements that matter on a stretch, sorted by group.
struct ActiveElements {
    GroupStarts first{};
    // Indices into Field. Vectors are read whole, beyond the last element too: 0 stands there.
    std::vector<std::int64_t> element;
    std::vector<double> least;  // lower bound of s on the stretch
    std::vector<double> most;   // upper bound of s, but for points
    std::vector<double> peak;   // upper bound of k
    std::vector<double> whole;  // of what is joined: that of all parts of the element
    std::vector<double> piece_middle, piece_half;  // of what is narrowed down: shape_lanes.inl
    std::vector<double> inverse;  // after `bend`; circle: upper bound of 1 / rho; < 0: rho may be 0

    static constexpr std::size_t room = 16;

    // All that is narrowed down is whole.
    bool is_whole = true;

    [[nodiscard]] std::size_t size() const { return first.size(); }
    // A sorted list, of which nothing more is known; `groups`: where they begin, as in
    // Field::first.
    void take(const GroupStarts& groups, std::span<const std::uint32_t> elements);
    // The members of clusters.
    void take_members(const Clusters& clusters, const ActiveElements& of);
    // Element i of those, with its bounds, as the last one: there has to be room, and its group has to
    // have begun.
    void take(const LocalElements& near, std::size_t i, double unit);
    // Keeps nothing.
    void make_room(std::size_t count);
    // All groups are there: so many elements.
    void end(std::size_t count);
};

}  // namespace ivory
