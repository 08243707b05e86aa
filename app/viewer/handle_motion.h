// Where the handles of a skeleton stand in the scene, and what dragging one does to the skeleton.
// Pure functions of view, skeleton and pixels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/document/orbit.h"
#include "core/math/vec3.h"
#include "core/scene/scene.h"

namespace ivory {

// One degree of freedom at its place in the scene. Names: `position`; `a`, `b`, `middle`; `center`,
// `normal`, `radius`.
struct Grip {
    std::string name;
    Vec3d place;
};

// The k of a normal's handle at center + k normal: 1 unless an arrow of that length, in the scene,
// would be too short to grab or too long to reach on the screen. `scale` is that of the window.
[[nodiscard]] double arrow_factor(const Projection& view, const Vec3d& center, double arrow,
                                  double scale);

// The radius stands on the circle where it runs across the line of sight, so that
// it is seen at full length. `arrow` is the length that arrow_factor looks at: the normal's, or that
// which it had when it was grabbed first, so that its tip does not leap.
[[nodiscard]] std::vector<Grip> grips_of(const Projection& view, const Skeleton& skeleton,
                                         double scale, std::optional<double> arrow = std::nullopt);

struct HandleMotion {
    double dx = 0, dy = 0;    // pixels since the handle was grabbed
    std::optional<int> axis;  // 0 x, 1 y, 2 z: only along it
    bool round = false;       // to round coordinates, about ten pixels from one to the next
};

// The skeleton `start` with that handle moved. Free, the handle moves in the plane parallel to the
// screen and is then seen exactly (dx, dy) further; along an axis, as near to that as the axis
// allows and with the other coordinates kept bit for bit. A radius has no direction to lock and
// ends at 0. Nothing where the pointer's line of sight does not meet the axis' plane.
[[nodiscard]] std::optional<Skeleton> moved_by(const Projection& view, const Skeleton& start,
                                               const std::string& handle,
                                               const HandleMotion& motion, double scale,
                                               std::optional<double> arrow = std::nullopt);

}  // namespace ivory
