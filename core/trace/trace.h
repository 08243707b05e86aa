// One ray, one answer.
#pragma once

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/trace/methods/method.h"
#include "core/trace/ray.h"

namespace ivory {

// The first meeting of the ray with the surface, and the surface's normal and colour there.
// `list` has to be valid on this ray (all_elements, or the list of a tile that holds it).
// Does not throw; a bounded number of evaluations.
[[nodiscard]] Answer trace(const Field& field, const ElementList& list, const Ray& ray,
                           const Method& method, const MethodOptions& options, Counts& counts);

}  // namespace ivory
