// A proved Lipschitz constant of f along a ray. With d_i the distance to skeleton i, |dF_i / dd_i|
// is at most |b| max |k'(q)| / w over the q that the ray meets, and d_i itself changes by no more
// than the place does.
#pragma once

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/trace/clip.h"

namespace ivory {

// An upper bound of |d/dt f(p(t))| from the elements of the list, in units of 2^exponent; each
// counts with the steepest slope at its distance from the ray's line or farther.
[[nodiscard]] double lipschitz_bound(const Field& field, const ElementList& list,
                                     const ScaledRay& ray, int exponent);

// max |dk/dq| over [q, inf), rounded up.
[[nodiscard]] double steepest_beyond(KernelKind kind, double q);

}  // namespace ivory
