// Mouse -> camera, and scene <-> window. The state of the view is a Camera of the scene format and
// nothing else, so that what is saved is bit for bit what is seen. Everything here is a pure
// function.
#pragma once

#include <optional>

#include "app/platform/window_rect.h"
#include "core/math/box3.h"
#include "core/scene/scene.h"

namespace ivory {

// How a picture of `size` pixels is seen; places are relative to the picture's top left corner.
// The camera has to be a valid one, the size at least 1 x 1.
class Projection {
  public:
    Projection(const Camera& camera, WindowSize size);

    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] WindowSize size() const { return size_; }

    // Where a place of the scene is seen; nothing where it lies behind the camera or in its plane.
    // The centre of pixel (i, j) is (i + 0.5, j + 0.5), as in scene-format.md.
    [[nodiscard]] std::optional<WindowPoint> project(Vec3d place) const;
    // The unit direction from the camera's position through a place of the picture.
    [[nodiscard]] Vec3d direction(WindowPoint at) const;
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
    double pixels_per_slope_;  // at depth 1 so many pixels are a length of 1
};

// Around the target by a drag of so many pixels: a whole turn is about the picture's height
// times 2. The horizon stays level (turntable about `up`), the poles are not crossed. From the view
// straight along the y axis the turntable is again the one about y.
[[nodiscard]] Camera orbited(const Projection& view, double dx, double dy);
// The place under the pointer, at the target's depth, follows a drag of so many pixels.
[[nodiscard]] Camera panned(const Projection& view, double dx, double dy);
// Nearer (steps > 0) or farther, the place under `at` at the target's depth staying where it is
// seen.
[[nodiscard]] Camera zoomed(const Projection& view, WindowPoint at, double steps);
// The same direction of view, so far away that the sphere around the box fits the picture; an empty
// box counts as [-1, 1]^3.
[[nodiscard]] Camera framed(const Projection& view, const Box3& box);
// The same distance and direction of view, looking at another target.
[[nodiscard]] Camera centred(const Projection& view, Vec3d target);
// Along an axis of the scene (0 x, 1 y, 2 z), from its positive side or the opposite one.
[[nodiscard]] Camera along_axis(const Projection& view, int axis, bool opposite);

}  // namespace ivory
