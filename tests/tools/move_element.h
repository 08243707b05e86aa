// An element somewhere else.
#pragma once

#include "core/scene/scene.h"

namespace ivory::tools {

inline void move(Element& element, const Vec3d& by) {
    if (auto* point = std::get_if<PointSkeleton>(&element.skeleton)) {
        point->position = point->position + by;
    } else if (auto* segment = std::get_if<SegmentSkeleton>(&element.skeleton)) {
        segment->a = segment->a + by;
        segment->b = segment->b + by;
    } else if (auto* circle = std::get_if<CircleSkeleton>(&element.skeleton)) {
        circle->center = circle->center + by;
    }
}

}  // namespace ivory::tools
