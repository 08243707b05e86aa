// The ways to intersect a ray, behind one interface; each stands in a small file of its own.
#pragma once

#include <span>
#include <string_view>

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/math/cancellation.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/footprint.h"
#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"
#include "core/trace/skipping.h"

namespace ivory {

struct MethodOptions {
    double tolerance = 1e-9;  // E, 1e-15 .. 0.1: widths in units of the nearest element's width
    double difference_delta =
        1e-5;  // central differences of the paper's normal, in units of the least width
    Skipping skipping = {};  // `lists` of the renderer and `proved`, all others of `proved`
};

class Method {
  public:
    virtual ~Method() = default;
    Method(const Method&) = delete;
    Method& operator=(const Method&) = delete;

    [[nodiscard]] virtual std::string_view name() const = 0;
    // One line for `ivory info --methods`: what its answers prove.
    [[nodiscard]] virtual std::string_view proves() const = 0;

    // The first root on the ray. `list` has to be valid on this ray. Thread-safe, does not throw.
    [[nodiscard]] virtual Isolation isolate(const Field& field, const ElementList& list,
                                            const Ray& ray, const MethodOptions& options,
                                            Counts& counts) const = 0;

    // Normal and colour at p(m). By default those of core/field/surface.h, analytic.
    [[nodiscard]] virtual SurfacePoint surface(const Field& field, const ElementList& list,
                                               const Ray& ray, double m,
                                               const MethodOptions& options) const;

    // The same for all rays of a bundle, for which `list` has to be valid, and may name clusters
    // (it may not for one ray): one isolation for each, and, unless `surfaces` is null, the surface
    // at the midpoints of those that may be hits.
    virtual void trace_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                              const MethodOptions& options, BundleIsolations& isolations,
                              BundleSurfaces* surfaces, Counts& counts) const;

    // Of rays that are the middles of pixels, in a bundle that holds all rays of these: hit and miss
    // where that is certain of all rays of the pixel (core/trace/footprint.h), and then how the middle
    // looks; unresolved where nothing is, as it is of methods that prove nothing.
    virtual void certify_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                                const Footprint& footprint, const MethodOptions& options,
                                BundleIsolations& isolations, BundleSurfaces& surfaces,
                                Counts& counts) const;

    // Normal and colour of each ray at its m; where that is not finite, they stay. Those that come
    // after a stop stay too.
    virtual void surface_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                                const MethodOptions& options, std::span<const double> m,
                                BundleSurfaces& surfaces, Cancellation& stop) const;

  protected:
    Method() = default;
};

// Those on the list that matter to the bundle's rays: for methods that trace them one by one.
[[nodiscard]] ElementList elements_for(const RayBundle& rays, const Field& field,
                                       const ElementList& list);

// -gradient / |gradient|; 0, 0, 0 for a gradient that is 0 or not finite.
[[nodiscard]] Vec3d outward_normal(const Vec3d& gradient);

// All methods, `proved` first. The pointers live as long as the program.
[[nodiscard]] std::span<const Method* const> methods();

// nullptr where there is none of that name.
[[nodiscard]] const Method* find_method(std::string_view name);

}  // namespace ivory
