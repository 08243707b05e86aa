// Seeded scenes and rays of families that break tracers, each in a range of difficulty that is drawn
// log-uniformly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory::stress {

enum class Family {
    tangent,   // rays beside a silhouette, off by 1e-3 .. 1e-15 of their distance, on both sides
    neck,      // T within 1e-1 .. 1e-12 of the field between two alike: necks and gaps
    shell,     // less than T inside: shells down to sqrt(1e-15) of a width
    critical,  // T within 1e-3 .. 1e-15 of the field where its gradient is 0, the maximum among them
    faint,     // T from 1e-1 down to 1e-300
    widths,    // widths from 1e-6 to 1e6 in one scene
    shifted,   // coordinates up to 1e12
    scaled,    // lengths from 1e-160 to 1e155
    cancelling,   // strengths that cancel up to their last bits
    coincident,   // hundreds of elements in one place
    overlapping,  // thousands of wide elements
    degenerate,   // every degenerate form of every shape (tests/tools/degenerate_scenes.h)
    axes,     // rays along axes, in planes, through ends and vertices, or beside by 1e-3 .. 1e-15
    origins,  // from the surface, from beside it by 1e-3 .. 1e-15, from inside
    directions,  // lengths from 1e-150 to 1e150, zeros and negative zeros
};

inline constexpr std::array<std::string_view, 15> family_words{
    "tangent",     "neck",       "shell",  "critical",   "faint",
    "widths",      "shifted",    "scaled", "cancelling", "coincident",
    "overlapping", "degenerate", "axes",   "origins",    "directions"};

struct Trial {
    Scene scene;
    std::vector<Ray> rays;
    std::optional<Camera> camera;  // looks along one of the rays, at much or at little of the scene
};

// The same from the same seed, with about so many rays.
[[nodiscard]] Trial make_trial(Family family, std::uint64_t seed, std::size_t rays);

}  // namespace ivory::stress
