// Root isolation: the first t with f(o + t d) = 0, proved.
//
// The search walks from the left. While f certainly has one sign on [0, t), it encloses f, f' and
// f'' over a window [t, t1] and takes the longest step that no root can hide in: the whole window
// where f stays away from 0, else up to the first zero of the line or the parabola that bounds f
// from its side of 0 (a safe step; the parabola makes it converge quadratically to a simple root,
// from the left). Windows shrink with the steps, so the bounds of f' and f'' tighten where they
// matter, and grow again where nothing is near.
//
// Canonical end: what is reported are neighbouring lines of a grid whose cell, a power of two, is
// fixed by tolerance and place alone: the last line where f certainly still has its sign, and the
// first after it where f certainly has the other. The root itself decides which these are, not the
// way it was found. A sign change proves that a root exists; that none came before is the walk's
// invariant.
#pragma once

#include "core/field/inclusion.h"
#include "core/trace/ray.h"

namespace ivory {

// How tight an answer has to be, in units of the ray's own t.
struct Precision {
    double cell;  // a power of two: half of the width that an enclosure may always have, > 0

    // The cell at t: never finer than 8 ulp(t), half of what the contract allows.
    [[nodiscard]] double cell_at(double t) const;
};

enum class Start : unsigned char {
    outside,  // f < 0 certainly holds on [0, span.lo)
    unknown   // span.lo = 0, and f(0) may have any sign
};

// The first root on the span, given that f < 0 beyond its end. hit: two cells wide at the most,
// four where rounding hides the sign on several grid lines (the caller checks the width).
// unresolved: the first root, if there is one, lies in t. Does not allocate or throw; at most
// `budget` + 4 evaluations (the last look around is finished).
[[nodiscard]] Isolation isolate_first_root(const FieldAlongRay& field, const Interval<double>& span,
                                           Start start, const Precision& precision, int budget,
                                           Counts& counts);

}  // namespace ivory
