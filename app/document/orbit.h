// Mouse -> camera, and scene <-> window. The state of the view is a Camera of the scene format and
// nothing else, so that what is saved is bit for bit what is seen. Everything here is a pure
// function.
#pragma once

#include <optional>

#include "app/platform/window_rect.h"
#include "core/math/box3.h"
#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace ivory {

// How a picture of `size` pixels is seen; places are relative to the picture's top left corner.
// The camera has to be a valid one, the size at least 1 x 1.
class Projection {
  public:
    Projection(const Camera& camera, WindowSize size);

    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] WindowSize size() const { return size_; }

    [[nodiscard]] bool is_orthographic() const { return camera_.is_orthographic(); }

    // Where a place of the scene is seen; nothing where it lies behind a perspective camera or in its
    // plane. An orthographic one's plane hides surface, but not what is drawn over the picture: that
    // can be grabbed wherever it is.
    // The centre of pixel (i, j) is (i + 0.5, j + 0.5), as in scene-format.md.
    [[nodiscard]] std::optional<WindowPoint> project(Vec3d place) const;
    // Through a place of the picture, with a unit direction: of a pixel's centre its primary ray but
    // for rounding.
    [[nodiscard]] Ray line_of_sight(WindowPoint at) const;
    // How far along its line of sight a place is, as PictureState::depth has it; < 0 before an
    // orthographic camera's plane.
    [[nodiscard]] double distance_to(Vec3d place) const;
    // Unit, from a place to where it is seen from: at the camera itself `back`.
    [[nodiscard]] Vec3d towards_eye(Vec3d place) const;
    // Length in the scene of one pixel at that place's depth, > 0.
    [[nodiscard]] double length_of_pixel(Vec3d place) const;
    // `place` moved by so many pixels in the plane through it that is parallel to the screen: it is
    // then seen so many pixels further right and down.
    [[nodiscard]] Vec3d moved(Vec3d place, double dx, double dy) const;
    // Axes of the picture: unit right, top and back.
    [[nodiscard]] Vec3d right() const { return right_; }
    [[nodiscard]] Vec3d top() const { return top_; }
    [[nodiscard]] Vec3d back() const { return back_; }

  private:
    Camera camera_;
    WindowSize size_;
    Vec3d right_, top_, back_;
    // So many pixels are a length of 1: at depth 1, or of an orthographic camera everywhere.
    double pixels_per_length_;
};

// Around the target by a drag of so many pixels: a whole turn is about the picture's height
// times 2. The horizon stays level (turntable about `up`), the poles are not crossed. From the view
// straight along the y axis the turntable is again the one about y.
[[nodiscard]] Camera orbited(const Projection& view, double dx, double dy);
// The place under the pointer, at the target's depth, follows a drag of so many pixels.
[[nodiscard]] Camera panned(const Projection& view, double dx, double dy);
// Nearer (steps > 0) or farther, the place under `at` at the target's depth staying where it is
// seen. Of an orthographic camera the height becomes less or more.
[[nodiscard]] Camera zoomed(const Projection& view, WindowPoint at, double steps);
// The same direction of view, so far away, or so high, that the sphere around the box fits the
// picture; an empty box counts as [-1, 1]^3.
[[nodiscard]] Camera framed(const Projection& view, const Box3& box);
// The same distance, height and direction of view, looking at another target.
[[nodiscard]] Camera centred(const Projection& view, Vec3d target);
// Along an axis of the scene (0 x, 1 y, 2 z), from its positive side or the opposite one.
[[nodiscard]] Camera along_axis(const Projection& view, int axis, bool opposite);
// In the other projection the place at the target is seen as large as it was: an orthographic height
// is what `fov` sees there, and a perspective camera's distance the one at which it sees that height.
[[nodiscard]] Camera in_projection(const Camera& camera, Camera::Projection projection);
// What is seen from top to bottom at the target, > 0.
[[nodiscard]] double seen_height(const Camera& camera);
// Whether all of the box lies behind the plane through the position across the view; of the empty
// box true.
[[nodiscard]] bool plane_is_before(const Camera& camera, const Box3& box);
// An orthographic camera whose plane the box reaches, or lies before, moved back along the view until
// it is well before it. What is seen stays the same but for the rounding of the rays, and for what the
// plane hid. Any other camera as it is.
[[nodiscard]] Camera with_plane_before(const Camera& camera, const Box3& box);

}  // namespace ivory
