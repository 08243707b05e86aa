// A ray, and what can be said of its first meeting with the surface.
#pragma once

#include <cstdint>

#include "core/interval/interval.h"
#include "core/math/cancellation.h"
#include "core/math/vec3.h"
#include "core/trace/ladder.h"
#include "core/trace/skipping.h"

namespace ivory {

// p(t) = origin + t direction for t >= 0; the direction is not normalised, t is in units of
// |direction|.
struct Ray {
    Vec3d origin;
    Vec3d direction;
};

enum class Status : std::uint8_t {
    hit,           // t holds a root of f(p(t)), and f has none on [0, t.lo): proved
    miss,          // f has no root on [0, inf): proved
    unresolved,    // the first root, if there is one, lies in t
    claimed_hit,   // by a method that proves nothing of the kind
    claimed_miss,  // likewise
};

// Whether the ray meets the surface, or may: then t and the surface's normal and colour are given.
[[nodiscard]] constexpr bool possibly_hit(Status status) {
    return status != Status::miss && status != Status::claimed_miss;
}

struct Isolation {
    Status status = Status::unresolved;
    Interval<double> t{};  // in units of |direction|; empty on a miss and a claimed miss
};

// What the surface is like at p(m), m the midpoint of the isolated interval.
struct SurfacePoint {
    Vec3d normal;  // -grad f / |grad f|; 0, 0, 0 where the gradient is 0 or undefined
    Vec3d color;   // sum of color_i max(F_i, 0) / sum of max(F_i, 0), linear; 0 where no F_i > 0
};

struct Answer {
    Isolation isolation;
    SurfacePoint surface;
};

// Work done, for statistics, and whether to go on. Added up per thread.
struct Counts {
    std::uint64_t evaluations = 0;          // pairs of a ray and an interval that were enclosed
    std::uint64_t element_evaluations = 0;  // elements enclosed in them
    SkippingCounts skipping = {};
    Climbers climbers = {};
    Cancellation stop = {};  // each thread keeps its own

    // So many enclosures, of so many elements each. Whether to stop.
    bool add(std::uint64_t count, std::uint64_t elements) {
        evaluations += count;
        element_evaluations += count * elements;
        return stop.after(count * elements);
    }

    Counts& operator+=(const Counts& other) {
        evaluations += other.evaluations;
        element_evaluations += other.element_evaluations;
        skipping += other.skipping;
        climbers += other.climbers;
        return *this;
    }
};

}  // namespace ivory
