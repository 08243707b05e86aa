// What the shapes' lines, outlines and covers share: rings, the ring that all within a distance of a
// skeleton is seen as, and balls that cover such a set.
#pragma once

#include <span>
#include <vector>

#include "app/shape/shape_in_hand.h"
#include "core/math/vec3.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// The circle of that radius about a centre, across a normal of any length but 0.
class Ring {
  public:
    Ring(const Vec3d& center, const Vec3d& normal, double radius);

    [[nodiscard]] Vec3d at(double angle) const;
    [[nodiscard]] const Vec3d& center() const { return center_; }
    [[nodiscard]] const Vec3d& normal() const { return n_; }  // unit
    [[nodiscard]] const Vec3d& first_axis() const { return e1_; }
    [[nodiscard]] const Vec3d& second_axis() const { return e2_; }
    [[nodiscard]] double radius() const { return radius_; }

  private:
    Vec3d center_, n_, e1_, e2_;  // unit vectors across each other
    double radius_;
};

// 65 places around it, the last the first again.
[[nodiscard]] SkeletonLine ring_line(const Ring& ring);

// Outlines as the view sees them: closed lines in the picture, exact but for being polygons. Empty
// where the camera is inside or some of it lies behind.
// Of the convex hull of balls:
[[nodiscard]] std::vector<PictureLine> hull_outline(const Projection& view,
                                                    std::span<const Ball> balls);
// of the disc within a ring, seen as the hull of balls around its rim:
[[nodiscard]] std::vector<PictureLine> disc_outline(const Projection& view, const Ring& rim,
                                                    double distance);
// of a tube around a ring, both its edges:
[[nodiscard]] std::vector<PictureLine> ring_outline(const Projection& view, const Ring& ring,
                                                    double distance);

// Into how many pieces a curve is cut for its cover: they are no longer than the distance, unless
// they would be too many.
[[nodiscard]] int pieces_to_cover(double curve_length, double distance);

// Balls that cover all points within `distance` of a curve; place(x) leads along it at one speed, x
// from 0 to 1. With half a piece's length added to their radii they reach from one to the next.
template <class Place>
void cover_curve(double curve_length, double distance, const Place& place,
                 std::vector<Ball>& balls) {
    const int pieces = pieces_to_cover(curve_length, distance);
    for (int i = 0; i < pieces; ++i)
        balls.push_back({place((i + 0.5) / pieces), distance + 0.5 * curve_length / pieces});
}

// Balls that cover all points within `distance` of the disc within a ring.
void cover_disc(const Ring& rim, double distance, std::vector<Ball>& balls);

}  // namespace ivory
