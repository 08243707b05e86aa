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

// The sum of the nearest parts. A joined element with b > 0 is the greatest of its parts' fields, one
// with b < 0 the least: with the slopes of others in the place of theirs f' may be `above` more and
// `below` less, as far as they can have a say within `reach`, and `anywhere` more or less.
template <class Tag>
struct FieldValue {
    V<Tag> f, slope;
    V<Tag> above, below, anywhere;
};

template <class Tag>
HWY_INLINE FieldValue<Tag> no_field(Tag d, hn::TFromD<Tag> f) {
    const V<Tag> zero = hn::Zero(d);
    return {hn::Set(d, f), zero, zero, zero, zero};
}

// How far from p along the ray f is asked for: at most `reach`, and what two values of k b may be off by.
template <class Tag>
struct Vicinity {
    V<Tag> per_reach;  // at most 1 / reach
    V<Tag> error;
};

// `entry` leads to the first part, then to what follows the last. Within `reach` a part of an element
// with b > 0 whose F is less by D is no greater than if its slope were less by D / reach.
template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE void add_parts(Tag d, const BundleEntry<hn::TFromD<Tag>>*& entry, const Vec3v<Tag>& p,
                          const Vec3v<Tag>& direction, const Vicinity<Tag>& near,
                          V<Tag>& greatest_k, FieldValue<Tag>& sum) {
    const bool adds = entry->strength > 0;
    const V<Tag> strength = hn::Set(d, entry->strength);
    V<Tag> least = hn::Zero(d), k = least, slope = least, lowest = least, highest = least;
    V<Tag> least_tilted = least, most_tilted = least;
    bool is_first = true, joins = true;
    for (; joins; ++entry) {
        V<Tag> square;
        const Vec3v<Tag> away = away_from<shape>(d, *entry, p, square);
        const V<Tag> s = hn::Mul(square, hn::Set(d, entry->inverse_square));
        const KernelValue<Tag> value = LanesOf<kind>::at(d, s);
        const V<Tag> own =
            hn::Mul(hn::Mul(hn::Set(d, entry->slope), value.dk), dot<Tag>(away, direction));
        const V<Tag> tilt = hn::Mul(hn::Mul(strength, value.k), near.per_reach);
        joins = entry->joins != 0;
        if (is_first) {
            is_first = false;
            least = s;
            k = value.k;
            slope = lowest = highest = own;
            least_tilted = hn::Sub(own, tilt);
            most_tilted = hn::Add(own, tilt);
            continue;
        }
        const M<Tag> nearer = hn::Not(hn::Ge(s, least));
        least = hn::IfThenElse(nearer, s, least);
        k = hn::IfThenElse(nearer, value.k, k);
        slope = hn::IfThenElse(nearer, own, slope);
        lowest = hn::Min(lowest, own);
        highest = hn::Max(highest, own);
        least_tilted = hn::Min(least_tilted, hn::Sub(own, tilt));
        most_tilted = hn::Max(most_tilted, hn::Add(own, tilt));
    }
    greatest_k = k;
    sum.slope = hn::Add(sum.slope, slope);
    const V<Tag> anywhere = hn::Max(hn::Sub(highest, slope), hn::Sub(slope, lowest));
    sum.anywhere = hn::Add(sum.anywhere, anywhere);
    if (adds) {
        const V<Tag> tilt = hn::Mul(hn::Mul(strength, k), near.per_reach);
        const V<Tag> off = hn::Mul(near.error, near.per_reach);
        const V<Tag> above = hn::Add(hn::Sub(most_tilted, hn::Add(slope, tilt)), off);
        const V<Tag> below = hn::Add(hn::Sub(hn::Sub(slope, tilt), least_tilted), off);
        sum.above = hn::Add(sum.above, hn::Min(at_least_0(above), anywhere));
        sum.below = hn::Add(sum.below, hn::Min(at_least_0(below), anywhere));
    } else {
        sum.above = hn::Add(sum.above, anywhere);
        sum.below = hn::Add(sum.below, anywhere);
    }
}

template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE void add_group(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry, std::uint32_t count,
                          const Vec3v<Tag>& p, const Vec3v<Tag>& direction,
                          const Vicinity<Tag>& near, FieldValue<Tag>& sum) {
    const auto* const end = entry + count;
    if constexpr (SkeletonOf<shape>::is_joined) {
        while (entry != end) {
            const V<Tag> strength = hn::Set(d, entry->strength);
            V<Tag> k;
            add_parts<shape, kind>(d, entry, p, direction, near, k, sum);
            sum.f = hn::MulAdd(strength, k, sum.f);
        }
        return;
    }
    for (; entry != end; ++entry) {
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
                    const Vec3v<Tag>& direction, const Vicinity<Tag>& near, FieldValue<Tag>& sum) {
    for_groups(
        stage, [&]<Shape shape, KernelKind kind>(std::size_t first, std::uint32_t count) HWY_ATTR {
            add_group<shape, kind>(d, stage.entry.data() + first, count, p, direction, near, sum);
        });
}

template <class Tag>
HWY_INLINE FieldValue<Tag> evaluate(Tag d, const StageEntries<hn::TFromD<Tag>>& stage,
                                    double threshold, const Vec3v<Tag>& p,
                                    const Vec3v<Tag>& direction, const Vicinity<Tag>& near) {
    FieldValue<Tag> sum = no_field(d, static_cast<hn::TFromD<Tag>>(-threshold));
    add(d, stage, p, direction, near, sum);
    return sum;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
