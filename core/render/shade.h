// Light and colour: from the surface at a point to the bytes of a pixel. Nothing but + - * / and
// square roots, in float (core/render/shade_lanes.h), so that every machine draws the same.
#pragma once

#include <vector>

#include "core/render/camera.h"
#include "core/render/frame.h"
#include "core/render/srgb.h"
#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory {

// The lights of a scene as one view sees them.
struct Lighting {
    struct Lamp {
        Vec3d direction;  // towards the light, unit length, axes of the scene
        Color radiance;   // color times intensity, linear
    };
    std::vector<Lamp> lamps;
    Vec3d zenith;      // unit length: where the brighter half of the surrounding light comes from
    Rgba8 background;  // of a pixel that misses
    Color background_light;  // the same, linear
};

[[nodiscard]] Lighting make_lighting(const Scene& scene, const View& view);

// Lambert's diffuse and Blinn's soft specular reflection of each lamp (Blinn 1977), and a dim
// hemisphere of light from all around, so that no side of a body is black. `direction` is that of
// the ray, of length 1. The side that the viewer sees is lit, from inside a body too; where the
// normal is 0 the surface counts as facing the viewer.
[[nodiscard]] Rgba8 shade(const Lighting& lighting, const Vec3d& direction,
                          const SurfacePoint& surface);

}  // namespace ivory
