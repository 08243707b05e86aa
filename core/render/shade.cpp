#include "core/render/shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/math/direction.h"
#include "core/render/shade_lanes.h"

namespace ivory {
namespace {

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
    ShadingLanes lanes;
    lanes.add(direction, surface);
    for (std::size_t k = 1; k < 8; ++k) lanes.add(direction, surface);  // whole vectors
    shade_lanes(lighting, lanes);
    return to_srgb({lanes.r[0], lanes.g[0], lanes.b[0]});
}

}  // namespace ivory
