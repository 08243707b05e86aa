#include "core/render/shade.h"

#include "core/math/direction.h"
#include "core/render/shade_lanes.h"

namespace ivory {
Lighting make_lighting(const Scene& scene, const View& view) {
    Lighting lighting;
    lighting.zenith = view.top;
    lighting.background = to_srgb(scene.background);
    lighting.background_light = scene.background;
    for (const Light& light : scene.lights ? *scene.lights : default_lights()) {
        const Vec3d d = unit(light.direction);
        lighting.lamps.push_back({light.attached_to_camera
                                      ? unit(d.x * view.right + d.y * view.top - d.z * view.forward)
                                      : d,
                                  light.intensity * light.color});
    }
    return lighting;
}

Rgba8 shade(const Lighting& lighting, const Vec3d& direction, const SurfacePoint& surface) {
    RayBundle rays;
    rays.add(direction);
    BundleSurfaces surfaces;
    surfaces.clear(1);
    surfaces.set_seen(0, surface);
    Rgba8 color;
    shade_lanes(lighting, rays, surfaces, {&color, 1});
    return color;
}

}  // namespace ivory
