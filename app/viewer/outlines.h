// Lines of the scene that the overlay draws and a click can hit: the skeletons, and the outline of
// an element's own iso-surface F_i = T, the ring that it would be seen as if it were alone.
#pragma once

#include <vector>

#include "app/document/orbit.h"
#include "core/scene/scene.h"

namespace ivory {

// The skeleton as a line through places of the scene: one for a point, two for a segment, 65 around
// a circle, the last the first again.
[[nodiscard]] std::vector<Vec3d> skeleton_line(const Skeleton& skeleton);

// The distance from the skeleton where the element alone reaches the threshold, F_i = T, to about
// 1e-12 of its width; -1 where its field stays below T everywhere.
[[nodiscard]] double iso_distance(const Element& element, double threshold);

// The outline, as the view sees it, of all places within `distance` of the skeleton: closed lines
// in the picture, exact but for being polygons. Of a circle both edges of the tube. Empty where the
// camera is inside or some of it lies behind.
[[nodiscard]] std::vector<std::vector<WindowPoint>> tube_outline(const Projection& view,
                                                                 const Skeleton& skeleton,
                                                                 double distance);

}  // namespace ivory
