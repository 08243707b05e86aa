// f and its slope at one place of each ray: the sum over the entries of a stage.
#if defined(IVORY_CORE_TRACE_FIELD_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_FIELD_LANES_INL
#undef IVORY_CORE_TRACE_FIELD_LANES_INL
#else
#define IVORY_CORE_TRACE_FIELD_LANES_INL
#endif

#include "core/field/window.h"
#include "core/shape/shape_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <Shape shape, class Tag>
HWY_INLINE Vec3v<Tag> away_from(Tag d, const BundleEntry<hn::TFromD<Tag>>& e, const Vec3v<Tag>& p,
                                V<Tag>& square) {
    return LanesOfShape<shape>::away(d, e, p, square);
}

template <class Tag>
struct FieldValue {
    V<Tag> f, slope;
};

template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE void add_group(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry, std::uint32_t count,
                          const Vec3v<Tag>& p, const Vec3v<Tag>& direction, FieldValue<Tag>& sum) {
    for (const auto* const end = entry + count; entry != end; ++entry) {
        V<Tag> square;
        const Vec3v<Tag> away = away_from<shape>(d, *entry, p, square);
        const KernelValue<Tag> value =
            LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry->inverse_square)));
        sum.f = hn::MulAdd(hn::Set(d, entry->strength), value.k, sum.f);
        const V<Tag> slope = hn::Mul(hn::Set(d, entry->slope), value.dk);
        sum.slope = hn::MulAdd(slope, dot<Tag>(away, direction), sum.slope);
    }
}

// Calls visit.operator()<shape, kernel>(first, count) for each group that has entries.
template <class Counts, class Visit>
HWY_INLINE void for_groups(const Counts& counts, const Visit& visit) {
    std::size_t first = 0;
    for_shapes_and_kernels([&]<Shape shape, KernelKind kind>() HWY_ATTR
                           __attribute__((always_inline)) {
                               const std::uint32_t count = counts[group_of(shape, kind)];
                               if (count != 0) visit.template operator()<shape, kind>(first, count);
                               first += count;
                           });
}

template <class Tag>
HWY_INLINE void add(Tag d, const StageEntries<hn::TFromD<Tag>>& stage, const Vec3v<Tag>& p,
                    const Vec3v<Tag>& direction, FieldValue<Tag>& sum) {
    for_groups(stage.count,
               [&]<Shape shape, KernelKind kind>(std::size_t first, std::uint32_t count) HWY_ATTR {
                   add_group<shape, kind>(d, stage.entry.data() + first, count, p, direction, sum);
               });
}

template <class Tag>
HWY_INLINE FieldValue<Tag> evaluate(Tag d, const StageEntries<hn::TFromD<Tag>>& stage,
                                    double threshold, const Vec3v<Tag>& p,
                                    const Vec3v<Tag>& direction) {
    using Real = hn::TFromD<Tag>;
    FieldValue<Tag> sum{hn::Set(d, static_cast<Real>(-threshold)), hn::Zero(d)};
    add(d, stage, p, direction, sum);
    return sum;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
