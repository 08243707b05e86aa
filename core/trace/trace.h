// The door to the tracer, for one ray and for those of a tile.
#pragma once

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/methods/method.h"
#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

// The first meeting of the ray with the surface, and the surface's normal and colour there.
// `list` has to be valid on this ray (all_elements, or the list of a tile that holds it).
// Does not throw; a bounded number of evaluations.
[[nodiscard]] Answer trace(const Field& field, const ElementList& list, const Ray& ray,
                           const Method& method, const MethodOptions& options, Counts& counts);

// Of each ray of a bundle, for which `list` has to be valid: one isolation, and unless `surfaces` is
// null what the surface is like at the midpoints of those that may be hits. What the list leaves
// open is traced against all elements: the last rung of core/trace/ladder.h. After a stop the
// answers say nothing.
void trace_bundle(const Field& field, const ElementList& list, const ElementList& all,
                  const RayBundle& rays, const Method& method, const MethodOptions& options,
                  BundleIsolations& isolations, BundleSurfaces* surfaces, Counts& counts);

}  // namespace ivory
