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

// Calls visit.operator()<shape, kernel>(first, count) for each group that has entries: the groups of
// a shape are asked for only where it has any, since this stands in the innermost loops.
template <class Real, class Visit>
HWY_INLINE void for_groups(const StageEntries<Real>& stage, const Visit& visit) {
    const std::uint64_t present = stage.present;
    std::size_t first = 0;
    for_shapes([&]<Shape shape>() HWY_ATTR __attribute__((always_inline)) {
        constexpr std::uint64_t all = ((std::uint64_t{1} << kernel_count) - 1)
                                      << group_of(shape, KernelKind{});
        if ((present & all) == 0) return;
        for_kernels<shape>([&]<Shape, KernelKind kind>() HWY_ATTR __attribute__((always_inline)) {
            constexpr std::size_t group = group_of(shape, kind);
            if ((present >> group & 1) == 0) return;
            const std::uint32_t count = stage.count[group];
            visit.template operator()<shape, kind>(first, count);
            first += count;
        });
    });
}

template <class Tag>
HWY_INLINE void add(Tag d, const StageEntries<hn::TFromD<Tag>>& stage, const Vec3v<Tag>& p,
                    const Vec3v<Tag>& direction, FieldValue<Tag>& sum) {
    for_groups(stage,
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
