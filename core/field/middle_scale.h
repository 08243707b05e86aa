// Scenes whose lengths come near the ends of the doubles, where squares and fourth powers leave them: the
// same scene, every length times a power of two, has the same answers. The field of such a scene has that of
// the other one beside it (Field::middle), and the door to the tracer sends rays there.
#pragma once

#include <optional>

#include "core/scene/scene.h"

namespace ivory {

// The exponent of the power of two that brings a scene's lengths to the middle of the doubles; 0 where they
// are within 2^200 and 2^-200, or where some number would not be exact there.
[[nodiscard]] int exponent_to_middle(const Scene& scene);

// The elements and T alone; exact for that exponent.
[[nodiscard]] Scene in_middle(const Scene& scene, int exponent);

// x 2^exponent, if that is exact.
[[nodiscard]] std::optional<double> scaled_exactly(double x, int exponent);

}  // namespace ivory
