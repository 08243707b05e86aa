// What an answer says of a ray's first meeting with the surface: a line of `ivory trace`.
#pragma once

#include "core/math/vec3.h"

namespace ivory::reference {

struct Claim {
    enum class Status { hit, miss, unresolved, claimed_hit, claimed_miss };

    Status status = Status::unresolved;
    double lo = 0, hi = 0;  // the bracket, of what is no miss
    Vec3d normal{}, color{};
};

}  // namespace ivory::reference
