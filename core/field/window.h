// A window [begin, end] of a bundle's t, ready for the inner loops: f'' and all rounding errors are
// bounded on it, for all of its rays at once, so that the loops carry none of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/field/condensed.h"
#include "core/field/groups.h"
#include "core/math/vec3.h"
#include "core/shape/bundle_entry.h"

namespace ivory {

// What bounds the sums of one stage, in units of its own: f = sum - T.
struct StageBounds {
    double above = 0, below = 0;  // f <= computed + above, f >= computed - below
    double slope = 0;             // |g' - computed|, g the sum over the fine entries
};

// Of so many entries of a group in float the sums are added up.
inline constexpr std::uint32_t float_sum_length = 64;

// The elements that a stage adds up, sorted by group.
template <class Real>
struct StageEntries {
    std::array<std::uint32_t, field_groups> count{};  // of the groups that are present
    std::uint64_t present = 0;                        // groups that have entries, one bit each
    // Longer than there are entries: the memory is kept.
    std::vector<BundleEntry<Real>> entry;
    std::vector<std::uint32_t> element;  // index into Field
    std::size_t size = 0;
    // Numbers that entries point to, of parts that were narrowed down: they stay where they are.
    static constexpr std::size_t numbers_of_piece = 32;
    std::deque<std::array<Real, numbers_of_piece>> piece;
    std::size_t pieces = 0;

    [[nodiscard]] std::span<const std::uint32_t> elements() const { return {element.data(), size}; }
    void clear() {
        size = pieces = 0;
        present = 0;
    }
    [[nodiscard]] std::span<Real> new_piece() {
        if (pieces == piece.size()) piece.emplace_back();
        return piece[pieces++];
    }
    // The last so many entries are all of that group.
    void end_group(std::size_t group, std::size_t entries) {
        static_assert(field_groups <= 64);
        if (entries == 0) return;
        count[group] = static_cast<std::uint32_t>(entries);
        present |= std::uint64_t{1} << group;
    }
    // For so many more.
    void make_room(std::size_t more) {
        if (entry.size() >= size + more) return;
        entry.resize(2 * (size + more));
        element.resize(2 * (size + more));
    }
};

// One window, ready for the inner loops.
struct Window {
    double begin = 0, middle = 0, end = 0;  // t
    Vec3d origin, axis;                     // of the bundle, or of the part it is made for
    float tau_begin = 0, tau_end = 0;       // (t - middle) / unit, outward

    // Bounds of f'' on the window: -fall <= f'' <= rise where f is smooth, per square of a scene
    // unit.
    double rise = 0, fall = 0;

    // p - c with p relative to the middle. The strong entries alone tell f < 0 where the surface is
    // far enough.
    StageEntries<float> strong, weak;
    StageBounds strong_bounds, coarse_bounds;  // of the strong ones, of both; per unit
    bool coarse_usable = false;
    bool is_unknown = false;  // nothing is: it stands for all that was not looked at
    // If not null, both are empty, or there to be looked at only, and this is f + T: it stays where it is.
    const Condensed* condensed = nullptr;
    bool is_rough = false;                // a rough one
    const CondensedRay* along = nullptr;  // likewise of the fine entries, in a window for one ray
    // Of a condensed one: what its elements leave out, at most, and what the gradient is off by, per unit.
    double walk_left_out = 0, gradient_error = 0;

    // Once `complete` has been called for this window:
    bool is_complete = false;
    StageEntries<double> fine;          // likewise, in scene units
    StageEntries<float> fine_in_float;  // those of them that float is good enough for, as in `weak`
    StageBounds fine_bounds;            // of both, the slope computed of the first; per scene unit
    bool fine_usable = false;
    // `fine` has to be added up without losing what the sums are rounded by (Knuth's two-sum).
    bool compensated = false;
};

}  // namespace ivory
