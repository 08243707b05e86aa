// Many rays at a time: windows of a bundle (core/trace/descent.h) from front to back, in each of
// them safe steps in float and the enclosure of the root in double (core/trace/packet_steps.h).
//
// The proof of a hit: f < 0 on every window before, by the sum of upper bounds or by safe steps,
// and in its own up to a place from which g = f - (what is left out) rises; there a line above f is
// below 0 up to one grid line and a line below f above 0 from the next one on. The two grid lines
// are the canonical end of core/trace/isolate.h: those between which the first root lies, however
// it was found. Each ray's steps depend on the windows and on itself alone, not on its neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/descent.h"
#include "core/trace/packet_steps.h"
#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

// Reused from bundle to bundle; one for each thread.
class PacketTracer {
  public:
    struct Settings {
        double tolerance;      // E
        double greatest_cell;  // of the grid, a length
        Skipping skipping = {};
    };

    // hit and miss are proved; unresolved says that the ray has to be traced by other means: f < 0
    // on [0, t.lo), and where t.hi is finite the first root lies before it. After a stop all are. `list` has
    // to be valid on the bundle. Unless `surfaces` is null it gets what `surface` would give for the hits'
    // midpoints; returns of how many it has found it.
    std::size_t isolate(const Field& field, const ElementList& list, const RayBundle& rays,
                        const Settings& settings, BundleIsolations& isolations,
                        BundleSurfaces* surfaces, Counts& counts);

    // Rays that are the middles of pixels, in a bundle that holds all rays of these pixels: hit and miss
    // are proved of all rays of the pixel, t being about the middle's root; unresolved says no more than
    // that. `surfaces` as in `isolate`.
    void certify(const Field& field, const ElementList& list, const RayBundle& rays,
                 const Footprint& footprint, const Settings& settings, BundleIsolations& isolations,
                 BundleSurfaces& surfaces, Counts& counts);

    // Normal and colour at m[k] of ray k, where that is finite; the others stay. Those that are not
    // `found` then have to be found by other means.
    void surface(const Field& field, const ElementList& list, const RayBundle& rays,
                 double tolerance, std::span<const double> m, BundleSurfaces& surfaces,
                 Cancellation& stop);

  private:
    // What the rungs of the ladder (core/trace/ladder.h) in a window work on.
    struct Job {
        const Field& field;
        const Settings& settings;
        BundleSurfaces* surfaces;
        double surface_limit;  // t from which places are not close enough for normals and colours
        Counts& counts;
    };

    void take(const RayBundle& rays, bool in_parts);
    [[nodiscard]] bool any(const BundlePart& part, Lanes::State state) const;
    void replace(const BundlePart& part, Lanes::State state, Lanes::State by);

    // Rungs for the rays of the part in that window. False: stopped on the way.
    bool climb(Window& window, const BundlePart& part, Job& job);
    void walk(const Window& window, const BundlePart& part, Job& job);
    void enclose(const Window& window, const BundlePart& part, Job& job);
    void enclose_condensed(const Window& window, const BundlePart& part, Job& job);
    void enclose_more(const Window& window, const BundlePart& part, Job& job);
    void about_roots(double left_out, const BundlePart& part, Job& job);
    const Window* condensed_along(std::size_t k, const BundlePart& part);
    void walk_along(const BundlePart& part, Job& job);
    void walk_again(const BundlePart& part, Job& job);
    // All of the part that walk are left to others, from the window on.
    void leave(const Window& window, const BundlePart& part);
    // As PacketSteps::enclose.
    void enclose_lanes(const Window& in, double left_out, std::size_t first, std::size_t end,
                       Lanes::State pinned, Lanes::State otherwise, Job& job);

    std::size_t surface_in(Window& window, const BundlePart& part, const Field& field, double limit,
                           BundleSurfaces& surfaces, Cancellation& stop);

    Descent descent_;
    Lanes lanes_;
    EnteringRays entering_;
    std::vector<BundlePart> parts_;
    std::vector<std::uint32_t> index_;  // of hits in a window, and what is found there
    std::vector<SurfacePoint> points_;
};

}  // namespace ivory
