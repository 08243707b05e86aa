// Bounds of the elements' f'' on the stretch that they were bounded on.
#if defined(IVORY_CORE_FIELD_CURVATURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_CURVATURE_INL
#undef IVORY_CORE_FIELD_CURVATURE_INL
#else
#define IVORY_CORE_FIELD_CURVATURE_INL
#endif

#include "core/field/joined.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <class Tag>
struct BendLanes {
    V<Tag> rise, fall, kinked_slope;
};

// |F'| along a ray of speed 1, at most.
template <KernelKind kind, class Tag, Shape shape>
HWY_INLINE V<Tag> steepest(Tag d, const Seen<Tag, shape>& e, V<Tag> least, V<Tag> peak) {
    using Margin = Margins<hn::TFromD<Tag>>;
    return hn::Mul(
        hn::Mul(hn::Abs(e.strength), hn::Sqrt(e.inverse_square)),
        hn::Mul(hn::Set(d, 2 * Margin::more * Margin::more), LanesOf<kind>::slope(d, least, peak)));
}

// Kinks that each ray may prove to be none of its own count so much beside others, where stretches are to be
// halved: less leaves more to single rays, more makes more windows (curves-1000).
constexpr double proved_kinks_count = 0x1p-6;

// Adds the bends of some elements; returns the circles' bound of 1 / rho.
template <KernelKind kind, class Tag, Shape shape>
HWY_INLINE V<Tag> add_bends(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                            M<Tag> valid, V<Tag> least, V<Tag> most, V<Tag> peak,
                            BendLanes<Tag>& sums) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    const Tag d;
    const V<Tag> zero = hn::Zero(d);
    const V<Tag> error = error_of(d, e.magnitude, s);
    M<Tag> smooth = valid;
    V<Tag> inverse = zero, outward = zero;  // 1 / rho, r / rho
    if constexpr (SkeletonOf<shape>::has_kinks) {
        const Turning<Tag> turning = LanesOfShape<shape>::turning(e, s, error, most);
        inverse = turning.inverse;
        outward = turning.outward;
        const M<Tag> kinked = hn::And(hn::Lt(inverse, zero), valid);
        const V<Tag> slope = hn::IfThenElseZero(kinked, steepest<kind>(d, e, least, peak));
        if constexpr (proves_feet<shape>) {
            // What follows from s'' >= 0, to which each ray adds. By how much is not known before; for short
            // windows it is less.
            outward = hn::IfThenElse(kinked, constant(d, 1), outward);
            sums.kinked_slope =
                hn::MulAdd(slope, constant(d, proved_kinks_count), sums.kinked_slope);
        } else {
            smooth = hn::AndNot(kinked, smooth);
            // no f'' is known of the others
            sums.kinked_slope = hn::Add(sums.kinked_slope, slope);
        }
    }
    const Bend<Tag> bend = LanesOf<kind>::bound_curvature(
        d, LanesOfShape<shape>::curvature_range(e, s, error, least, most), peak, outward);
    const M<Tag> adds = hn::Gt(e.strength, zero);
    const V<Tag> weight = hn::IfThenElseZero(
        smooth, hn::Mul(hn::Mul(hn::Abs(e.strength), e.inverse_square), hn::Set(d, Margin::more)));
    sums.rise = hn::MulAdd(hn::IfThenElse(adds, bend.rise, bend.fall), weight, sums.rise);
    sums.fall = hn::MulAdd(hn::IfThenElse(adds, bend.fall, bend.rise), weight, sums.fall);
    return inverse;
}

// q is 1 / w at most as steep as any distance, w the least width, in every direction; and s'' is bounded
// in every direction alike, since kinks were looked for in a ball about each place of the axis.
template <KernelKind kind, class Tag, Shape shape>
HWY_INLINE V<Tag> curvature_across(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                                   M<Tag> valid, V<Tag> least, V<Tag> most, V<Tag> peak) {
    using Margin = Margins<hn::TFromD<Tag>>;
    const Tag d;
    M<Tag> smooth = valid;
    V<Tag> outward = hn::Zero(d);
    if constexpr (SkeletonOf<shape>::has_kinks) {
        const Turning<Tag> turning =
            LanesOfShape<shape>::turning(e, s, error_of(d, e.magnitude, s), most);
        outward = turning.outward;
        smooth = hn::And(smooth, hn::Ge(turning.inverse, hn::Zero(d)));
    }
    // x^2 <= s, and no kernel is bent beyond s = 2 by what it is not bent by before
    const CurvatureRange<Tag> everywhere{least, least, hn::Max(least, constant(d, 2)), hn::Zero(d),
                                         false};
    const Bend<Tag> bend = LanesOf<kind>::bound_curvature(d, everywhere, peak, outward);
    const V<Tag> weight =
        hn::Mul(hn::Mul(hn::Abs(e.strength), e.inverse_square), hn::Set(d, Margin::more));
    return hn::IfThenElseZero(smooth, hn::Mul(hn::Max(bend.rise, bend.fall), weight));
}

// The same for lanes of a group, from `load(i)` and their bounds; `source` as in joins_of.
template <Shape shape, KernelKind kind, class Tag, class Load, class Column, class Source>
HWY_INLINE void add_across(Tag d, const Reach<hn::TFromD<Tag>>& reach, std::size_t first,
                           std::size_t end, const Load& load, const Column& bounds,
                           const Source& source, AcrossSums& sums) {
    V<Tag> curvature = hn::Zero(d);
    double most_of_parts = 0;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const Seen<Tag, shape> e = load(i);
        const auto [least, most, peak] = bounds(i);
        const M<Tag> valid = hn::FirstN(d, end - i);
        if constexpr (joined<shape>) {
            alignas(64) hn::TFromD<Tag> of_lane[hn::MaxLanes(Tag())];
            hn::Store(steepest<kind>(d, e, least, peak), d, of_lane);
            const std::size_t count = std::min(hn::Lanes(d), end - i);
            const std::uint32_t joins = joins_of(i, end, count, source);
            for (std::size_t k = 0; k < count; ++k) {
                most_of_parts = std::max(most_of_parts, double{of_lane[k]});
                if ((joins >> k & 1) != 0) continue;
                sums.joined_slope += most_of_parts;
                most_of_parts = 0;
            }
        } else {
            curvature =
                hn::Add(curvature, curvature_across<kind>(e, reach, valid, least, most, peak));
        }
    }
    sums.curvature += sum_of(curvature);
}

template <class Vector>
struct BoundsOfLanes {
    Vector least, most, peak;
};

AcrossSums bound_across(const Field& field, const Stretch& stretch, double scale,
                        const ActiveElements& active) {
    AcrossSums sums;
    const D d;
    const Reach<double> reach = reach_of(stretch);
    for_groups_of(active.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                  std::size_t end) HWY_ATTR {
        add_across<shape, kind>(
            d, reach, first, end,
            [&](std::size_t i)
                HWY_ATTR { return seen_active<shape>(field, stretch, scale, active, i); },
            [&](std::size_t i) HWY_ATTR {
                return BoundsOfLanes<V<D>>{hn::LoadU(d, &active.least[i]),
                                           hn::LoadU(d, &active.most[i]),
                                           hn::LoadU(d, &active.peak[i])};
            },
            [&](std::size_t k) {
                return field.source[static_cast<std::size_t>(active.element[k])];
            },
            sums);
    });
    return sums;
}

AcrossSums bound_across_local(const LocalElements& near, const LocalStretch& stretch) {
    AcrossSums sums;
    const F d;
    const Reach<float> reach = reach_of(stretch, near);
    for_groups_of(near.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                std::size_t end) HWY_ATTR {
        add_across<shape, kind>(
            d, reach, first, end,
            [&](std::size_t i) HWY_ATTR { return seen_local<shape>(near, near.numbers, reach, i); },
            [&](std::size_t i) HWY_ATTR {
                return BoundsOfLanes<V<F>>{hn::LoadU(d, &near.least[i]),
                                           hn::LoadU(d, &near.most[i]),
                                           hn::LoadU(d, &near.peak[i])};
            },
            [&](std::size_t k) { return near.source[k]; }, sums);
    });
    return sums;
}

template <class Tag>
HWY_INLINE void add_up(const BendLanes<Tag>& lanes, CurvatureSums& sums) {
    sums.rise += sum_of(lanes.rise);
    sums.fall += sum_of(lanes.fall);
    sums.kinked_slope += sum_of(lanes.kinked_slope);
}

// The greatest of each element's parts, lane by lane. A kinked part's slope counts beside them.
template <class Tag>
class JoinedBends {
  public:
    // Of lanes whose next one is of the same element where a bit is set.
    void add(Tag d, const BendLanes<Tag>& lanes, std::size_t count, std::uint32_t joins) {
        alignas(64) hn::TFromD<Tag> of_lane[3][hn::MaxLanes(Tag())];
        hn::Store(lanes.rise, d, of_lane[0]);
        hn::Store(lanes.fall, d, of_lane[1]);
        hn::Store(lanes.kinked_slope, d, of_lane[2]);
        for (std::size_t k = 0; k < count; ++k) {
            most_.rise = std::max(most_.rise, double{of_lane[0][k]});
            most_.fall = std::max(most_.fall, double{of_lane[1][k]});
            most_.kinked_slope = std::max(most_.kinked_slope, double{of_lane[2][k]});
            if ((joins >> k & 1) != 0) continue;
            sums_.rise += most_.rise;
            sums_.fall += most_.fall;
            sums_.kinked_slope += most_.kinked_slope;
            most_ = {};
        }
    }
    void add_to(CurvatureSums& sums) const {
        sums.rise += sums_.rise;
        sums.fall += sums_.fall;
        sums.kinked_slope += sums_.kinked_slope;
    }

  private:
    CurvatureSums most_, sums_;
};

template <Shape shape, KernelKind kind>
void bend_group(const Field& field, const Stretch& stretch, double scale, ActiveElements& active,
                std::size_t first, std::size_t end, CurvatureSums& sums) {
    const D d;
    const Reach<double> reach = reach_of(stretch);
    BendLanes<D> lanes{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    JoinedBends<D> bends;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const auto e = seen_active<shape>(field, stretch, scale, active, i);
        const V<D> inverse =
            add_bends<kind>(e, reach, hn::FirstN(d, end - i), hn::LoadU(d, &active.least[i]),
                            hn::LoadU(d, &active.most[i]), hn::LoadU(d, &active.peak[i]), lanes);
        // of elements that are no circles 0, those of the next group follow
        hn::StoreU(inverse, d, &active.inverse[i]);
        if constexpr (joined<shape>) {
            const std::size_t count = std::min(hn::Lanes(d), end - i);
            bends.add(d, lanes, count, joins_of(i, end, count, [&](std::size_t k) {
                          return field.source[static_cast<std::size_t>(active.element[k])];
                      }));
            lanes = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        }
    }
    bends.add_to(sums);
    add_up(lanes, sums);
}

CurvatureSums bound_curvature(const Field& field, const Stretch& stretch, double scale,
                              ActiveElements& active) {
    CurvatureSums sums;
    for_groups_of(active.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                  std::size_t end) HWY_ATTR {
        bend_group<shape, kind>(field, stretch, scale, active, first, end, sums);
    });
    return sums;
}

template <Shape shape, KernelKind kind>
void bound_curvature_local_group(LocalElements& near, const Reach<float>& reach, std::size_t first,
                                 std::size_t end, CurvatureSums& sums) {
    const F d;
    BendLanes<F> lanes{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    JoinedBends<F> bends;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const auto e = seen_local<shape>(near, near.numbers, reach, i);
        const V<F> inverse =
            add_bends<kind>(e, reach, hn::FirstN(d, end - i), hn::LoadU(d, &near.least[i]),
                            hn::LoadU(d, &near.most[i]), hn::LoadU(d, &near.peak[i]), lanes);
        hn::StoreU(inverse, d, &near.inverse[i]);
        if constexpr (joined<shape>) {
            const std::size_t count = std::min(hn::Lanes(d), end - i);
            bends.add(d, lanes, count,
                      joins_of(i, end, count, [&](std::size_t k) { return near.source[k]; }));
            lanes = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        }
    }
    bends.add_to(sums);
    add_up(lanes, sums);
}

CurvatureSums bound_curvature_local(LocalElements& near, const LocalStretch& stretch) {
    CurvatureSums sums;
    const Reach<float> reach = reach_of(stretch, near);
    for_groups_of(near.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                std::size_t end) HWY_ATTR {
        bound_curvature_local_group<shape, kind>(near, reach, first, end, sums);
    });
    return sums;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
