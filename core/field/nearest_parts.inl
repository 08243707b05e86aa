// Of the parts of one element those stay that may be the nearest to some point of a stretch: a sharper test
// than that of their distances (join_parts in core/field/joined.inl), which overlap where the parts are as far
// away.
#if defined(IVORY_CORE_FIELD_NEAREST_PARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_NEAREST_PARTS_INL
#undef IVORY_CORE_FIELD_NEAREST_PARTS_INL
#else
#define IVORY_CORE_FIELD_NEAREST_PARTS_INL
#endif

#include "core/field/joined.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// The feet of some parts of a group, on all of a ball with the radius H about the middle M of a stretch: with c a
// foot there, no place y of the part makes |M - y|^2 - 2 H |c - y| less than `least`, and |M - c|^2 is at
// most `most`, both made up for what places are off by. As |y - q| <= |y - c| + |c - q| and, for p in the ball,
//     |p - y|^2 - |p - q|^2 >= |M - y|^2 - |M - q|^2 - 2 H |y - q|,
// a part leaves where least - most of the other's q exceeds 2 H |c - q|.
template <Shape shape, class Tag, class Load>
HWY_INLINE void find_feet(Tag d, const Reach<hn::TFromD<Tag>>& reach, std::size_t first,
                          std::size_t end, hn::TFromD<Tag> radius, const Load& load,
                          PartFeet<hn::TFromD<Tag>>& feet) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    const Real middle = Real{0.5} * (reach.begin + reach.end);
    const V<Tag> H = hn::Set(d, radius), widened = hn::Set(d, Margin::more);
    feet.make_room(end - first);
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const Seen<Tag, shape> e = load(i);
        const PartFoot<Tag> part =
            LanesOfShape<shape>::part_foot(e, reach, middle, H, error_of(d, e.magnitude, reach));
        const ProvedFoot<Tag>& foot = part.foot;
        const V<Tag> distance = hn::Sqrt(foot.square);
        const V<Tag> less = hn::MulAdd(
            H, hn::MulAdd(hn::Mul(H, constant(d, 0.5)), foot.bend, foot.pull), foot.slack);
        const V<Tag> lost =
            hn::Mul(hn::Mul(part.error, constant(d, 4)),
                    hn::Add(hn::Add(distance, part.length), hn::Add(H, part.error)));
        const V<Tag> rounded = hn::Mul(hn::Add(foot.square, less), hn::Set(d, Margin::margin));
        const V<Tag> least =
            hn::Sub(foot.square, hn::MulAdd(hn::Add(less, lost), widened, rounded));
        const std::size_t k = i - first;
        const V<Tag> never = hn::Set(d, infinity<Real>),
                     most = hn::MulAdd(hn::Add(foot.square, lost), widened, rounded);
        hn::StoreU(hn::IfThenElse(part.never, never, least), d, &feet.least[k]);
        hn::StoreU(hn::IfThenElse(part.never, never, most), d, &feet.most[k]);
        hn::StoreU(foot.away.x, d, &feet.x[k]);
        hn::StoreU(foot.away.y, d, &feet.y[k]);
        hn::StoreU(foot.away.z, d, &feet.z[k]);
    }
}

// The parts first .. end of a group that may be nearest on the stretch, from `to` on; returns the new end.
template <Shape shape, class Tag, class Load, class SourceOf, class Move>
std::size_t keep_nearest(Tag d, const Reach<hn::TFromD<Tag>>& reach, std::size_t first,
                         std::size_t end, std::size_t to, const Load& load,
                         const SourceOf& source_of, const Move& move,
                         PartFeet<hn::TFromD<Tag>>& feet) {
    using Real = hn::TFromD<Tag>;
    const Real H = (Real{0.5} * (reach.end - reach.begin) + reach.aside()) * Margins<Real>::more;
    find_feet<shape>(d, reach, first, end, H, load, feet);
    const Real widened = 4 * H * H * Margins<Real>::more * Margins<Real>::more;
    for (std::size_t from = first, next; from < end; from = next) {
        const auto source = source_of(from);
        std::size_t best = from - first;
        for (next = from + 1; next < end && source_of(next) == source; ++next) {
            if (feet.most[next - first] < feet.most[best]) best = next - first;
        }
        for (std::size_t i = from; i < next; ++i) {
            const std::size_t k = i - first;
            const Real ahead = feet.least[k] - feet.most[best];
            const Real x = feet.x[k] - feet.x[best], y = feet.y[k] - feet.y[best],
                       z = feet.z[k] - feet.z[best];
            if (k != best && ahead > 0 && ahead * ahead > widened * (x * x + y * y + z * z))
                continue;
            if (i != to) move(i, to);
            ++to;
        }
    }
    return to;
}

template <std::size_t... shape>
constexpr std::uint64_t groups_that_compare_feet(std::index_sequence<shape...>) {
    constexpr std::uint64_t kernels = (std::uint64_t{1} << kernel_count) - 1;
    return ((compares_feet<static_cast<Shape>(shape)>
                 ? kernels << group_of(static_cast<Shape>(shape), KernelKind{})
                 : 0) |
            ...);
}

// Of a whole list; keep(first, end, to) of a group that compares feet returns where what stays of it ends, and
// move(from, to) moves any other element.
template <class List, class Keep, class Move>
void keep_nearest_of(List& list, const Keep& keep, const Move& move) {
    constexpr std::uint64_t comparing =
        groups_that_compare_feet(std::make_index_sequence<field_shape_count>());
    const GroupStarts before = list.first;
    if ((before.present() & comparing) == 0) return;
    std::size_t count = 0;
    list.first.clear();
    for_groups_of(before, [&]<Shape shape, KernelKind>(std::size_t group, std::size_t first,
                                                       std::size_t end) HWY_ATTR {
        list.first.begin(group, count);
        if constexpr (compares_feet<shape>) {
            count = keep.template operator()<shape>(first, end, count);
        } else {
            for (std::size_t i = first; i < end; ++i, ++count) {
                if (i != count) move(i, count);
            }
        }
    });
    list.first.end(count);
}

void keep_nearest_parts(const Field& field, const Stretch& stretch, double scale,
                        ActiveElements& active, PartFeet<double>& feet) {
    const D d;
    const Reach<double> reach = reach_of(stretch);
    const auto move = [&](std::size_t from, std::size_t to) {
        active.element[to] = active.element[from];
        for (auto* column : {&active.least, &active.most, &active.peak, &active.whole}) {
            (*column)[to] = (*column)[from];
        }
    };
    keep_nearest_of(
        active,
        [&]<Shape shape>(std::size_t first, std::size_t end, std::size_t to) HWY_ATTR {
            return keep_nearest<shape>(
                d, reach, first, end, to,
                [&](std::size_t i) HWY_ATTR {
                    return seen_in_field<shape>(field, stretch, scale,
                                                hn::LoadU(I(), &active.element[i]));
                },
                [&](std::size_t i) {
                    return field.source[static_cast<std::size_t>(active.element[i])];
                },
                move, feet);
        },
        move);
    active.end(active.size());
}

void keep_nearest_parts_local(LocalElements& near, const LocalStretch& stretch,
                              PartFeet<float>& feet) {
    const F d;
    const Reach<float> reach = reach_of(stretch, near);
    const auto move = [&](std::size_t from, std::size_t to) { move_local(near, from, to); };
    keep_nearest_of(
        near,
        [&]<Shape shape>(std::size_t first, std::size_t end, std::size_t to) HWY_ATTR {
            return keep_nearest<shape>(
                d, reach, first, end, to,
                [&](std::size_t i)
                    HWY_ATTR { return seen_local<shape>(near, near.numbers, reach, i); },
                [&](std::size_t i) { return near.source[i]; }, move, feet);
        },
        move);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
