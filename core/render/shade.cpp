#include "core/render/shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/render/direction.h"

namespace ivory {
namespace {

// The material and the room. Shares of the light that falls in.
constexpr double diffuse = 0.78;
constexpr double highlight = 0.24;  // at the middle of a lamp's reflection
constexpr double sky = 0.12;        // light from all around, from the zenith
constexpr double ground = 0.03;     // and from below
constexpr double rim = 0.06;        // what grazing sight mirrors of the surroundings

Color times(const Color& a, const Color& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// x^48: half as bright where the normal is 10 degrees away from the highlight's middle.
double lobe(double x) {
    const double x2 = x * x;
    const double x4 = x2 * x2;
    const double x8 = x4 * x4;
    const double x16 = x8 * x8;
    return x16 * x16 * x16;
}

// Where light adds up beyond `knee` it bends smoothly towards 1 instead of being cut off there.
double shoulder(double x) {
    constexpr double knee = 0.80;
    if (x <= knee) return x;
    const double beyond = (x - knee) / (1 - knee);
    return knee + (1 - knee) * (beyond / (1 + beyond));
}

double srgb_decode(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// The bytes of the sRGB curve by comparison: least_[k] is the least linear value that rounds to k.
class SrgbBytes {
  public:
    SrgbBytes() {
        for (std::size_t k = 1; k < least_.size(); ++k) {
            least_[k] = srgb_decode((static_cast<double>(k) - 0.5) / 255);
        }
        // Nowhere is the curve so steep that one bin held more than two bytes' ends.
        std::size_t byte = 0;
        for (std::size_t bin = 0; bin < first_.size(); ++bin) {
            const double x = static_cast<double>(bin) / bins;
            while (byte < 255 && x >= least_[byte + 1]) ++byte;
            first_[bin] = static_cast<std::uint8_t>(byte);
        }
    }

    [[nodiscard]] std::uint8_t operator()(double linear) const {
        if (!(linear > 0)) return 0;
        if (linear >= 1) return 255;
        std::size_t byte = first_[static_cast<std::size_t>(linear * bins)];
        while (byte < 255 && linear >= least_[byte + 1]) ++byte;
        return static_cast<std::uint8_t>(byte);
    }

  private:
    static constexpr int bins = 4096;
    std::array<double, 256> least_{};
    std::array<std::uint8_t, bins + 1> first_{};
};

}  // namespace

Rgba8 to_srgb(const Color& linear) {
    static const SrgbBytes byte;
    return {byte(linear.x), byte(linear.y), byte(linear.z), 255};
}

Lighting make_lighting(const Scene& scene, const View& view) {
    Lighting lighting;
    lighting.zenith = view.top;
    lighting.background = to_srgb(scene.background);
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
    const Vec3d to_viewer = -direction;
    Vec3d normal = surface.normal;
    if (normal == Vec3d{0, 0, 0}) normal = to_viewer;
    double facing = dot(normal, to_viewer);
    if (facing < 0) {
        normal = -normal;
        facing = -facing;
    }

    // From all around: brighter from above; at grazing sight the surface mirrors (Schlick 1994).
    const double upward = 0.5 + 0.5 * dot(normal, lighting.zenith);
    const double around = ground + (sky - ground) * upward;
    const double graze = 1 - std::min(facing, 1.0);
    const double graze2 = graze * graze;
    Color light = around * surface.color;
    const double mirrored = rim * upward * (graze2 * graze2);
    light = light + Color{mirrored, mirrored, mirrored};

    for (const Lighting::Lamp& lamp : lighting.lamps) {
        const double lit = dot(normal, lamp.direction);
        if (!(lit > 0)) continue;
        // Halfway between viewer and lamp; opposite to each other they have no halfway, and then
        // the surface cannot face both.
        const Vec3d halfway = lamp.direction + to_viewer;
        const double across = dot(normal, halfway) / std::sqrt(dot(halfway, halfway));
        // Fades in with the light itself, so that no highlight is cut at the edge of the shadow.
        const double gloss = highlight * lobe(std::min(across, 1.0)) * std::min(1.0, 4 * lit);
        light =
            light + (diffuse * lit) * times(surface.color, lamp.radiance) + gloss * lamp.radiance;
    }
    return to_srgb({shoulder(light.x), shoulder(light.y), shoulder(light.z)});
}

}  // namespace ivory
