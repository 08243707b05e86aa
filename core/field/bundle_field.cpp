#include "core/field/bundle_field.h"

#include <algorithm>
#include <cmath>

#include "core/interval/slabs.h"

namespace ivory {
namespace {

// As in core/field/bundle_steps.h.
constexpr double margin = 0x1p-46;
constexpr double more = 1 + 0x1p-46, less = 1 - 0x1p-46;

// Windows are halved until f'' could bend f by less than this share of T over one of them.
constexpr double curvature_limit = 8;

constexpr double fine_cut_share = 0x1p-24;  // of T
constexpr double full_cut_share = 0x1p-16;  // of the fine cut

// Fewer elements are added up as quickly as a polynomial of them is made.
constexpr std::size_t crowd = 128;
// For a walk through a crowd elements below this multiple of the fine cut are left out.
constexpr double crowd_cut_multiple = 0x1p8;

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
        const bool was_crowded = is_crowded(parent);
        const double cut = was_crowded ? fine_cut_ * crowd_cut_multiple : fine_cut_;
        peaks = bundle_steps().bound_local(parent.local, on, cut, here.local);
        if (was_crowded && !is_crowded(here)) {  // too few are left to leave out so much
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

void BundleField::bound_curvature(const BundlePart& part, double t0, double t1, Bounded& bounded) {
    if (!bounded.is_local) return bound_curvature(stretch(part, t0, t1), bounded);
    const LocalStretch on = local_stretch(part, bounded.local_middle, t0, t1);
    bundle_steps().keep_nearest_parts_local(bounded.local, on, feet_in_float_);
    const CurvatureSums bends = bundle_steps().bound_curvature_local(bounded.local, on);
    const double sums = 1 + static_cast<double>(bounded.local.size() + 64) * 0x1p-22;
    const double per_unit = 1 / unit_;
    bounded.rise = bends.rise * sums * (per_unit * per_unit);
    bounded.fall = bends.fall * sums * (per_unit * per_unit);
    bounded.kinked_slope = bends.kinked_slope * sums * per_unit;
}

void BundleField::bound_curvature(const Stretch& on, Bounded& bounded) {
    bundle_steps().keep_nearest_parts(*field_, on, scale_, bounded.active, feet_);
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

}  // namespace ivory
