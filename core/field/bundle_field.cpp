#include "core/field/bundle_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/interval/slabs.h"

namespace ivory {
namespace {

// As in core/field/bundle_steps.h.
constexpr double margin = 0x1p-46;
constexpr double more = 1 + 0x1p-46, less = 1 - 0x1p-46;

// Windows are halved until f'' could bend f by less than this share of T over one of them.
constexpr double curvature_limit = 8;

constexpr double strong_cut_share = 0x1p-8, coarse_cut_share = 0x1p-20, fine_cut_share = 0x1p-24;
constexpr double full_cut_share = 0x1p-16;  // of the fine cut
// Elements below this multiple of it are added up in float: in crowds what they lose there is a
// fraction of what those below the fine cut leave open.
constexpr double float_cut_multiple = 0x1p13;
// Unless what float loses of them all is more than this share of that cut: places may be rough.
constexpr double worst_float_share = 0x1p-6;
// In crowds that cut is lowered by steps until float loses no more than that multiple of the fine cut.
constexpr double next_float_cut = 0x1p-3, worst_in_crowd = 8;
// The multiple for windows that leave out next to nothing.
constexpr double full_mixed_cut_multiple = 0x1p-3;

// In least widths: as long as the shortest windows, and what elements can be there hardly differs
// from what they are.
constexpr double about_root_reach = 0x1p-6;

constexpr double u_float = 0x1p-22;  // of sums in float, as add_rest wants it

// Fewer elements are added up as quickly as a polynomial of them is made.
constexpr std::size_t crowd = 128;
// For a walk through a crowd elements below this multiple of the fine cut are left out; those that enclose its
// roots are above that one: the sum of what many leave out is far more than what each does.
constexpr double crowd_cut_multiple = 0x1p8, crowd_fine_cut_multiple = 0x1p-6;

// And until what is only known of |f'|, near the axes of circles, could change f by no more than
// this share of T; but not below this share of the least width.
constexpr double kink_limit = 0x1p-6, least_length = 0x1p-5;

// Stretches up to this length are bounded in float, where the field suits it.
constexpr double longest_in_float = 100;  // units

}  // namespace

bool BundleField::build(const Field& field, const ElementList& list, const Bundle& bundle,
                        double tolerance, bool skips_windows, Cancellation* stop) {
    field_ = &field;
    skips_windows_ = skips_windows;
    stop_ = stop;
    is_stopped_ = false;
    stretches_ = stretches_ended_ = 0;
    if (!field.compact || !(bundle.spread <= 0.5 && bundle.radius < 1e30)) return false;
    const Vec3d& o = bundle.origin;
    if (!(std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < 1e30)) return false;

    begin(whole_of(bundle), false);
    scale_ = field.scale;
    threshold_ = field.threshold * scale_;
    unit_ = field.unit;
    least_width_ = field.least_width;
    fine_cut_ = threshold_ * std::min(fine_cut_share, tolerance * 0x1p-16);
    full_cut_ = fine_cut_ * full_cut_share;
    take_list(list, list_);
    return true;
}

// The t at which rays of the bundle may be in the field's box.
Interval<double> BundleField::span_of(const Bundle& bundle) const {
    // Every ray is in the box at t only if the axis is in the box made larger by radius + t spread.
    const Vec3d& o = bundle.origin;
    double farthest = 0;
    Box3 box = field_->box;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side = std::max(std::abs(box.lo[k] - o[k]), std::abs(box.hi[k] - o[k]));
        farthest += side * side;
    }
    farthest = (std::sqrt(farthest) + bundle.radius) * more;
    const double spread = bundle.spread * more + 0x1p-49;
    const double aside = farthest * spread * more + farthest * margin + bundle.radius * more;
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] -= aside + std::abs(box.lo[k]) * margin;
        box.hi[k] += aside + std::abs(box.hi[k]) * margin;
    }
    // smaller components bound nothing that matters
    Interval<double> span = within_slabs(box, o, bundle.axis, 1e-9);
    if (is_empty(span)) return span;
    span.hi = std::min(span.hi * more, farthest * more);
    span.lo = std::max(span.lo * less, 0.0);
    return span.lo < span.hi ? span : Interval<double>::empty_set();
}

void BundleField::take_list(const ElementList& list, Bounded& bounded) const {
    bounded.left_out = {std::max(list.left_out.hi, 0.0) * scale_ * more,
                        std::max(-list.left_out.lo, 0.0) * scale_ * more};
    bounded.in_clusters = !list.clusters.empty();
    if (bounded.in_clusters) {
        bounded.active.take(field_->clusters.first_of_group, list.clusters);
    } else {
        bounded.active.take(field_->first, list.elements);
    }
}

Stretch BundleField::stretch(const BundlePart& part, double t0, double t1) const {
    return {part.origin, part.axis, part.spread * more + 0x1p-49, part.radius * more, t0, t1};
}

// (2) of bundle_field.h: the part's axis at t is (part's origin - origin) + middle (part's axis - axis)
// + (t - middle) part's axis away from M.
LocalStretch BundleField::local_stretch(const BundlePart& part, double middle, double t0,
                                        double t1) const {
    const Vec3d& axis = home_.axis;
    const double per_unit = 1 / unit_;
    const Vec3d aside = part.origin - home_.origin;
    return {part.axis,
            {(middle * (part.axis.x - axis.x) + aside.x) * per_unit,
             (middle * (part.axis.y - axis.y) + aside.y) * per_unit,
             (middle * (part.axis.z - axis.z) + aside.z) * per_unit},
            part.spread * more + 0x1p-49,
            part.radius * per_unit * more,
            (t0 - middle) * per_unit,
            (t1 - middle) * per_unit,
            middle * per_unit};
}

PeakSums BundleField::bound(const Stretch& on, double cut, const Bounded& parent, bool in_clusters,
                            Bounded& result) {
    const ActiveElements* candidates = &parent.active;
    if (parent.in_clusters && !in_clusters) {
        members_.take_members(field_->clusters, parent.active);
        candidates = &members_;
    }
    result.in_clusters = parent.in_clusters && in_clusters;
    const auto step = result.in_clusters ? bundle_steps().bound_clusters : bundle_steps().bound;
    const PeakSums peaks = step(*field_, on, scale_, cut, *candidates, result.active);
    result.left_out = parent.left_out.with(peaks, candidates->size(), 0x1p-52);
    return peaks;
}

// Those of the parent's clusters, in float; `result` says relative to what.
PeakSums BundleField::bound_members(const BundlePart& part, double t0, double t1, double cut,
                                    const Bounded& parent, Bounded& result) {
    const PeakSums peaks = bundle_steps().bound_members(
        *field_, stretch(home_, t0, t1), result.local_middle,
        local_stretch(part, result.local_middle, t0, t1), cut, parent.active, &result.local);
    result.left_out = parent.left_out.with(peaks, parent.active.size() * cluster_size, u_float);
    return peaks;
}

bool BundleField::bound(const Bounded& parent, Bounded& here, const BundlePart& part, double t0,
                        double t1, bool in_clusters) {
    PeakSums peaks;
    double u = 0x1p-52;  // of the sums
    here.is_local = parent.is_local;
    here.is_condensed = false;
    if (parent.is_local) {
        u = u_float;
        here.local_middle = parent.local_middle;
        const LocalStretch on = local_stretch(part, parent.local_middle, t0, t1);
        if (is_crowded(parent)) {
            peaks = bundle_steps().bound_local(parent.local, on, fine_cut_ * crowd_cut_multiple,
                                               here.local);
        }
        if (!is_crowded(parent) || !is_crowded(here)) {
            peaks = bundle_steps().bound_local(parent.local, on, fine_cut_, here.local);
        }
        here.left_out = parent.left_out.with(peaks, parent.local.size(), u);
        // Places far from what they are relative to have lost digits.
        const double middle = 0.5 * (t0 + t1);
        if (!in_clusters && std::abs(middle - here.local_middle) > long_stretch * unit_) {
            here.local_middle = middle;
            bundle_steps().place_local(*field_, stretch(home_, t0, t1), middle, here.local);
        }
    } else {
        const Stretch on = stretch(part, t0, t1);
        here.is_local = field_->suits_float && !(parent.in_clusters && in_clusters) &&
                        t1 - t0 < longest_in_float * unit_;
        here.local_middle = 0.5 * (t0 + t1);
        if (here.is_local && parent.in_clusters) {
            u = u_float;
            here.in_clusters = false;
            peaks = bound_members(part, t0, t1, fine_cut_, parent, here);
        } else {
            peaks = bound(on, fine_cut_, parent, in_clusters, here);
            if (here.is_local) {
                bundle_steps().enter_local(*field_, stretch(home_, t0, t1), here.local_middle,
                                           here.active, here.local);
            }
        }
    }
    ++stretches_;
    const std::size_t each = parent.in_clusters && !parent.is_local ? cluster_size : 1;
    if (stop_ != nullptr && stop_->after(parent.size() * each)) is_stopped_ = true;
    if (skips_windows_ && certainly_below(threshold_, peaks, here.left_out, here.size(), u)) {
        ++stretches_ended_;
        return false;
    }
    return true;
}

void BundleField::bound_curvature(const BundlePart& part, double t0, double t1,
                                  Bounded& bounded) const {
    if (!bounded.is_local) return bound_curvature(stretch(part, t0, t1), bounded);
    const CurvatureSums bends = bundle_steps().bound_curvature_local(
        bounded.local, local_stretch(part, bounded.local_middle, t0, t1));
    const double sums = 1 + static_cast<double>(bounded.local.size() + 64) * 0x1p-22;
    const double per_unit = 1 / unit_;
    bounded.rise = bends.rise * sums * (per_unit * per_unit);
    bounded.fall = bends.fall * sums * (per_unit * per_unit);
    bounded.kinked_slope = bends.kinked_slope * sums * per_unit;
}

void BundleField::bound_curvature(const Stretch& on, Bounded& bounded) const {
    const CurvatureSums bends = bundle_steps().bound_curvature(*field_, on, scale_, bounded.active);
    bounded.rise = bends.rise * (1 + 0x1p-30);
    bounded.fall = bends.fall * (1 + 0x1p-30);
    bounded.kinked_slope = bends.kinked_slope;
}

AcrossSums BundleField::bound_across(const BundlePart& part, double t0, double t1,
                                     const Bounded& bounded) const {
    const double sums = 1 + static_cast<double>(bounded.size() + 64) * 0x1p-22;
    AcrossSums across;
    double per_unit = 1;
    if (bounded.is_local) {
        per_unit = 1 / unit_;
        across = bundle_steps().bound_across_local(
            bounded.local, local_stretch(part, bounded.local_middle, t0, t1));
    } else {
        across =
            bundle_steps().bound_across(*field_, stretch(part, t0, t1), scale_, bounded.active);
    }
    across.curvature *= sums * per_unit * per_unit;
    across.joined_slope *= sums * per_unit;
    return across;
}

bool BundleField::is_crowded(const Bounded& bounded) const {
    constexpr std::size_t gaussians = group_of(Shape::point, KernelKind::blinn);
    if (!condenses_ || !bounded.is_local || bounded.size() < crowd) return false;
    const GroupStarts::Range range = bounded.local.first.of(gaussians);
    return range.end - range.first == bounded.size();
}

Condensing BundleField::condense(const BundlePart& part, double t0, double t1, bool may_part,
                                 Bounded& bounded) const {
    Condensed& condensed = bounded.condensed;
    const double middle = (0.5 * (t0 + t1) - bounded.local_middle) / unit_;
    const Condensing done =
        bundle_steps().condense(bounded.local, local_stretch(part, bounded.local_middle, t0, t1),
                                middle, threshold_, may_part, Closeness::rough, condensed);
    bounded.is_condensed = done == Condensing::condensed;
    if (!bounded.is_condensed) return done;
    const double per_unit = 1 / unit_;
    bounded.rise = condensed.rise * (per_unit * per_unit);
    bounded.fall = condensed.fall * (per_unit * per_unit);
    bounded.kinked_slope = 0;
    return done;
}

bool BundleField::is_below(const Bounded& bounded) const {
    return bounded.condensed.most + bounded.left_out.above * more < threshold_ * less;
}

bool BundleField::is_too_curved(const Bounded& bounded, double length) const {
    return length > least_length * least_width_ &&
           (std::max(bounded.rise, bounded.fall) * length * length > curvature_limit * threshold_ ||
            bounded.kinked_slope * length > kink_limit * threshold_);
}

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
    w.is_complete = w.fine_usable = has_full_ = has_full_mixed_ = has_along_ = false;

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
        sums =
            bundle_steps().coarse_local(here.local, local_stretch(part, here.local_middle, t0, t1),
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
            const StageSums sums = bundle_steps().fine_in_float(bounded.local, near_on, middle,
                                                                unit_, cut, w, members_);
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

const Window& BundleField::full() {
    if (has_full_) return full_;
    has_full_ = true;
    const Bounded* from = &list_;
    if (list_.in_clusters) {
        bound(opened_on_, full_cut_, list_, true, full_clusters_);
        from = &full_clusters_;
    }
    bound(opened_on_, full_cut_, *from, false, full_bounded_);
    full_bounded_.is_local = false;
    bound_curvature(opened_on_, full_bounded_);
    take_opened(full_bounded_, float_cuts(0), full_);
    return full_;
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
    const double pad = pad_of(opened_on_.begin, opened_on_.end);
    bound_curvature(opened_part_, opened_on_.begin - pad, opened_on_.end + pad, finer);
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
