// The stages of a bundle's windows (core/field/window.h): which elements each of them adds up, in which
// arithmetic, and what bounds it.
#include <algorithm>
#include <bit>

#include "core/field/bundle_field.h"

namespace ivory {
namespace {

constexpr double more = 1 + 0x1p-46;  // as in core/field/bundle_steps.h

constexpr double strong_cut_share = 0x1p-8, coarse_cut_share = 0x1p-20;  // of T
// Elements below this multiple of the fine cut are added up in float: in crowds what they lose there is
// a fraction of what those below the fine cut leave open.
constexpr double float_cut_multiple = 0x1p13;
// Unless what float loses of them all is more than this share of that cut: places may be rough.
constexpr double worst_float_share = 0x1p-6;
// The multiple for windows that leave out next to nothing.
constexpr double full_mixed_cut_multiple = 0x1p-3;
// Where a condensed window's roots are enclosed elements below this multiple are left out, the sum of what many
// leave out being far more than what each does. And there the cut of those in float is lowered by steps until float
// loses no more than that multiple.
constexpr double crowd_fine_cut_multiple = 0x1p-6;
constexpr double next_float_cut = 0x1p-3, worst_in_crowd = 8;

// In least widths: as long as the shortest windows, and what elements can be there hardly differs
// from what they are.
constexpr double about_root_reach = 0x1p-6;

}  // namespace

namespace {

// Roundings that a sum of so many entries takes part in.
double roundings(std::size_t entries) { return static_cast<double>(entries + 4); }

// Of the fine entries in float, of which some are added up first.
double roundings_in_float(const StageEntries<float>& stage) {
    std::size_t longest = 0, sums = 0;
    for (std::uint64_t left = stage.present; left != 0; left &= left - 1) {
        const auto group = static_cast<std::size_t>(std::countr_zero(left));
        const std::size_t count = stage.count[group];
        longest = std::max(longest, count);
        sums += 1 + count / float_sum_length;
    }
    return roundings(std::min<std::size_t>(longest, float_sum_length) + sums);
}

// Of a compensated sum: each product's own, the last one's, and that of adding the faint entries;
// what is carried along is rounded by u^2 alone.
constexpr double compensated_roundings = 3;

// With u the unit roundoff of the stage, u_sums that of the sums in `stage`.
StageBounds stage_bounds(const StageSums& stage, double u, double u_sums, double roundings,
                         std::size_t active, double threshold, const LeftOut& left_out, double unit,
                         double tiny) {
    const double n = static_cast<double>(active + 64);
    const double sums = 1 + n * 4 * u_sums;
    const double rounding =
        stage.error * sums + roundings * u * (stage.magnitude + threshold) * sums + tiny;
    StageBounds bounds;
    bounds.above = (left_out.above + stage.left_out_above) * sums + rounding;
    bounds.below = (left_out.below + stage.left_out_below) * sums + rounding;
    // The slope's own sum: each term is at most 2 b / w.
    bounds.slope = (stage.slope + n * u * stage.full_slope) * unit * sums + tiny;
    return bounds;
}

}  // namespace

BundleField::FloatCuts BundleField::float_cuts(double cut) {
    return {cut, cut, cut * worst_float_share};
}

Window& BundleField::open(const Bounded& here, const BundlePart& part, double t0, double t1) {
    Window& w = window_;
    opened_ = &here;
    opened_on_ = stretch(part, t0, t1);
    opened_part_ = part;
    w.begin = t0;
    w.end = t1;
    w.axis = part.axis;
    w.origin = part.origin;
    w.middle = 0.5 * (t0 + t1);
    const auto tau = [&](double t) { return static_cast<float>((t - w.middle) / unit_); };
    w.tau_begin = tau(t0) * (1 + 0x1p-22f);  // negative
    w.tau_end = tau(t1) * (1 + 0x1p-22f);
    w.rise = here.rise;
    w.fall = here.fall;
    w.is_complete = w.fine_usable = has_full_ = has_full_mixed_ = has_in_double_ = has_along_ =
        false;

    w.is_unknown = false;
    w.condensed = nullptr;
    opened_condensed_ = here.is_condensed;
    if (here.is_condensed) {
        take_condensed(here, here.condensed, w);
        w.is_rough = true;
        w.strong.clear();
        w.weak.clear();
        w.coarse_usable = true;
        return w;
    }
    enter(here, part, w);
    return w;
}

void BundleField::take_condensed(const Bounded& here, const Condensed& condensed, Window& w) const {
    w.condensed = &condensed;
    w.walk_left_out = (here.left_out.above + here.left_out.below) * more;
    // |grad F| is 2 q F / w, and what is left out q < 8, or next to nothing.
    w.gradient_error = condensed.gradient_error + 16 * w.walk_left_out * (unit_ / least_width_);
    w.strong_bounds =
        w.coarse_bounds = {here.left_out.above * more + condensed.error,
                           here.left_out.below * more + condensed.error, condensed.slope_error};
    const double per_unit = 1 / unit_;
    w.rise = condensed.rise * (per_unit * per_unit);
    w.fall = condensed.fall * (per_unit * per_unit);
}

void BundleField::condense_closely(Window& w) {
    const Bounded& here = *opened_;
    const LocalStretch on = local_stretch(opened_part_, here.local_middle, w.begin, w.end);
    const double middle = (w.middle - here.local_middle) / unit_;
    const Condensing done = bundle_steps().condense(here.local, on, middle, threshold_, false,
                                                    Closeness::close, close_);
    w.coarse_usable = done == Condensing::condensed;
    w.is_rough = false;
    if (w.coarse_usable) take_condensed(here, close_, w);
}

void BundleField::enter(Window& window) { enter(*opened_, opened_part_, window); }

void BundleField::enter(const Bounded& here, const BundlePart& part, Window& w) {
    const double t0 = w.begin, t1 = w.end;
    const CoarseCuts cuts{threshold_ * strong_cut_share, threshold_ * coarse_cut_share};
    StageSums sums;
    double slope_unit = unit_, u_sums = 0x1p-53;
    if (here.is_local) {
        sums = bundle_steps().coarse_local(*field_, here.local,
                                           local_stretch(part, here.local_middle, t0, t1),
                                           (w.middle - here.local_middle) / unit_, cuts, w);
        slope_unit = 1;
        u_sums = 0x1p-24;
    } else {
        sums = bundle_steps().coarse(*field_, opened_on_, scale_, cuts, here.active, w);
    }
    w.coarse_bounds = stage_bounds(sums, 0x1p-24, u_sums, roundings(w.strong.size + w.weak.size),
                                   here.size(), threshold_, here.left_out, slope_unit, 1e-30);
    const double added = 1 + static_cast<double>(here.size() + 64) * 4 * u_sums;
    w.strong_bounds = {w.coarse_bounds.above + sums.weak_above * added,
                       w.coarse_bounds.below + sums.weak_below * added,
                       w.coarse_bounds.slope + sums.weak_slope * slope_unit * added};
    // No product of the walk's formulas comes near the end of float.
    const double size = (sums.magnitude + threshold_) * unit_ * unit_;
    w.coarse_usable = sums.usable && size * w.rise < 1e30 && size * w.fall < 1e30 &&
                      sums.full_slope * slope_unit < 1e14 && w.strong_bounds.slope < 1e14;
}

Window& BundleField::open_unknown() {
    window_.coarse_usable = false;
    window_.is_unknown = true;
    window_.condensed = nullptr;
    window_.begin = 0;
    return window_;
}

// From doubles or, where they are there, floats.
void BundleField::complete(const Bounded& bounded, const BundlePart& part, const Stretch& on,
                           const FloatCuts& float_cuts, Window& w) {
    const ActiveElements* active = &bounded.active;
    w.fine_in_float.clear();
    StageBounds in_float;
    if (bounded.is_local) {
        active = &members_;
        const LocalStretch near_on = local_stretch(part, bounded.local_middle, on.begin, on.end);
        const double middle = (w.middle - bounded.local_middle) / unit_;
        const auto part_at = [&](double cut) {
            const StageSums sums = bundle_steps().fine_in_float(*field_, bounded.local, near_on,
                                                                middle, unit_, cut, w, members_);
            if (w.fine_in_float.size > 0) {
                in_float = stage_bounds(sums, 0x1p-24, 0x1p-24, roundings_in_float(w.fine_in_float),
                                        bounded.local.size(), 0, {}, 1, 1e-30);
                // No slope of theirs is computed.
                in_float.slope = sums.full_slope *
                                 (1 + static_cast<double>(bounded.local.size() + 64) * 0x1p-22) /
                                 unit_;
            }
            return sums.usable && std::max(in_float.above, in_float.below) <= float_cuts.worst;
        };
        double cut = float_cuts.greatest;
        while (!part_at(cut)) {
            in_float = {};
            if (cut < 0) break;
            cut *= next_float_cut;
            if (cut < float_cuts.least) cut = -1;  // all in double
        }
    }
    const StageSums sums = bundle_steps().fine(*field_, on, scale_, *active, w);
    w.fine_bounds = stage_bounds(sums, 0x1p-53, 0x1p-53,
                                 w.compensated ? compensated_roundings : roundings(w.fine.size),
                                 active->size(), threshold_, bounded.left_out, 1, 1e-280);
    w.fine_bounds.above += in_float.above;
    w.fine_bounds.below += in_float.below;
    w.fine_bounds.slope += in_float.slope;
    w.fine_usable = sums.usable;
    w.is_complete = true;
}

void BundleField::complete(Window& w) {
    if (!w.is_complete)
        complete(*opened_, opened_part_, opened_on_, float_cuts(fine_cut_ * float_cut_multiple), w);
}

void BundleField::take_opened(const Bounded& bounded, const FloatCuts& float_cuts, Window& w) {
    w.begin = window_.begin;
    w.middle = window_.middle;
    w.end = window_.end;
    w.axis = window_.axis;
    w.origin = window_.origin;
    w.rise = bounded.rise;
    w.fall = bounded.fall;
    complete(bounded, opened_part_, opened_on_, float_cuts, w);
}

// Where elements suit float they are bounded in it, all the same.
const Window& BundleField::full() {
    if (has_full_) return full_;
    has_full_ = true;
    if (opened_->is_local) {
        if (!has_full_mixed_ || opened_condensed_) {
            bound_opened(full_cut_, full_bounded_);
            bound_opened_curvature(full_bounded_);
        }
    } else {
        const Bounded* from = &list_;
        if (list_.in_clusters) {
            bound(opened_on_, full_cut_, list_, true, full_clusters_);
            from = &full_clusters_;
        }
        bound(opened_on_, full_cut_, *from, false, full_bounded_);
        full_bounded_.is_local = false;
        bound_curvature(opened_on_, full_bounded_);
    }
    take_opened(full_bounded_, all_in_double, full_);
    return full_;
}

const Window& BundleField::in_double() {
    if (opened_condensed_) return full();
    if (!has_in_double_) take_opened(*opened_, all_in_double, in_double_);
    has_in_double_ = true;
    return in_double_;
}

void BundleField::bound_opened_curvature(Bounded& finer) {
    const double pad = pad_of(opened_on_.begin, opened_on_.end);
    bound_curvature(opened_part_, opened_on_.begin - pad, opened_on_.end + pad, finer);
}

// The list's elements on the window that is open, those above the cut, in float.
void BundleField::bound_opened(double cut, Bounded& finer) {
    const double pad = pad_of(opened_on_.begin, opened_on_.end);
    const double t0 = opened_on_.begin - pad, t1 = opened_on_.end + pad;
    finer.local_middle = window_.middle;
    if (list_.in_clusters) {
        bound(opened_on_, cut, list_, true, full_clusters_);
        finer.in_clusters = false;
        bound_members(opened_part_, t0, t1, cut, full_clusters_, finer);
    } else {
        Stretch padded = opened_on_;
        padded.begin = t0;
        padded.end = t1;
        bound(padded, cut, list_, false, finer);
        bundle_steps().enter_local(*field_, stretch(home_, t0, t1), finer.local_middle,
                                   finer.active, finer.local);
    }
    finer.is_local = true;
}

// Of clusters the members are bounded in float.
const Window& BundleField::full_mixed() {
    if (!opened_condensed_ && !(list_.in_clusters && opened_->is_local)) return full();
    if (has_full_mixed_) return full_mixed_;
    has_full_mixed_ = true;
    Bounded& finer = full_bounded_;
    bound_opened(opened_condensed_ ? fine_cut_ * crowd_fine_cut_multiple : full_cut_, finer);
    bound_opened_curvature(finer);
    take_opened(finer,
                opened_condensed_ ? FloatCuts{fine_cut_ * float_cut_multiple, fine_cut_,
                                              fine_cut_ * worst_in_crowd}
                                  : float_cuts(fine_cut_ * full_mixed_cut_multiple),
                full_mixed_);
    return full_mixed_;
}

const Window* BundleField::along(const Vec3d& origin, const Vec3d& direction) {
    if (!has_along_) {
        bound_opened(full_cut_, along_bounded_);
        has_along_ = true;
    }
    Window& w = about_root_;
    w.begin = window_.begin;
    w.middle = window_.middle;
    w.end = window_.end;
    w.axis = direction;
    w.origin = origin;
    w.compensated = false;
    w.fine.clear();
    w.fine_in_float.clear();
    CondensedRay& ray = condensed_ray_;
    if (!bundle_steps().condense_ray(*field_, along_bounded_.local, origin, direction, w.begin,
                                     w.end, scale_, threshold_, ray)) {
        return nullptr;
    }
    w.along = &ray;
    w.rise = ray.rise;
    w.fall = ray.fall;
    const LeftOut& left_out = along_bounded_.left_out;
    w.fine_bounds = {left_out.above * more + ray.error, left_out.below * more + ray.error,
                     ray.slope_error};
    w.fine_usable = w.is_complete = true;
    return &w;
}

const Window& BundleField::about_root(const Vec3d& origin, const Vec3d& direction, double t) {
    full_mixed();
    const Bounded& parent = full_bounded_;
    Bounded& here = about_root_bounded_;
    Window& w = about_root_;
    const BundlePart ray{.axis = direction, .origin = origin};
    const double reach = about_root_reach * least_width_;
    w.begin = std::max(t - reach, window_.begin);
    w.end = std::min(t + reach, window_.end);
    w.middle = 0.5 * (w.begin + w.end);
    w.axis = direction;
    w.origin = origin;
    w.compensated = true;
    w.along = nullptr;
    // The places are relative to the window's middle.
    const double pad = pad_of(window_.begin, window_.end);
    const double t0 = w.begin - pad, t1 = w.end + pad;
    here.is_local = parent.is_local;
    if (parent.is_local) {
        here.local_middle = parent.local_middle;
        const PeakSums peaks = bundle_steps().bound_local(
            parent.local, local_stretch(ray, parent.local_middle, t0, t1), full_cut_, here.local);
        here.left_out = parent.left_out.with(peaks, parent.local.size(), u_float);
    } else {
        bound(stretch(ray, t0, t1), full_cut_, parent, false, here);
    }
    bound_curvature(ray, t0, t1, here);
    w.rise = here.rise;
    w.fall = here.fall;
    complete(here, ray, stretch(ray, w.begin, w.end),
             float_cuts(fine_cut_ * full_mixed_cut_multiple), w);
    return w;
}

}  // namespace ivory
