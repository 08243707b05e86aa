// What lies under the pointer: a ray through the pixel, traced as the picture's is, over the scene
// as it stands now; so a click is right while the picture still is on its way.
#pragma once

#include <cstddef>
#include <optional>

#include "app/document/orbit.h"
#include "core/scene/scene.h"

namespace ivory {

struct Picked {
    std::size_t element = 0;     // in Scene::elements
    std::optional<Vec3d> place;  // on the surface; nothing where only the skeleton was hit
};

// The element with the greatest |F_i| where the ray through the middle of the pixel at `at` (from
// the picture's top left) first meets the surface.
[[nodiscard]] std::optional<Picked> pick_surface(const Scene& scene, const Projection& view,
                                                 WindowPoint at);

// The visible element whose skeleton is seen nearest to `at`, within `radius` pixels.
[[nodiscard]] std::optional<Picked> pick_skeleton(const Scene& scene, const Projection& view,
                                                  WindowPoint at, double radius);

}  // namespace ivory
