// Places of a skeleton of any shape.
#pragma once

#include <cmath>
#include <variant>

#include "core/shape/shapes.h"
#include "tests/tools/random_scene.h"

namespace ivory::tools {

// The place of the skeleton that is nearest to p, to nearest.
inline Vec3d nearest_place(const Skeleton& skeleton, const Vec3d& p) {
    return std::visit(
        [&]<class S>(const S& s) {
            double least = infinity<double>;
            Vec3d place;
            for (const SkeletonPart& part : parts_of(s)) {
                const SkeletonColumns columns = part.seen();
                const Nearest at = S::nearest(columns, p - columns.a, 1);
                if (at.s < least) place = p - at.away;
                least = std::min(least, at.s);
            }
            return place;
        },
        skeleton);
}

// Any place of the skeleton, its ends often.
inline Vec3d on_skeleton(const Skeleton& skeleton, Random& random) {
    const Ball ball = std::visit(
        [&]<class S>(const S& s) {
            const std::vector<SkeletonPart> parts = parts_of(s);
            return S::ball(parts[random.below(parts.size())].seen());
        },
        skeleton);
    return nearest_place(skeleton, ball.center + random.in_cube(2 * ball.radius));
}

}  // namespace ivory::tools
