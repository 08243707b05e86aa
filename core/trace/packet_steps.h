// The inner loops of the packet tracer, in SIMD: one body for all instruction sets, the best one
// that the machine has chosen at run time (Google Highway).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/field/bundle.h"
#include "core/field/field.h"
#include "core/field/window.h"
#include "core/interval/interval.h"
#include "core/math/cancellation.h"
#include "core/math/vec3.h"
#include "core/trace/bundle_isolations.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/footprint.h"
#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

// The rays of a bundle and what is known of them, as structure of arrays.
struct Lanes {
    static constexpr std::size_t room = RayBundle::room;  // the last vector is read whole

    enum State : std::int32_t {
        walking,    // f < 0 on [0, t) so far
        candidate,  // and, in this window, g rises from there to a root near t
        hit,        // done: t_lo, t_hi
        hidden,     // what the fine list leaves out hides on which side of a grid line the root is
        doubtful,   // float cannot decide on what happens in this window
        undecided,  // to be traced by other means from t_lo on: f < 0 up to there; the first root
                    // lies before t_hi, where that is finite
        entering,   // of the middle of a pixel: on the way in (EnteringRays)
        unused,
    };

    std::size_t count = 0;
    RayColumns rays;  // arrays with that room; likewise where the answers go
    double *t_lo = nullptr, *t_hi = nullptr;
    alignas(64) std::array<float, room> fx, fy, fz;  // the directions, rounded
    alignas(64) std::array<std::int32_t, room> state;
    alignas(64) std::array<double, room> t;  // of a candidate; of a hit the midpoint
};

// Of lanes on their way in from one window to the next: no ray of the pixel has a root before the middle's
// came near; up to `end`, the last window's, not all of them were certainly inside.
struct EnteringRays {
    static constexpr std::size_t room = RayBundle::room;
    std::array<double, room> end;
    std::array<std::uint8_t, room> seen;     // the middle's root is behind, and has been looked at
    std::array<std::uint8_t, room> pending;  // see PacketSteps::certify
};

// How many lanes were to be looked at, and of how many the surface is known now.
struct SeenSurfaces {
    std::size_t wanted = 0, known = 0;
};

// Pairs of a lane and a step, and those of them that the weak entries took part in.
struct Walked {
    std::uint64_t steps = 0, close_steps = 0;
};

// Whoever is given a stop leaves the lanes as they are once it is seen: their states then say
// nothing.
struct PacketSteps {
    // `count` and `rays` stand; fills fx, fy, fz. State: walking.
    void (*prepare)(Lanes& lanes);

    // Whether any of the lanes first .. end is in that state.
    bool (*any)(const Lanes& lanes, Lanes::State state, std::size_t first, std::size_t end);

    // Safe steps of every walking lane of first .. end from the window's begin to its end, in
    // float: lanes that come to a root become candidates, so close to it that `enclose` on cells of
    // that length hardly ever needs a second step; those that float cannot decide become doubtful.
    Walked (*walk)(const Window& window, double threshold, double unit, double cell,
                   std::size_t first, std::size_t end, Lanes& lanes, Cancellation& stop);

    // The same in double, from the window's begin, for the doubtful ones: they become candidates,
    // walk on or are undecided. The window has no fine entries in float. Counts pairs of a lane and a step.
    std::uint64_t (*walk_again)(const Window& window, double threshold, std::size_t first,
                                std::size_t end, Lanes& lanes, Cancellation& stop);

    // Encloses the candidates' roots, of lanes first .. end, in double, on the grid whose cell is
    // the greatest power of two below `half_width` / |d| in the units of core/trace/isolate.h: they
    // become hits; or `pinned` where the root lies in t_lo .. t_hi but a grid line does too; or
    // `otherwise`. For a refined window `left_out` is what the elements that it has more than the
    // window of the walk add to f or take away, at most; for a piece of it about one ray, the most
    // that either of these two leaves out.
    std::uint64_t (*enclose)(const Window& window, double threshold, double unit, double half_width,
                             double left_out, std::size_t first, std::size_t end,
                             Lanes::State pinned, Lanes::State otherwise, Lanes& lanes,
                             Cancellation& stop);

    // Of walking and entering lanes, each the middle of a pixel (core/trace/footprint.h): those whose pixel
    // is certainly hit become hits, t about the middle's root; those that nothing is certain of are
    // undecided. What comes to the window's end on the way in becomes a hit too if its root lies in
    // the window, to be looked at, and is `pending`: it is entering afterwards. Counts pairs of a lane and a
    // step.
    std::uint64_t (*certify)(const Window& window, const FootprintBounds& bounds, double threshold,
                             double unit, std::size_t first, std::size_t end, Lanes& lanes,
                             EnteringRays& entering, Cancellation& stop);

    // Normal and colour of those hits of first .. end whose t lies in the window and below `limit`,
    // in float: within 2^-8, or nx = NaN where float might lose more.
    SeenSurfaces (*look)(const Window& window, const Field& field, double unit, double limit,
                         const Lanes& lanes, std::size_t first, std::size_t end,
                         BundleSurfaces& surfaces, Cancellation& stop);

    // surface[k]: normal and colour at t of lane index[k], which lies in the window. Where the gradient
    // is 0 or not defined, or no F_i is above 0, the normal's x is NaN.
    void (*surface)(const Window& window, const Field& field, const Lanes& lanes,
                    std::span<const std::uint32_t> index, SurfacePoint* surface,
                    Cancellation& stop);

    // Those that still walk are misses, the others hits or unresolved.
    void (*conclude)(const Lanes& lanes, BundleIsolations& isolations);
};

// For this machine.
[[nodiscard]] const PacketSteps& packet_steps();

}  // namespace ivory
