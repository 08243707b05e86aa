// From a camera to its rays: the frame of the view, the ray of each pixel, the cone around a
// rectangle of them. The camera of a scene that names none: framing.h.
#pragma once

#include "core/field/bundle.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/render/tiles.h"
#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory {

// A camera and what follows from it, in double:
//   forward = normalize(target - position), right = normalize(forward x up),
//   top = right x forward, s = tan(fov / 2)
struct View {
    Camera camera;
    Vec3d forward, right, top;
    double s = 0;
};

// Throws Error where the camera has a fault (core/scene/scene_fault.h) or its frame is lost to
// rounding.
[[nodiscard]] View make_view(const Camera& camera);

// The ray through the middle of pixel (i, j), j counted from the top, of a picture of
// width x height:
//   direction = normalize(forward + (2 (i + 0.5)/W - 1) s W/H right + (1 - 2 (j + 0.5)/H) s top)
[[nodiscard]] Ray primary_ray(const View& view, int width, int height, int i, int j);

// Where that ray passes the plane at distance 1 before the camera, the factors of right and top:
//
//        +-----------------+  v =  s
//        |  (0,0)   ...    |
//        |        o        |  (u, v) = (0, 0) is the line of sight
//        |   ...  (W-1,H-1)|
//        +-----------------+  v = -s
//   u = -s W/H         u = s W/H
[[nodiscard]] double plane_u(const View& view, int width, int height, int i);
[[nodiscard]] double plane_v(const View& view, int height, int j);

// A cone that holds the primary rays, as the doubles they are, of all pixels of a rectangle that is
// not empty. Proof: camera.cpp.
[[nodiscard]] Cone cone_around(const View& view, int width, int height, const PixelRect& rect);

// The same as core/field/bundle.h wants it; a spread above 1/2 where the cone is too wide for it.
[[nodiscard]] Bundle bundle_around(const View& view, int width, int height, const PixelRect& rect);

}  // namespace ivory
