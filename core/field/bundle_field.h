// The field on a stretch [begin, end] of a bundle's t: what no ray of the bundle can exceed there,
// found once and shared by all of them. Which stretches there are, and which of them become windows,
// is the search's business (core/trace/descent.h).
//
// The point at t of a ray of the bundle lies within radius + t spread of the axis' point
// (core/field/bundle.h). The distance D to any closed set obeys D^2(x) = |x|^2 + (an infimum
// of affine functions of x): along a line D^2 - t^2 is concave. Hence, with L = end - begin and
// y = (t - begin) / L,
//     D^2(t) >= (1 - y) D^2(begin) + y D^2(end) - y (1 - y) L^2                               (1)
// for every skeleton, with equality for a point: two distances on the axis bound an element's field
// on the whole window. From the least s = (D / w)^2 come, for each element,
//     a bound of |F|; elements below a cut leave the list and join an interval that is kept;
//     bounds of f'' (for a window free of kinks; else of |f'|), as sup of k'' s'^2 + k' s'',
//         with s'^2 = 4 x^2 / w^2, x = away . d / w, x^2 <= s, and s'' = 2 / w^2 for a point;
//         2 a / w^2 for a segment, where x^2 <= a s, a <= 1 (a = 1 about its ends, the squared sine
//         of the angle between ray and segment along it); 2 / w^2 (1 - r rho'') for a circle,
//         0 <= rho'' <= 1 / rho;
//     bounds of the rounding errors of f and f', so that the inner loop carries none of them; where
//         an element is faint, those of float are small enough even for the fine stage.
// Lists of large scenes are bounded by clusters (core/field/clusters.h); on shorter stretches the
// elements are, in float relative to their middle where the field suits that, else in double.
//
// Places are relative to the middle of the window on the axis, so that the digits are spent where
// the surface is, however far the origin: with M = origin + middle axis,
//     p(t) - M = (o - origin) + middle (d - axis) + (t - middle) d,                              (2)
//     c - M by core/math/offset.h.
// Lengths in the float stage are in units of `unit`, a power of two.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/field/active_elements.h"
#include "core/field/bundle.h"
#include "core/field/bundle_steps.h"
#include "core/field/field.h"
#include "core/field/left_out.h"
#include "core/field/local_elements.h"
#include "core/field/support.h"
#include "core/field/window.h"
#include "core/interval/interval.h"
#include "core/math/cancellation.h"
#include "core/math/vec3.h"

namespace ivory {

// The elements that matter on a stretch, and what the others can add.
struct Bounded {
    bool in_clusters = false;  // `active` are clusters
    bool is_local = false;     // the elements are in `local`, not in `active`
    ActiveElements active;
    LocalElements local;
    double local_middle = 0;  // the t on the bundle's axis that `local` is relative to
    LeftOut left_out;
    double rise = 0, fall = 0;  // bounds of f'' and of -f'', once they were asked for
    double kinked_slope = 0;    // upper bound of the |f'| of kinked elements; likewise
    bool is_condensed = false;  // those bounds are of the polynomial
    Condensed condensed;

    [[nodiscard]] std::size_t size() const { return is_local ? local.size() : active.size(); }
};

// The elements of a list as a bundle sees them. Reused from bundle to bundle: it keeps its memory.
class BundleField {
  public:
    // `list` has to be valid on the bundle, on whose axis places in float are measured; `tolerance`
    // decides how small an element has to be to be left out; unless it `skips_windows`, no stretch
    // ends by the sum of peaks. False: numbers beyond what the bounds are proved for; nothing else
    // may be called.
    bool build(const Field& field, const ElementList& list, const Bundle& bundle, double tolerance,
               bool skips_windows, Cancellation* stop);
    // Places in float are measured on another bundle's axis. Where elements are crowded windows are
    // `condensed`, so that what little many of them add may be left to the fine stage.
    void begin(const BundlePart& home, bool condenses) {
        home_ = home;
        condenses_ = condenses;
    }

    // The t outside of which every ray of the bundle is outside of the field's box, and so f < 0;
    // empty: a miss.
    [[nodiscard]] Interval<double> span_of(const Bundle& bundle) const;

    // The list, of which nothing is known yet.
    [[nodiscard]] const Bounded& list() const { return list_; }
    void take_list(const ElementList& list, Bounded& bounded) const;

    // Of the parent's elements those that matter on [t0, t1] for the part's rays; clusters stay
    // clusters if that is wanted. False: f < 0 on all of it for every ray.
    bool bound(const Bounded& parent, Bounded& here, const BundlePart& part, double t0, double t1,
               bool in_clusters);
    // And its f''.
    void bound_curvature(const BundlePart& part, double t0, double t1, Bounded& bounded);
    // Whether elements are so many, and such, that their polynomial is worth more than they are, and wanted.
    [[nodiscard]] bool is_crowded(const Bounded& bounded) const;
    // That of the window [t0, t1], a rough one, and by it its f''; `may_part` if the part's rays are divided
    // further.
    [[nodiscard]] Condensing condense(const BundlePart& part, double t0, double t1, bool may_part,
                                      Bounded& bounded) const;
    // Whether f < 0 on all of it, by the polynomial.
    [[nodiscard]] bool is_below(const Bounded& condensed) const;
    // Whether a window so long would need more steps than two of half the length.
    [[nodiscard]] bool is_too_curved(const Bounded& bounded, double length) const;

    // And how it changes across the rays, per scene unit and its square.
    [[nodiscard]] AcrossSums bound_across(const BundlePart& part, double t0, double t1,
                                          const Bounded& bounded) const;
    // The same of the window that is open, from the stretch that it was bounded on: what is kinked there is
    // kinked here.
    [[nodiscard]] AcrossSums bound_across() const {
        const double pad = pad_of(opened_on_.begin, opened_on_.end);
        return bound_across(opened_part_, opened_on_.begin - pad, opened_on_.end + pad, *opened_);
    }

    // The window of what was bounded so, which stays where it is.
    Window& open(const Bounded& bounded, const BundlePart& part, double t0, double t1);
    // One on which nothing is known, and which begins at 0.
    Window& open_unknown();

    // The window that is open with a close polynomial instead of the rough one; it is not usable where there is
    // none.
    void condense_closely(Window& window);
    // The coarse entries of the window that is open, which is condensed: to be looked at.
    void enter(Window& window);

    // The fine stage of the window that is open, if it is not there yet.
    void complete(Window& window);

    // The window that is open, with a fine stage that leaves out next to nothing and bounds of f''
    // for it. No coarse stage; `full` has none in float either. A condensed window has no other.
    const Window& full();
    const Window& full_mixed();
    // Its own elements, all in double. No coarse stage; a condensed window has but the full one.
    const Window& in_double();

    // Likewise a piece of that window about t, for one of its rays alone: rounding is bounded there
    // by what the field is there. Good until the next one.
    const Window& about_root(const Vec3d& origin, const Vec3d& direction, double t);

    // Float cannot name the ends of a stretch: what is bounded is so much longer.
    static double pad_of(double t0, double t1) { return 0x1p-20 * (t1 - t0); }
    // Of the greatest width, or nearly.
    [[nodiscard]] bool is_long(double t0, double t1) const {
        return t1 - t0 > long_stretch * unit_;
    }
    static constexpr double long_stretch = 4;  // units

    // The condensed window that is open for one of its rays alone, condensed along it, in double; null: it
    // cannot be. Good until the next one.
    const Window* along(const Vec3d& origin, const Vec3d& direction);

    // Whether the stop has been seen since `build`.
    [[nodiscard]] bool is_stopped() const { return is_stopped_; }
    // Bounded since `build`, and how many of them were ended by the sum of peaks.
    [[nodiscard]] std::uint64_t stretches() const { return stretches_; }
    [[nodiscard]] std::uint64_t stretches_ended() const { return stretches_ended_; }

    [[nodiscard]] std::size_t size() const { return field_->size(); }
    [[nodiscard]] double unit() const { return unit_; }
    // T, scaled by the power of two that all strengths are scaled by.
    [[nodiscard]] double threshold() const { return threshold_; }

  private:
    // Which elements of a fine stage are added up in float: those with |F| at most `greatest`, or if these are
    // off by more than `worst` in all, less, down to `least`.
    struct FloatCuts {
        double greatest, least, worst;
    };
    [[nodiscard]] static FloatCuts float_cuts(double cut);
    static constexpr FloatCuts all_in_double{-1, -1, 0};

    [[nodiscard]] Stretch stretch(const BundlePart& part, double t0, double t1) const;
    [[nodiscard]] LocalStretch local_stretch(const BundlePart& part, double middle, double t0,
                                             double t1) const;
    // Of the parent's those with |F| above `cut`; the others join what they could add.
    PeakSums bound(const Stretch& on, double cut, const Bounded& parent, bool in_clusters,
                   Bounded& result);
    PeakSums bound_members(const BundlePart& part, double t0, double t1, double cut,
                           const Bounded& parent, Bounded& result);
    void bound_curvature(const Stretch& on, Bounded& bounded);
    void enter(const Bounded& bounded, const BundlePart& part, Window& window);
    void complete(const Bounded& bounded, const BundlePart& part, const Stretch& on,
                  const FloatCuts& float_cuts, Window& window);
    void bound_opened(double cut, Bounded& finer);
    void bound_opened_curvature(Bounded& finer);
    void take_opened(const Bounded& bounded, const FloatCuts& float_cuts, Window& window);

    const Field* field_ = nullptr;
    BundlePart home_;
    Bounded list_;
    BothFeet<double> feet_;
    BothFeet<float> feet_in_float_;
    ActiveElements members_;  // of clusters, or of a window with a fine stage
    Bounded full_clusters_;

    // The window's bounds of what was condensed.
    void take_condensed(const Bounded& here, const Condensed& condensed, Window& window) const;

    const Bounded* opened_ = nullptr;  // what the window is of
    Stretch opened_on_;
    bool opened_condensed_ = false;
    BundlePart opened_part_;
    Window window_;
    Bounded full_bounded_, about_root_bounded_;
    Window full_, full_mixed_, in_double_, about_root_;
    Bounded along_bounded_;
    Condensed close_;
    CondensedRay condensed_ray_;
    bool has_full_ = false, has_full_mixed_ = false, has_in_double_ = false,
         has_along_ = false;  // those are of the window

    double unit_ = 1, scale_ = 1, threshold_ = 1, least_width_ = 1;
    double fine_cut_ = 0, full_cut_ = 0;
    Cancellation* stop_ = nullptr;
    bool is_stopped_ = false;
    bool skips_windows_ = true, condenses_ = false;
    std::uint64_t stretches_ = 0, stretches_ended_ = 0;
};

}  // namespace ivory
