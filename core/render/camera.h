// From a camera to its rays: the frame of the view, the ray of each pixel, the cone around a
// rectangle of them. The camera of a scene that names none: framing.h.
#pragma once

#include <cstdint>

#include "core/field/bundle.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/render/tiles.h"
#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory {

// A camera and what follows from it, in double:
//   forward = normalize(target - position), right = normalize(forward x up),
//   top = right x forward, s = tan(fov / 2); of an orthographic camera s = height / 2
struct View {
    Camera camera;
    Vec3d forward, right, top;
    double s = 0;

    // Where the rays begin or, of an orthographic camera, the middle of the plane where they do: the
    // camera's position, or that of an eye.
    Vec3d origin;
    // Of an eye: how far to the right of its line of sight, at distance 1, the middle of the picture stands.
    double shift = 0;

    [[nodiscard]] bool is_orthographic() const { return camera.is_orthographic(); }
};

// Throws Error where the camera has a fault (core/scene/scene_fault.h) or its frame is lost to
// rounding.
[[nodiscard]] View make_view(const Camera& camera);

// The height of an orthographic picture: as the camera says or, where it does not, what fov sees at the
// target.
[[nodiscard]] double height_of(const Camera& camera);
// The same camera, an orthographic one with that height written out.
[[nodiscard]] Camera with_height(const Camera& camera);

enum class Eye : std::uint8_t { left, right };

// The view of one of two eyes `apart` > 0 from each other, which see the target at the same place.
// Throws Error where the camera is orthographic: its eyes would see the same.
[[nodiscard]] View eye_of(const View& view, Eye eye, double apart);
// Of eyes that nothing is said about: a thirtieth of the target's distance.
[[nodiscard]] double usual_eye_distance(const Camera& camera);

// The ray through the middle of pixel (i, j), j counted from the top, of a picture of
// width x height:
//   direction = normalize(forward + u right + v top)
//   u = (2 (i + 0.5)/W - 1) s W/H + shift,  v = (1 - 2 (j + 0.5)/H) s
// and of an orthographic camera direction = forward, origin = position + u right + v top. With eyes D
// apart and the window that both look through at distance z, that is normalize(z (forward + u0 right +
// v top) + (D/2) right) for the left one, whose shift is D/2 / z.
[[nodiscard]] Ray primary_ray(const View& view, int width, int height, int i, int j);

// Where that ray passes the plane at distance 1 before the camera, or an orthographic one's own, the
// factors of right and top:
//
//        +-----------------+  v =  s
//        |  (0,0)   ...    |
//        |        o        |  (u, v) = (0, 0) is the line of sight
//        |   ...  (W-1,H-1)|
//        +-----------------+  v = -s
//   u = -s W/H         u = s W/H
[[nodiscard]] double plane_u(const View& view, int width, int height, int i);
[[nodiscard]] double plane_v(const View& view, int height, int j);

// The vector before it is normalised; and where an orthographic camera's ray begins.
[[nodiscard]] Vec3d through_window(const View& view, double u, double v);
[[nodiscard]] Vec3d origin_on_plane(const View& view, double u, double v);
// What the latter is off by where |u| + |v| <= reach.
[[nodiscard]] double origin_error(const View& view, double reach);

// A cone that holds the primary rays, as the doubles they are, of all pixels of a rectangle that is
// not empty. Proof: camera.cpp.
[[nodiscard]] Cone cone_around(const View& view, int width, int height, const PixelRect& rect);

// Of an orthographic camera's rays through places of the plane with u0 <= u <= u1, v0 <= v <= v1 or the
// other way round.
[[nodiscard]] Bundle orthographic_bundle(const View& view, double u0, double u1, double v0,
                                         double v1);

// The same as core/field/bundle.h wants it; a spread above 1/2 where the cone is too wide for it.
[[nodiscard]] Bundle bundle_around(const View& view, int width, int height, const PixelRect& rect);

}  // namespace ivory
