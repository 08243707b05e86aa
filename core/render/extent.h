// How far what is seen reaches: bounds of {f >= 0} along the normals of a picture's window.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "core/field/field.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "core/render/camera.h"

namespace ivory {

// The normals, outward, of the planes through the eye that bound the middle of the picture, and the
// two along the view:
//   p is within the window of half width k at distance 1 before the eye e
//       <=>  (p - e) . right <= k (p - e) . forward  and  -(p - e) . right <= k (p - e) . forward,
// which adds up to (p - e) . forward >= 0; likewise for top. Of an orthographic camera the planes are
// parallel in pairs, at the distance of the window's half width and height from its middle e:
//   p is within the window  <=>  (p - e) . right <= k s  and  -(p - e) . right <= k s,
// k for a picture two units high and s half the height of the picture.
enum Side : std::size_t { to_right, to_left, to_top, to_bottom, to_far, to_near, sides };

struct Frustum {
    Vec3d forward, right, top;
    double half_width = 0, half_height = 0;  // k, of right and of top
    bool is_parallel = false;                // of an orthographic camera
    std::array<Vec3d, sides> normal;
};

// Of the middle of a picture of those proportions: `share` of its width and height.
[[nodiscard]] Frustum frustum_of(const View& view, double aspect, double share);

using Reach = std::array<double, sides>;

// How far a thing reaches from `middle` along the normals, rounded up, and that it is within `radius`
// of it.
struct Extent {
    Reach reach{};
    Vec3d middle;
    double radius = 0;
};

[[nodiscard]] Extent extent_of(const Box3& box, const Frustum& frustum);

// What it took to find.
struct ExtentWork {
    std::size_t cells = 0, evaluations = 0;  // boxes looked at; of single elements and clusters
};

// Of the solid {f >= 0}: a function of field and frustum alone. Nothing: it is proved to be empty.
// The field's box must not be infinite.
[[nodiscard]] std::optional<Extent> extent_of_solid(const Field& field, const Frustum& frustum,
                                                    ExtentWork& work);

}  // namespace ivory
