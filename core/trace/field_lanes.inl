// f and its slope at one place of each ray: the sum over the entries of a stage.
#if defined(IVORY_CORE_TRACE_FIELD_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_FIELD_LANES_INL
#undef IVORY_CORE_TRACE_FIELD_LANES_INL
#else
#define IVORY_CORE_TRACE_FIELD_LANES_INL
#endif

#include <cmath>
#include <cstddef>

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
    // What is added for feet that each ray proves (ProvedFoot): to the bounds of f, to those of f'', and, where
    // it was asked for less than it is used for, to `anywhere`.
    V<Tag> reach;  // at least that
    V<Tag> more, less, rise, fall, beyond;

    HWY_INLINE void begin(V<Tag> to_reach, V<Tag> to_per_reach, V<Tag> to_error) {
        reach = to_reach;
        per_reach = to_per_reach;
        error = to_error;
        above = below = anywhere = hn::Zero(Tag());
        more = less = rise = fall = beyond = hn::Zero(Tag());
    }
};

// Returns the greatest k of the parts; `entry` leads to the first, then to what follows the last. Within
// reach a part of an element with b > 0 whose F is less by D is no greater than if its slope were less by
// D / reach.
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

template <class Real>
bool any_proof(const BundleEntry<Real>* entry) {
    for (;; ++entry) {
        if (entry->proof() != 0) return true;
        if (entry->joins == 0) return false;
    }
}

// The same where some part's foot is to be proved. Of a part F / b is at least k at the place that was found,
// and at most k of what its square may be less; the tilts are those of the latter. A part that is farther than
// another by more than both can change within reach has no say there.
template <Shape shape, KernelKind kind, class Tag>
HWY_NOINLINE V<Tag> add_proved_parts(Tag d, const BundleEntry<hn::TFromD<Tag>>*& entry,
                                     const Vec3v<Tag>& p, const Vec3v<Tag>& direction,
                                     V<Tag>& slope_sum, Branches<Tag>& branches) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    struct Part {
        V<Tag> square, k, most, slope;
        V<Tag> off, bend, nearest;  // of F'; of F''; a lower bound of the distance
        M<Tag> in_reach;
    };
    constexpr std::size_t room = 24;
    const bool adds = entry->strength > 0;
    const V<Tag> zero = hn::Zero(d), none = hn::Set(d, boundless<Real>);
    const V<Tag> unscaled = constant(d, 1 / LanesOf<kind>::argument_scale);
    const auto part_of = [&](const BundleEntry<Real>& e) HWY_ATTR {
        Part part;
        Vec3v<Tag> away;
        const V<Tag> factor = hn::Set(d, e.inverse_square);
        part.off = part.bend = part.nearest = zero;
        part.in_reach = hn::FirstN(d, 0);
        V<Tag> least = zero;  // of the square
        if (e.proof() != 0) {
            const ProvedFoot<Tag> foot = LanesOfShape<shape>::proved_foot(d, e, p, branches.reach);
            away = foot.away;
            part.square = foot.square;
            least = at_least_0(hn::Sub(foot.square, foot.slack));
            part.off = hn::Mul(hn::Set(d, e.proof()), foot.pull);
            part.bend = hn::Mul(hn::Set(d, e.proof()), foot.bend);
            part.in_reach = foot.in_reach;
        } else {
            away = away_from<shape>(d, e, p, part.square);
        }
        const KernelValue<Tag> value = LanesOf<kind>::at(d, hn::Mul(part.square, factor));
        part.k = part.most = value.k;
        if (e.proof() != 0) {
            const V<Tag> s =
                hn::Mul(hn::Mul(least, factor), hn::Mul(unscaled, hn::Set(d, Margin::less)));
            part.most = hn::Max(value.k, LanesOf<kind>::peak(d, s));
            part.nearest = hn::Mul(hn::Sqrt(least), hn::Set(d, Margin::less));
        }
        part.slope = hn::Mul(hn::Mul(hn::Set(d, e.slope), value.dk), dot<Tag>(away, direction));
        return part;
    };
    Part parts[room];
    std::size_t count = 0;
    Part best;
    V<Tag> most = zero;
    const auto take = [&](const Part& part) HWY_ATTR {
        if (count == 0) {
            best = part;
        } else {
            const M<Tag> nearer = hn::Not(hn::Ge(part.square, best.square));
            best.square = hn::IfThenElse(nearer, part.square, best.square);
            best.k = hn::IfThenElse(nearer, part.k, best.k);
            best.slope = hn::IfThenElse(nearer, part.slope, best.slope);
        }
        most = hn::Max(most, part.most);
        ++count;
    };
    const V<Tag> strength = hn::Set(d, entry->strength);
    const V<Tag> tilted = hn::Mul(strength, branches.per_reach);
    V<Tag> lowest = hn::Neg(none), highest = none, least_tilted = none, most_tilted = none;
    V<Tag> bend = zero;
    M<Tag> in_reach = hn::FirstN(d, 0);
    bool begun = false;
    const auto say = [&](const Part& part, M<Tag> has_say) HWY_ATTR {
        const V<Tag> slope = hn::IfThenElse(has_say, part.slope, best.slope);
        const V<Tag> off = hn::IfThenElseZero(has_say, part.off);
        const V<Tag> tilt = hn::Mul(tilted, hn::IfThenElse(has_say, part.most, most));
        const V<Tag> up = hn::Add(slope, off), down = hn::Sub(slope, off);
        lowest = begun ? hn::Min(lowest, down) : down;
        highest = begun ? hn::Max(highest, up) : up;
        least_tilted = begun ? hn::Min(least_tilted, hn::Sub(down, tilt)) : hn::Sub(down, tilt);
        most_tilted = begun ? hn::Max(most_tilted, hn::Add(up, tilt)) : hn::Add(up, tilt);
        bend = hn::Max(bend, hn::IfThenElseZero(has_say, part.bend));
        begun = true;
    };
    const M<Tag> all = hn::FirstN(d, hn::Lanes(d));
    Part beyond_room;
    std::size_t kept = 0;
    for (bool goes_on = true; goes_on; ++entry) {
        goes_on = entry->joins != 0;
        Part& part = kept < room ? parts[kept] : beyond_room;
        part = part_of(*entry);
        take(part);
        in_reach = hn::Or(in_reach, part.in_reach);
        if (kept < room)
            ++kept;
        else
            say(part, all);
    }
    const V<Tag> far =
        hn::MulAdd(branches.reach, hn::Set(d, 2 * Margin::more),
                   hn::Mul(hn::Sqrt(best.square), hn::Set(d, Margin::more * Margin::more)));
    for (std::size_t k = 0; k < kept; ++k) {
        const M<Tag> has_no_say = hn::Gt(parts[k].nearest, far);
        in_reach = hn::Or(in_reach, has_no_say);
        say(parts[k], hn::AndNot(has_no_say, all));
    }

    slope_sum = hn::Add(slope_sum, best.slope);
    const V<Tag> anywhere = hn::Max(hn::Sub(highest, best.slope), hn::Sub(best.slope, lowest));
    V<Tag> above = anywhere, below = anywhere;
    const V<Tag> open = hn::Mul(hn::Sub(most, best.k), hn::Abs(strength));
    const V<Tag> limited = hn::IfThenElseZero(in_reach, none);
    if (adds) {
        const V<Tag> tilt = hn::Mul(tilted, most);
        const V<Tag> off = hn::Mul(branches.error, branches.per_reach);
        above = hn::Add(hn::Sub(most_tilted, hn::Add(best.slope, tilt)), off);
        below = hn::Add(hn::Sub(hn::Sub(best.slope, tilt), least_tilted), off);
        above = hn::Min(at_least_0(above), anywhere);
        below = hn::Min(at_least_0(below), anywhere);
        branches.more = hn::Add(branches.more, open);
        branches.rise = hn::Add(branches.rise, bend);
    } else {
        branches.less = hn::Add(branches.less, open);
        branches.fall = hn::Add(branches.fall, bend);
    }
    branches.above = hn::Add(branches.above, above);
    branches.below = hn::Add(branches.below, below);
    branches.anywhere = hn::Add(branches.anywhere, anywhere);
    branches.beyond = hn::Add(branches.beyond, limited);
    return best.k;
}

template <Shape shape, KernelKind kind, class Tag>
HWY_INLINE V<Tag> add_element(Tag d, const BundleEntry<hn::TFromD<Tag>>*& entry,
                              const Vec3v<Tag>& p, const Vec3v<Tag>& direction, V<Tag>& slope_sum,
                              Branches<Tag>& branches) {
    if constexpr (proves_feet<shape>) {
        if (any_proof(entry)) {
            return add_proved_parts<shape, kind>(d, entry, p, direction, slope_sum, branches);
        }
    }
    return add_parts<shape, kind>(d, entry, p, direction, slope_sum, branches);
}

// The greatest k of an element's parts, some of whose feet are to be proved, of which the last is left in `entry`;
// and to `open` what |F| may be more at p.
template <Shape shape, KernelKind kind, class Tag>
HWY_NOINLINE V<Tag> greatest_part(Tag d, const BundleEntry<hn::TFromD<Tag>>*& entry,
                                  const Vec3v<Tag>& p, V<Tag>& open) {
    using Margin = Margins<hn::TFromD<Tag>>;
    const V<Tag> unscaled = constant(d, 1 / LanesOf<kind>::argument_scale * double{Margin::less});
    V<Tag> greatest = hn::Zero(d), most = greatest;
    for (;; ++entry) {
        const V<Tag> factor = hn::Set(d, entry->inverse_square);
        V<Tag> square, of_least = hn::Zero(d);
        if (entry->proof() != 0) {
            const ProvedFoot<Tag> foot =
                LanesOfShape<shape>::proved_foot(d, *entry, p, hn::Zero(d));
            square = foot.square;
            const V<Tag> least = at_least_0(hn::Sub(square, foot.slack));
            of_least = LanesOf<kind>::peak(d, hn::Mul(hn::Mul(least, factor), unscaled));
        } else {
            away_from<shape>(d, *entry, p, square);
        }
        const V<Tag> k = LanesOf<kind>::at(d, hn::Mul(square, factor)).k;
        greatest = hn::Max(greatest, k);
        most = hn::Max(most, hn::Max(k, of_least));
        if (entry->joins == 0) break;
    }
    open = hn::MulAdd(hn::Set(d, std::abs(entry->strength)), hn::Sub(most, greatest), open);
    return greatest;
}

// A function of its own, so that loops over other elements keep their registers.
template <Shape shape, KernelKind kind, class Tag>
HWY_NOINLINE void add_joined_group(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry,
                                   std::uint32_t count, const Vec3v<Tag>& p,
                                   const Vec3v<Tag>& direction, FieldValue<Tag>& sum,
                                   Branches<Tag>& branches) {
    for (const auto* const end = entry + count; entry != end;) {
        const V<Tag> strength = hn::Set(d, entry->strength);
        const V<Tag> k = add_element<shape, kind>(d, entry, p, direction, sum.slope, branches);
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
