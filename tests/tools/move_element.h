// An element somewhere else.
#pragma once

#include "core/scene/scene.h"
#include "tests/tools/kinds.h"

namespace ivory::tools {

inline void move(Element& element, const Vec3d& by) {
    for (Vec3d* const place : Members(element.skeleton).places) *place = *place + by;
}

}  // namespace ivory::tools
