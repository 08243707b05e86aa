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

// The sum of the nearest parts.
template <class Tag>
struct FieldValue {
    V<Tag> f, slope;
};

// Whether there are elements of several parts (core/shape/joined.h) in a stage. f is then one of several
// branches: one with b > 0 is the greatest of its parts' fields, one with b < 0 the least.
struct JoinedEntries {
    bool some_add = false, some_carve = false;
    [[nodiscard]] bool any() const { return some_add || some_carve; }
    void add(const JoinedEntries& others) {
        some_add = some_add || others.some_add;
        some_carve = some_carve || others.some_carve;
    }
};

// How far the slopes of f's other branches are from that of the nearest parts. Kept apart from the
// field's value, so that what has no such elements carries nothing along.
template <class Tag>
struct Branches {
    V<Tag> per_reach;  // at most 1 / reach: how far from p along the ray f is asked for
    V<Tag> error;      // of the difference of two values of b k
    // f' is that much more and that much less at the most, as far as others have a say within reach;
    // and more or less wherever they have.
    V<Tag> above, below, anywhere;

    HWY_INLINE void begin(V<Tag> to_per_reach, V<Tag> to_error) {
        per_reach = to_per_reach;
        error = to_error;
        above = below = anywhere = hn::Zero(Tag());
    }
};

// Returns the greatest k of the parts; `entry` leads to the first, then to what follows the last. Within reach a part of an element
// with b > 0 whose F is less by D is no greater than if its slope were less by D / reach.
template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE V<Tag> add_parts(Tag d, const BundleEntry<hn::TFromD<Tag>>*& entry, const Vec3v<Tag>& p,
                            const Vec3v<Tag>& direction, V<Tag>& slope_sum,
                            Branches<Tag>& branches) {
    using Real = hn::TFromD<Tag>;
    const bool adds = entry->strength > 0;
    const V<Tag> tilted = hn::Mul(hn::Set(d, entry->strength), branches.per_reach);
    struct Part {
        V<Tag> s, k, slope;
    };
    const auto part_of = [&](const BundleEntry<Real>& e) HWY_ATTR {
        V<Tag> square;
        const Vec3v<Tag> away = away_from<shape>(d, e, p, square);
        const V<Tag> s = hn::Mul(square, hn::Set(d, e.inverse_square));
        const KernelValue<Tag> value = LanesOf<kind>::at(d, s);
        return Part{s, value.k,
                    hn::Mul(hn::Mul(hn::Set(d, e.slope), value.dk), dot<Tag>(away, direction))};
    };
    Part best = part_of(*entry);
    V<Tag> lowest = best.slope, highest = best.slope;
    V<Tag> tilt = hn::Mul(tilted, best.k);
    V<Tag> least_tilted = hn::Sub(best.slope, tilt), most_tilted = hn::Add(best.slope, tilt);
    while ((entry++)->joins != 0) {
        const Part part = part_of(*entry);
        tilt = hn::Mul(tilted, part.k);
        lowest = hn::Min(lowest, part.slope);
        highest = hn::Max(highest, part.slope);
        least_tilted = hn::Min(least_tilted, hn::Sub(part.slope, tilt));
        most_tilted = hn::Max(most_tilted, hn::Add(part.slope, tilt));
        const M<Tag> nearer = hn::Not(hn::Ge(part.s, best.s));  // what is no number shows
        best = {hn::IfThenElse(nearer, part.s, best.s), hn::IfThenElse(nearer, part.k, best.k),
                hn::IfThenElse(nearer, part.slope, best.slope)};
    }
    slope_sum = hn::Add(slope_sum, best.slope);
    const V<Tag> anywhere = hn::Max(hn::Sub(highest, best.slope), hn::Sub(best.slope, lowest));
    V<Tag> above = anywhere, below = anywhere;
    if (adds) {
        tilt = hn::Mul(tilted, best.k);
        const V<Tag> off = hn::Mul(branches.error, branches.per_reach);
        above = hn::Add(hn::Sub(most_tilted, hn::Add(best.slope, tilt)), off);
        below = hn::Add(hn::Sub(hn::Sub(best.slope, tilt), least_tilted), off);
        above = hn::Min(at_least_0(above), anywhere);
        below = hn::Min(at_least_0(below), anywhere);
    }
    branches.above = hn::Add(branches.above, above);
    branches.below = hn::Add(branches.below, below);
    branches.anywhere = hn::Add(branches.anywhere, anywhere);
    return best.k;
}

// A function of its own, so that loops over other elements keep their registers.
template <Shape shape, KernelKind kind, class Tag>
HWY_NOINLINE void add_joined_group(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry,
                                   std::uint32_t count, const Vec3v<Tag>& p,
                                   const Vec3v<Tag>& direction, FieldValue<Tag>& sum,
                                   Branches<Tag>& branches) {
    for (const auto* const end = entry + count; entry != end;) {
        const V<Tag> strength = hn::Set(d, entry->strength);
        const V<Tag> k = add_parts<shape, kind>(d, entry, p, direction, sum.slope, branches);
        sum.f = hn::MulAdd(strength, k, sum.f);
    }
}

template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE void add_group(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry, std::uint32_t count,
                          const Vec3v<Tag>& p, const Vec3v<Tag>& direction, FieldValue<Tag>& sum,
                          Branches<Tag>& branches) {
    if constexpr (SkeletonOf<shape>::is_joined) {
        add_joined_group<shape, kind>(d, entry, count, p, direction, sum, branches);
        return;
    }
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

template <class Real>
JoinedEntries joined_entries(const StageEntries<Real>& stage) {
    JoinedEntries joined;
    for_groups(stage, [&]<Shape shape, KernelKind>(std::size_t first, std::uint32_t count) {
        if constexpr (SkeletonOf<shape>::is_joined) {
            for (std::uint32_t k = 0; k < count; ++k) {
                (stage.entry[first + k].strength > 0 ? joined.some_add : joined.some_carve) = true;
            }
        }
    });
    return joined;
}

// `branches` has begun where the stage has joined entries; else it is not looked at.
template <class Tag>
HWY_INLINE void add(Tag d, const StageEntries<hn::TFromD<Tag>>& stage, const Vec3v<Tag>& p,
                    const Vec3v<Tag>& direction, FieldValue<Tag>& sum, Branches<Tag>& branches) {
    for_groups(stage, [&]<Shape shape, KernelKind kind>(std::size_t first,
                                                        std::uint32_t count) HWY_ATTR {
        add_group<shape, kind>(d, stage.entry.data() + first, count, p, direction, sum, branches);
    });
}

template <class Tag>
HWY_INLINE FieldValue<Tag> evaluate(Tag d, const StageEntries<hn::TFromD<Tag>>& stage,
                                    double threshold, const Vec3v<Tag>& p,
                                    const Vec3v<Tag>& direction, Branches<Tag>& branches) {
    using Real = hn::TFromD<Tag>;
    FieldValue<Tag> sum{hn::Set(d, static_cast<Real>(-threshold)), hn::Zero(d)};
    add(d, stage, p, direction, sum, branches);
    return sum;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
