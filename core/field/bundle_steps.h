// What elements can do on a stretch of a bundle, in SIMD over the elements: one body for all
// instruction sets, the best one that the machine has chosen at run time (Google Highway).
//
// Numbers are computed to nearest; each result that has to bound something is moved by 2^-46 (in
// float by 2^-17) of the magnitudes that entered it, and no chain of operations here is longer than
// some 40 roundings. Where a machine fuses products with sums there are fewer. Sums of bounds have
// to be widened by whoever uses them.
#pragma once

#include <cstddef>
#include <vector>

#include "core/field/active_elements.h"
#include "core/field/condensed.h"
#include "core/field/field.h"
#include "core/field/local_elements.h"
#include "core/math/vec3.h"

namespace ivory {

struct Window;

// All points o + t d of a bundle's rays (core/field/bundle.h) with begin <= t <= end.
struct Stretch {
    Vec3d origin, axis;
    double spread = 0;  // >= |d - axis|
    double radius = 0;  // >= |o - origin|
    double begin = 0, end = 0;
};

// The same in units of some length, relative to the place at t = t_offset on the bundle's axis: the
// points base + tau axis, and what is at most radius + spread (tau + t_offset) away from them.
struct LocalStretch {
    Vec3d axis, base;
    double spread = 0, radius = 0;
    double begin = 0, end = 0;  // tau
    double t_offset = 0;
};

// Sums over elements, as computed.
struct PeakSums {
    double above = 0, magnitude = 0;                // of the kept ones: peaks above 0, all peaks
    double left_out_above = 0, left_out_below = 0;  // what those left out can add and take away
};

struct CurvatureSums {
    double rise = 0, fall = 0;  // of bounds of f'' and of -f''
    double kinked_slope = 0;    // and of |f'| of the elements whose f'' has none
};

// How the field changes across the rays of a bundle, for rays close together: over all places of the
// bundle and all directions.
struct AcrossSums {
    double curvature = 0;     // of bounds of the second derivatives, of elements that have them
    double joined_slope = 0;  // of bounds of |grad F| of joined elements
};

// Of |F|: what may be above the first enters a window among the strong entries, else what may be
// above the second among the weak ones.
struct CoarseCuts {
    double strong = 0, weak = 0;
};

// For one stage of a window: sums over its entries and over what that stage leaves out.
struct StageSums {
    double error = 0, slope = 0;  // of what rounding does to |F| and |F'|, and left-out |F'|
    double magnitude = 0;         // of the peaks
    double left_out_above = 0, left_out_below = 0;
    double full_slope = 0;  // of bounds of |F'| of all elements
    // Of the weak entries: what they can add and take away, and of bounds of their |F'|.
    double weak_above = 0, weak_below = 0, weak_slope = 0;
    bool usable = true;
};

// Where parts of elements are nearest, side by side (core/field/nearest_parts.inl); memory that is kept.
template <class Real>
struct PartFeet {
    std::vector<Real> x, y, z, least, most;
    std::vector<Real> at, q, pull, lower, halved;  // of what is narrowed down
    void make_room(std::size_t count) {
        if (x.size() >= count + LocalElements::room) return;
        for (auto* column : {&x, &y, &z, &least, &most, &at, &q, &pull, &lower, &halved}) {
            column->resize(count + count / 2 + LocalElements::room);
        }
    }
};

template <class Real>
struct BothFeet {
    PartFeet<Real> feet, second;
    GroupStarts before;  // of the list
};

struct BundleSteps {
    // Of the `candidates` those with |F| possibly above `cut` (of strengths times `scale`).
    PeakSums (*bound)(const Field& field, const Stretch& stretch, double scale, double cut,
                      const ActiveElements& candidates, ActiveElements& kept);

    // The same of clusters: indices into Field::clusters, of which nothing but `element` is set.
    PeakSums (*bound_clusters)(const Field& field, const Stretch& stretch, double scale, double cut,
                               const ActiveElements& candidates, ActiveElements& kept);

    // Of joined elements, bounded on the stretch, the parts that may be the nearest there stay.
    void (*keep_nearest_parts)(const Field& field, const Stretch& stretch, double scale,
                               ActiveElements& active, BothFeet<double>& feet);
    void (*keep_nearest_parts_local)(LocalElements& near, const LocalStretch& stretch,
                                     BothFeet<float>& feet);

    // Bounds of the elements' f'' on the stretch that they were bounded on; sets `inverse`.
    CurvatureSums (*bound_curvature)(const Field& field, const Stretch& stretch, double scale,
                                     ActiveElements& active);

    // Bounds across the rays, of the elements on the stretch that they were bounded on. What is neither
    // smooth nor joined is in StageSums::slope.
    AcrossSums (*bound_across)(const Field& field, const Stretch& stretch, double scale,
                               const ActiveElements& active);

    // Those elements with their bounds, in units (Field::unit), relative to the place at `middle`
    // on the axis of the `bundle`, not of one of its parts.
    void (*enter_local)(const Field& field, const Stretch& bundle, double middle,
                        const ActiveElements& active, LocalElements& near);

    // Their places anew, without what they were off by, relative to the place at another `middle`.
    void (*place_local)(const Field& field, const Stretch& bundle, double middle,
                        LocalElements& near);

    // The members of clusters with |F| possibly above `cut`, likewise; `bundle` has the bundle's
    // origin and axis. Without `kept` only the sums.
    PeakSums (*bound_members)(const Field& field, const Stretch& bundle, double middle,
                              const LocalStretch& stretch, double cut,
                              const ActiveElements& clusters, LocalElements* kept);

    // `bound` and `bend` of them, in float and in their units.
    PeakSums (*bound_local)(const LocalElements& candidates, const LocalStretch& stretch,
                            double cut, LocalElements& kept);
    CurvatureSums (*bound_curvature_local)(LocalElements& near, const LocalStretch& stretch);
    AcrossSums (*bound_across_local)(const LocalElements& near, const LocalStretch& stretch);

    // The elements, all points with Blinn's kernel, as one polynomial about the place at `middle`, that of the
    // window `stretch`, relative to the same place as they are. `may_part`: the window has parts that are
    // narrower. One that is too large for a close polynomial is so for a rough one.
    Condensing (*condense)(const LocalElements& near, const LocalStretch& stretch, double middle,
                           double threshold, bool may_part, Closeness closeness,
                           Condensed& condensed);

    // And along the ray from `origin` on, |direction| = 1 within 2^-50, between `begin` and `end`; `near` are
    // bounded there. False: they are too narrow, or the window too long.
    bool (*condense_ray)(const Field& field, const LocalElements& near, const Vec3d& origin,
                         const Vec3d& direction, double begin, double end, double scale,
                         double threshold, CondensedRay& condensed);

    // The window's coarse entries, in units.
    StageSums (*coarse)(const Field& field, const Stretch& stretch, double scale,
                        const CoarseCuts& cuts, const ActiveElements& active, Window& window);
    // The same, in float, and so are the sums. `stretch` is that of the window, relative to the
    // same place as the elements.
    StageSums (*coarse_local)(const Field& field, const LocalElements& near,
                              const LocalStretch& stretch, double middle, const CoarseCuts& cuts,
                              Window& window);

    // The window's fine entries: all.
    StageSums (*fine)(const Field& field, const Stretch& stretch, double scale,
                      const ActiveElements& active, Window& window);
    // Parts elements in float: those with |F| certainly at most `cut` become the window's
    // entries, in units, the others join `others`.
    StageSums (*fine_in_float)(const Field& field, const LocalElements& near,
                               const LocalStretch& stretch, double middle, double unit, double cut,
                               Window& window, ActiveElements& others);
};

// For this machine.
[[nodiscard]] const BundleSteps& bundle_steps();

}  // namespace ivory
