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
        smooth = hn::And(smooth, hn::Ge(inverse, zero));
        // no f'' is known of the others
        const V<Tag> slope = hn::Mul(hn::Mul(hn::Abs(e.strength), hn::Sqrt(e.inverse_square)),
                                     hn::Mul(hn::Set(d, 2 * Margin::more * Margin::more),
                                             LanesOf<kind>::slope(d, least, peak)));
        sums.kinked_slope =
            hn::Add(sums.kinked_slope, hn::IfThenElseZero(hn::AndNot(smooth, valid), slope));
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
    const I di;
    const Reach<double> reach = reach_of(stretch);
    BendLanes<D> lanes{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    JoinedBends<D> bends;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const auto e =
            seen_in_field<shape>(field, stretch, scale, hn::LoadU(di, &active.element[i]));
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
