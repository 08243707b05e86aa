// Seeded random scenes for tests: every shape, kernel and sign of strength, widths that differ.
#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "core/scene/scene.h"
#include "tests/tools/kinds.h"

namespace ivory::tools {

// The same numbers from the same seed with every standard library.
class Random {
  public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    // In [lo, hi).
    double uniform(double lo, double hi) {
        return lo + (hi - lo) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
    }
    // 0 .. count - 1
    std::size_t below(std::size_t count) { return bits_() % count; }
    bool chance(double probability) { return uniform(0, 1) < probability; }
    double sign() { return chance(0.5) ? 1 : -1; }
    Vec3d in_cube(double half) {
        const double x = uniform(-half, half), y = uniform(-half, half);
        return {x, y, uniform(-half, half)};
    }

  private:
    std::mt19937_64 bits_;
};

struct SceneRecipe {
    std::size_t elements = 8;
    double scale = 1;       // of all lengths, before the shift
    double shift = 0;       // added to every coordinate
    bool critical = false;  // elements in pairs p, -p around one centre, where the gradient is then
                            // 0, and T within 1e-3 .. 1e-14 of the field there
    std::optional<ElementKind> only = {};  // nothing but such elements
};

// Coordinates are multiples of 2^-20 before they are scaled and shifted, so that a shift by 1e6
// alone rounds nothing.
[[nodiscard]] Scene random_scene(const SceneRecipe& recipe, std::uint64_t seed);

// The shapes by turns in the unit ball, small and narrow: what a person may have
// made of many elements, seen from near by.
[[nodiscard]] Scene mixed_scene(std::size_t elements, std::uint64_t seed);

}  // namespace ivory::tools
