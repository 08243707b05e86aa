// A bundle of rays from one origin, and the field on a window [begin, end] of their t: what no ray
// of the bundle can exceed there, found once and shared by all of them.
//
// For every ray origin + t d of the bundle, |d - axis| <= spread: so its point at t lies within
// t spread of the axis' point. The distance D to any closed set obeys D^2(x) = |x|^2 + (an infimum
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
// Long stretches are bounded for a wider bundle that several others are parts of (CommonBundle),
// each once, and then for each of these. Those of large scenes are bounded by clusters
// (core/field/clusters.h); shorter ones by elements, in float relative to their middle where the
// field suits that, else in double.
//
// Places are relative to the middle of the window on the axis, so that the digits are spent where
// the surface is, however far the origin: with M = origin + middle axis,
//     p(t) - M = middle (d - axis) + (t - middle) d,    c - M by core/math/offset.h.            (2)
// Lengths in the float stage are in units of `unit`, a power of two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/field/bundle_steps.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/interval/interval.h"
#include "core/math/cancellation.h"
#include "core/math/vec3.h"
#include "core/shape/bundle_entry.h"

namespace ivory {

// Rays origin + t d, t >= 0, with |d| and |axis| in 1 -+ 2^-50 and |d - axis| <= spread <= 1/2.
struct Bundle {
    Vec3d origin;
    Vec3d axis;
    double spread = 0;
};

// Some of a bundle's rays, which lie closer together, numbered as their owner likes; its own parts
// are others of the same array. Windows on which much is to be done are made for each part alone.
struct BundlePart {
    Vec3d axis;
    double spread = 0;
    std::uint32_t first = 0, end = 0;                // rays
    std::uint32_t first_part = 0, end_of_parts = 0;  // after this one in the array; none: equal
};

// A wider bundle, of the same origin, that others are parts of, and a list that is valid on it.
// What is bounded on long stretches of it is kept as long as `number` stays the same, and so shared
// by those who come one after another.
struct CommonBundle {
    Bundle bundle;
    const ElementList* list = nullptr;
    // Not 0; another one for each field, list and bundle, and for all else that `build` is given.
    std::uint64_t number = 0;
};

// Those of a bundle's rays, component by component; null: not told.
struct Directions {
    const double *x = nullptr, *y = nullptr, *z = nullptr;

    [[nodiscard]] Vec3d operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
};

// What bounds the sums of one stage, in units of its own: f = sum - T.
struct StageBounds {
    double above = 0, below = 0;  // f <= computed + above, f >= computed - below
    double slope = 0;             // |g' - computed|, g the sum over the fine entries
};

// The elements that a stage adds up, sorted by group.
template <class Real>
struct StageEntries {
    std::array<std::uint32_t, field_groups> count{};
    // Longer than there are entries: the memory is kept.
    std::vector<BundleEntry<Real>> entry;
    std::vector<std::uint32_t> element;  // index into Field
    std::size_t size = 0;

    [[nodiscard]] std::span<const std::uint32_t> elements() const { return {element.data(), size}; }
    void clear() {
        size = 0;
        count.fill(0);
    }
    // For so many more.
    void make_room(std::size_t more) {
        if (entry.size() >= size + more) return;
        entry.resize(2 * (size + more));
        element.resize(2 * (size + more));
    }
};

// One window, ready for the inner loops.
struct Window {
    double begin = 0, middle = 0, end = 0;  // t
    Vec3d axis;                             // of the bundle, or of the part it is made for
    float tau_begin = 0, tau_end = 0;       // (t - middle) / unit, outward

    // Bounds of f'' on the window: -fall <= f'' <= rise where f is smooth, per square of a scene
    // unit.
    double rise = 0, fall = 0;

    // p - c with p relative to the middle. The strong entries alone tell f < 0 where the surface is
    // far enough.
    StageEntries<float> strong, weak;
    StageBounds strong_bounds, coarse_bounds;  // of the strong ones, of both; per unit
    bool coarse_usable = false;

    // Once `complete` has been called for this window:
    bool is_complete = false;
    StageEntries<double> fine;  // likewise, in scene units
    StageEntries<float> faint;  // those of them that float is good enough for, as in `weak`
    StageBounds fine_bounds;    // of both, the slope computed of the first; per scene unit
    bool fine_usable = false;
    // `fine` has to be added up without losing what the sums are rounded by (Knuth's two-sum).
    bool compensated = false;
};

// The elements of a list as a bundle sees them. Reused from bundle to bundle: it keeps its memory.
class BundleField {
  public:
    // Where fewer elements matter, shorter lists for parts of the rays do not pay.
    static constexpr std::size_t parts_elements = 12;

    // `list` has to be valid on the bundle; `tolerance` decides how small an element has to be to
    // be left out; unless it `skips_windows`, none ends by the sum of peaks. Long stretches are
    // bounded for the `common` bundle, unless that is null, much wider than elements are or very
    // long, or elements are few. Once `stop`, unless null, is seen, no more stretches are bounded, as
    // if the budget were spent. False: numbers beyond what the bounds are proved for; nothing else
    // may be called.
    bool build(const Field& field, const ElementList& list, const Bundle& bundle, double tolerance,
               bool skips_windows = true, const CommonBundle* common = nullptr,
               Cancellation* stop = nullptr);

    // The t outside of which every ray is outside of the field's box, and so f < 0; empty: a miss.
    [[nodiscard]] Interval<double> span() const { return span_; }

    // Calls visit(window, part) for windows from front to back until it returns false; f < 0
    // certainly holds on the parts of span() between them. parts[0] is the bundle. Which windows
    // there are depends on field, lists, parts, common bundle and tolerance alone. Those that
    // wanted(part, begin, end) denies are passed over. If there are parts, each ray of one that has
    // none may be a part of its own, whose axis is that of the ray in `rays`. When `budget`
    // stretches of t have been bounded, one for all rays that is not `coarse_usable` and begins at
    // 0 is the last.
    template <class Wanted, class Visit>
    void for_windows(std::span<const BundlePart> parts, const Directions& rays,
                     const Wanted& wanted, int budget, const Visit& visit) {
        left_ = budget;
        parts_ = parts;
        rays_ = rays;
        if (is_empty(span_)) return;
        if (is_shared_) {
            descend_shared(0, wanted, visit);
        } else {
            root_ = &list_;
            home_ = parts[0];
            descend(0, parts[0], span_.lo, span_.hi, wanted, visit);
        }
    }

    // The fine stage of the window that is being visited, if it is not there yet.
    void complete(Window& window);

    // The window that is being visited, with a fine stage that leaves out next to nothing and
    // bounds of f'' for it. No coarse stage; `refined` has no faint entries either.
    const Window& refined();
    const Window& finer();

    // Likewise a piece of that window about t, for one of its rays alone: rounding is bounded there
    // by what the field is there. Good until the next one.
    const Window& closer(const Vec3d& direction, double t);

    // Bounded since `build`, and how many of them were ended by the sum of peaks.
    [[nodiscard]] std::uint64_t stretches() const { return stretches_; }
    [[nodiscard]] std::uint64_t stretches_ended() const { return stretches_ended_; }

    [[nodiscard]] double unit() const { return unit_; }
    // T, scaled by the power of two that all strengths are scaled by.
    [[nodiscard]] double threshold() const { return threshold_; }

  private:
    static constexpr std::size_t greatest_depth = 30;
    // Of the greatest width, or nearly: longer stretches are halved before anything else is asked.
    static constexpr double long_stretch = 4;
    // Common bundles are of no use where they are wider than so many units, since then many
    // elements are in reach that its parts cannot see; nor where they are longer than so many long
    // stretches, which a part would end by its own list.
    static constexpr double widest_common = 8, longest_common = 128;

    // The elements that matter on a stretch, and what the others can add.
    struct Bounded {
        bool in_clusters = false;  // `active` are clusters
        bool is_near = false;      // the elements are in `near`, not in `active`
        ActiveElements active;
        NearElements near;
        double near_middle = 0;  // the t on the bundle's axis that `near` is relative to
        double rest_above = 0, rest_below = 0;
        double rise = 0, fall = 0;
        double kinks = 0;  // upper bound of the |f'| of kinked elements

        [[nodiscard]] std::size_t size() const { return is_near ? near.size() : active.size(); }
    };

    // A stretch of the common bundle; in the order in which they came to be wanted.
    struct SharedStretch {
        double begin = 0, end = 0;
        std::size_t parent = 0;
        std::size_t first_half = 0;  // the second follows; 0: not halved (yet)
        bool is_bounded = false, is_ended = false;
        Bounded bounded;
    };

    // Float cannot name the ends of a stretch: what is bounded is so much longer.
    static double pad_of(double t0, double t1) { return 0x1p-20 * (t1 - t0); }
    [[nodiscard]] Stretch stretch(const BundlePart& part, double t0, double t1) const;
    [[nodiscard]] NearStretch near_stretch(const BundlePart& part, double middle, double t0,
                                           double t1) const;
    [[nodiscard]] Interval<double> span_of(const Bundle& bundle) const;
    void take_list(const ElementList& list, Bounded& bounded) const;
    void share(const CommonBundle& common);
    // False: f < 0 on all of [t0, t1] for every ray.
    bool bound(const Bounded& parent, Bounded& here, const BundlePart& part, double t0, double t1,
               bool in_clusters);
    bool bound(std::size_t depth, const BundlePart& part, double t0, double t1, bool in_clusters);
    void add_shared(double begin, double end, std::size_t parent);
    bool bound_shared(std::size_t index, bool halves);
    void halve_shared(std::size_t index);
    // Of the parent's those with |F| above `cut`; the others join what they could add. Clusters
    // stay clusters if that is wanted.
    PeakSums bound(const Stretch& on, double cut, const Bounded& parent, bool in_clusters,
                   Bounded& result);
    PeakSums bound_members(const BundlePart& part, double t0, double t1, double cut,
                           const Bounded& parent, Bounded& result);
    static void add_rest(const Bounded& parent, const PeakSums& peaks, std::size_t candidates,
                         double u, Bounded& result);
    void bend(const BundlePart& part, double t0, double t1, Bounded& bounded) const;
    void bend(const Stretch& on, Bounded& bounded) const;
    void complete(const Bounded& bounded, const BundlePart& part, const Stretch& on,
                  double faint_cut, Window& window);
    void take_finished(const Bounded& bounded, double faint_cut, Window& window);
    [[nodiscard]] bool splits(std::size_t depth, double t0, double t1) const;
    // It has no parts but its rays.
    [[nodiscard]] static bool has_single_rays(const BundlePart& part) {
        return part.first_part == part.end_of_parts;
    }
    [[nodiscard]] bool is_divisible(const BundlePart& part) const {
        return !has_single_rays(part) ||
               (parts_.size() > 1 && part.spread > 0 && rays_.x != nullptr);
    }
    [[nodiscard]] bool parts_differ(std::size_t depth, const BundlePart& part, double t0,
                                    double t1) const;
    void finish(std::size_t depth, const BundlePart& part, double t0, double t1);

    // None other is visited; it begins at 0.
    template <class Visit>
    bool give_up(const Visit& visit) {
        window_.coarse_usable = false;
        window_.begin = 0;
        visit(window_, parts_[0]);
        return false;
    }

    [[nodiscard]] bool is_divisible(std::size_t depth, double t0, double t1) const {
        const double middle = 0.5 * (t0 + t1);
        return middle > t0 && middle < t1 && depth < greatest_depth;
    }
    [[nodiscard]] bool is_long(double t0, double t1) const {
        return t1 - t0 > long_stretch * unit_;
    }

    [[nodiscard]] bool is_too_wide_at(double t) const {
        return t * home_.spread > widest_common * unit_;
    }

    // Long stretches of the common bundle, as far as this one needs them; and then its own.
    template <class Wanted, class Visit>
    bool descend_shared(std::size_t index, const Wanted& wanted, const Visit& visit,
                        std::size_t depth = 0) {
        const double t0 = shared_[index].begin, t1 = shared_[index].end;
        if (t1 < span_.lo || t0 > span_.hi || !wanted(parts_[0], t0, t1)) return true;
        if (is_too_wide_at(t0)) {  // the whole is not, or nothing is shared
            root_ = &shared_[shared_[index].parent].bounded;
            return descend(0, parts_[0], t0, t1, wanted, visit);
        }
        if (left_-- <= 0) return give_up(visit);
        const bool halves = is_divisible(depth, t0, t1) && is_long(t0, t1);
        if (!bound_shared(index, halves)) return true;
        if (halves) {
            halve_shared(index);
            const std::size_t first = shared_[index].first_half;
            return descend_shared(first, wanted, visit, depth + 1) &&
                   descend_shared(first + 1, wanted, visit, depth + 1);
        }
        root_ = &shared_[index].bounded;
        return descend(0, parts_[0], t0, t1, wanted, visit);
    }

    template <class Wanted, class Visit>
    bool descend(std::size_t depth, const BundlePart& part, double t0, double t1,
                 const Wanted& wanted, const Visit& visit) {
        const double pad = pad_of(t0, t1);
        if (!wanted(part, t0, t1)) return true;
        if (left_-- <= 0) return give_up(visit);
        const double middle = 0.5 * (t0 + t1);
        const bool divisible = is_divisible(depth, t0, t1);
        const bool halves = divisible && is_long(t0, t1);
        if (!bound(depth, part, t0 - pad, t1 + pad, halves)) return true;
        if (!halves) bend(part, t0 - pad, t1 + pad, bounded_by_depth_[depth]);
        const bool divides = halves || (divisible && splits(depth, t0, t1));
        const bool has_parts = depth < greatest_depth && is_divisible(part);
        // Where the rays are farther apart than the stretch is long, to halve it says less of each
        // of them than to part them.
        if (divides && !(has_parts && t1 * part.spread > t1 - t0)) {
            return descend(depth + 1, part, t0, middle, wanted, visit) &&
                   descend(depth + 1, part, middle, t1, wanted, visit);
        }
        if (has_parts && (divides || parts_differ(depth, part, t0, t1))) {
            if (has_single_rays(part)) {
                for (std::uint32_t k = part.first; k < part.end; ++k) {
                    const BundlePart ray{.axis = rays_[k], .first = k, .end = k + 1};
                    if (!descend(depth + 1, ray, t0, t1, wanted, visit)) return false;
                }
                return true;
            }
            for (std::uint32_t k = part.first_part; k < part.end_of_parts; ++k) {
                if (!descend(depth + 1, parts_[k], t0, t1, wanted, visit)) return false;
            }
            return true;
        }
        finish(depth, part, t0, t1);
        return visit(window_, part);
    }

    const Field* field_ = nullptr;
    Vec3d origin_;
    std::span<const BundlePart> parts_;
    Directions rays_;
    Bounded list_;
    // What is bounded is part of this: the list, or a stretch of the common bundle. Places are
    // relative to the axis of `home_`, which is that bundle, or the one that was built.
    const Bounded* root_ = nullptr;
    BundlePart home_;
    bool is_shared_ = false;
    std::uint64_t shared_number_ = 0;
    Bounded shared_list_;
    std::deque<SharedStretch> shared_;  // those beyond shared_count_ keep their memory
    std::size_t shared_count_ = 0;
    ActiveElements members_;  // of clusters, or of a window with a fine stage
    Bounded near_clusters_;
    std::vector<Bounded> bounded_by_depth_;
    std::size_t finished_depth_ = 0;
    Stretch finished_;  // of the window
    BundlePart finished_part_;
    Window window_;
    Bounded refined_bounded_, closer_bounded_;
    Window refined_, finer_, closer_;
    bool is_refined_ = false, is_finer_ = false;  // those are of the window
    Interval<double> span_ = Interval<double>::empty_set();
    double unit_ = 1, scale_ = 1, threshold_ = 1, least_width_ = 1;
    double fine_cut_ = 0, refined_cut_ = 0;
    int left_ = 0;  // of the budget
    Cancellation* stop_ = nullptr;
    bool skips_windows_ = true;
    std::uint64_t stretches_ = 0, stretches_ended_ = 0;
};

}  // namespace ivory
