// The camera that frames the surface, proved: of a scene without a camera, and of the viewer's
// Home.
//
// For a given direction, window and field of view the four planes through the eye and the edges of
// the window have fixed normals, so that where the eye has to be follows from four numbers: how far
// the solid {f >= 0} reaches along each of these normals. Each is bounded by planes beyond which
// the elements cannot add up to T, then by branch and bound over cubes: those in which f < 0
// certainly holds are left out, and the one that reaches farthest is cut into eight, until the
// bound is within a hundredth of the picture of a point of the solid. Of an orthographic camera the
// planes are those of the window's edges along the view, and what follows is its place and height.
#pragma once

#include <cstddef>

#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/scene/scene.h"

namespace ivory {

// The share of the picture's width and height within which the whole surface is proved to lie.
inline constexpr double framed_share = 0.96;

struct Framing {
    Camera camera;
    bool empty = false;  // the surface is proved to be empty: the box [-1, 1]^3 is framed
    // What it took: cubes of which f was bounded, and elements and clusters of them looked at.
    std::size_t cells = 0, element_evaluations = 0;
};

// The camera with the projection, direction of view, `up` and `fov` of `seen_as`, a valid one, that
// frames the surface in a picture with `aspect` = width / height, > 0. Its target is in the middle of
// the surface's depth; of an orthographic one the whole surface is proved to lie behind its plane.
// Depends on the arguments alone. The work is limited: a few milliseconds for a few elements, less
// than compile for many, and up to half a second where 100,000 overlap so much that thousands matter
// everywhere. Throws Error where the scene is too large for doubles.
[[nodiscard]] Framing frame_surface(const Field& field, const Camera& seen_as, double aspect);

// The camera of a scene without one: framed from the direction (0.4, 0.3, 1).
// Throws Error where the scene is too large for doubles.
[[nodiscard]] Camera default_camera(const Field& field, double aspect);

// The scene's camera, or the default one for a picture of that many pixels.
[[nodiscard]] Camera camera_of(const Scene& scene, const Field& field, int width, int height);

}  // namespace ivory
