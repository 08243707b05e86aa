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
template <Shape shape, class Tag>
struct FootOfPart {
    using Real = hn::TFromD<Tag>;
    V<Tag> x, y, z, least, most;
    V<Tag> at, q, pull, lower;  // of what is narrowed down

    HWY_INLINE FootOfPart(Tag d, const Seen<Tag, shape>& e, const Reach<Real>& reach, V<Tag> H) {
        using Margin = Margins<Real>;
        const Real middle = Real{0.5} * (reach.begin + reach.end);
        const PartFoot<Tag> part =
            LanesOfShape<shape>::part_foot(e, reach, middle, H, error_of(d, e.magnitude, reach));
        const ProvedFoot<Tag>& foot = part.foot;
        const V<Tag> widened = hn::Set(d, Margin::more), never = hn::Set(d, infinity<Real>);
        const V<Tag> within = hn::MulAdd(
            H, hn::MulAdd(hn::Mul(H, constant(d, 0.5)), foot.bend, foot.pull), foot.slack);
        const V<Tag> lost =
            hn::Mul(hn::Mul(part.error, constant(d, 4)),
                    hn::Add(hn::Add(hn::Sqrt(foot.square), part.length), hn::Add(H, part.error)));
        const V<Tag> rounded = hn::Mul(hn::Add(foot.square, within), hn::Set(d, Margin::margin));
        const V<Tag> off = hn::MulAdd(lost, widened, rounded);
        least = hn::IfThenElse(part.never, never,
                               hn::Sub(hn::Sub(foot.square, hn::Mul(within, widened)), off));
        most = hn::IfThenElse(part.never, never, hn::Add(foot.square, off));
        x = foot.away.x;
        y = foot.away.y;
        z = foot.away.z;
        if constexpr (narrows<shape>) {
            at = part.at;
            q = part.q;
            pull = part.pull;
            lower = hn::Sub(foot.square, off);
        }
    }
    HWY_INLINE void store(PartFeet<Real>& feet, std::size_t k) const {
        const Tag d;
        hn::StoreU(x, d, &feet.x[k]);
        hn::StoreU(y, d, &feet.y[k]);
        hn::StoreU(z, d, &feet.z[k]);
        hn::StoreU(least, d, &feet.least[k]);
        hn::StoreU(most, d, &feet.most[k]);
        if constexpr (narrows<shape>) {
            hn::StoreU(at, d, &feet.at[k]);
            hn::StoreU(q, d, &feet.q[k]);
            hn::StoreU(pull, d, &feet.pull[k]);
            hn::StoreU(lower, d, &feet.lower[k]);
        }
    }
    HWY_INLINE void take(M<Tag> those, const FootOfPart& other) {
        x = hn::IfThenElse(those, other.x, x);
        y = hn::IfThenElse(those, other.y, y);
        z = hn::IfThenElse(those, other.z, z);
        least = hn::IfThenElse(those, other.least, least);
        most = hn::IfThenElse(those, other.most, most);
        at = hn::IfThenElse(those, other.at, at);
        q = hn::IfThenElse(those, other.q, q);
        pull = hn::IfThenElse(those, other.pull, pull);
        lower = hn::IfThenElse(those, other.lower, lower);
    }
};

// The ends of pieces lie on a grid, so that they are exact.
template <class Real>
inline constexpr Real piece_grid = 256;

// Of the parts first .. end. Where nothing is known of an arc's piece as a whole it is `halved`: the second half's
// are in `second`, which else says nothing.
template <Shape shape, class Tag, class Load>
HWY_INLINE void find_feet(Tag d, const Reach<hn::TFromD<Tag>>& reach, std::size_t first,
                          std::size_t end, hn::TFromD<Tag> radius, const Load& load,
                          PartFeet<hn::TFromD<Tag>>& feet, PartFeet<hn::TFromD<Tag>>& second) {
    using Real = hn::TFromD<Tag>;
    const V<Tag> H = hn::Set(d, radius);
    feet.make_room(end - first);
    if constexpr (narrows<shape>) second.make_room(end - first);
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        Seen<Tag, shape> e = load(i);
        FootOfPart<shape, Tag> foot(d, e, reach, H);
        if constexpr (narrows<shape>) {
            const V<Tag> never = hn::Set(d, infinity<Real>), whole = e.m.y;
            const M<Tag> halved =
                hn::And(hn::And(hn::FirstN(d, end - i), hn::Lt(foot.least, never)),
                        hn::And(hn::Not(hn::Gt(foot.q, hn::Zero(d))),
                                hn::Gt(whole, hn::Set(d, 4 / piece_grid<Real>))));
            const std::size_t k = i - first;
            hn::StoreU(never, d, &second.most[k]);
            hn::StoreU(hn::IfThenElseZero(halved, constant(d, 1)), d, &feet.halved[k]);
            if (!hn::AllFalse(d, halved)) {
                const V<Tag> half = hn::Mul(whole, constant(d, 0.5));
                e.m.y = half;
                e.m.x = hn::Add(e.m.x, half);
                FootOfPart<shape, Tag> other(d, e, reach, H);
                e.m.x = hn::Sub(e.m.x, whole);
                foot.take(halved, FootOfPart<shape, Tag>(d, e, reach, H));
                other.most = hn::IfThenElse(halved, other.most, never);
                other.store(second, k);
            }
        }
        foot.store(feet, i - first);
    }
}

template <class Real>
struct Piece {
    Real middle, half;
};

// The place q of an element that is about the nearest to M, from there, and |M - q|^2 at most.
template <class Real>
struct NearestPlace {
    Real x, y, z, most;
};

// One part, or half of one, beside that place.
template <class Real>
struct PartBeside {
    Real apart_square, ahead;

    PartBeside(const PartFeet<Real>& feet, std::size_t k, const NearestPlace<Real>& q) {
        const Real x = feet.x[k] - q.x, y = feet.y[k] - q.y, z = feet.z[k] - q.z;
        apart_square = x * x + y * y + z * z;
        ahead = feet.least[k] - q.most;
    }
    // What is no number stays.
    [[nodiscard]] bool leaves(Real H) const {
        constexpr Real widened = 4 * Margins<Real>::more * Margins<Real>::more;
        return ahead > 0 && ahead * ahead > widened * (H * H) * apart_square;
    }
};

// The piece of a piece of an arc where places may be nearer than q is to some point of the ball: with `lower` the
// square at `at` and C = lower - q.most - 2 H |c - q| all places leave for which
//     C - 2 pull |y - at| + q |y - at|^2 > 0.
template <class Real>
Piece<Real> narrowed(const PartFeet<Real>& feet, std::size_t k, const NearestPlace<Real>& place,
                     Real apart, Real H, const Piece<Real>& piece) {
    constexpr Real grid = piece_grid<Real>, widened = 1 + Real{0x1p-12};
    const auto [middle, half] = piece;
    const Real q = feet.q[k], pull = feet.pull[k] * widened;
    if (!(q > 0) || half * grid <= 2) return piece;
    const Real C = feet.lower[k] - place.most - 2 * H * apart * widened;
    const Real root =
        std::sqrt(std::max(pull * pull - q * C * (C > 0 ? 1 / widened : widened), Real{0}));
    const Real way = (pull + root) / q * widened + Real{0x1p-12};
    if (!(way < 2)) return piece;
    const Real from = std::max(feet.at[k] - way, Real{-1}),
               to = std::min(feet.at[k] + way, Real{1});
    const Real begin = std::max(std::floor((middle + half * from) * grid) / grid, middle - half),
               end = std::min(std::ceil((middle + half * to) * grid) / grid, middle + half);
    if (!(end > begin) || end - begin > Real{1.75} * half) return piece;
    return {Real{0.5} * (begin + end), Real{0.5} * (end - begin)};
}

// What stays of an arc's piece; none: half = 0.
template <class Real>
Piece<Real> what_stays(const PartFeet<Real>& feet, const PartFeet<Real>& second, std::size_t k,
                       const NearestPlace<Real>& place, Real H, const Piece<Real>& piece) {
    const auto of = [&](const PartFeet<Real>& those, const Piece<Real>& whole) {
        const PartBeside<Real> beside(those, k, place);
        if (beside.leaves(H)) return Piece<Real>{whole.middle, 0};
        return narrowed(those, k, place, std::sqrt(beside.apart_square), H, whole);
    };
    if (feet.halved[k] == 0) return of(feet, piece);
    const Real half = Real{0.5} * piece.half;
    const Piece<Real> a = of(feet, {piece.middle - half, half}),
                      b = of(second, {piece.middle + half, half});
    if (a.half == 0) return b;
    if (b.half == 0) return a;
    const Real begin = a.middle - a.half, end = b.middle + b.half;
    return {Real{0.5} * (begin + end), Real{0.5} * (end - begin)};
}

// The parts first .. end of a group that may be nearest on the stretch, from `to` on; returns the new end.
template <Shape shape, class Tag, class Load, class SourceOf, class Move, class PieceOf, class Put>
std::size_t keep_nearest(Tag d, const Reach<hn::TFromD<Tag>>& reach, std::size_t first,
                         std::size_t end, std::size_t to, const Load& load,
                         const SourceOf& source_of, const Move& move, const PieceOf& piece_of,
                         const Put& put, PartFeet<hn::TFromD<Tag>>& feet,
                         PartFeet<hn::TFromD<Tag>>& second) {
    using Real = hn::TFromD<Tag>;
    const Real H = (Real{0.5} * (reach.end - reach.begin) + reach.aside()) * Margins<Real>::more;
    find_feet<shape>(d, reach, first, end, H, load, feet, second);
    for (std::size_t from = first, next; from < end; from = next) {
        const auto source = source_of(from);
        NearestPlace<Real> nearest{0, 0, 0, infinity<Real>};
        const auto look = [&](const PartFeet<Real>& those, std::size_t k) {
            if (!(those.most[k] < nearest.most)) return;
            nearest = {those.x[k], those.y[k], those.z[k], those.most[k]};
        };
        for (next = from; next < end && source_of(next) == source; ++next) {
            look(feet, next - first);
            if constexpr (narrows<shape>) look(second, next - first);
        }
        for (std::size_t i = from; i < next; ++i) {
            const std::size_t k = i - first;
            if constexpr (narrows<shape>) {
                const Piece<Real> piece = what_stays(feet, second, k, nearest, H, piece_of(i));
                if (piece.half == 0) continue;
                if (i != to) move(i, to);
                put(to, piece);
            } else {
                if (PartBeside<Real>(feet, k, nearest).leaves(H)) continue;
                if (i != to) move(i, to);
            }
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
void keep_nearest_of(List& list, GroupStarts& before, const Keep& keep, const Move& move) {
    constexpr std::uint64_t comparing =
        groups_that_compare_feet(std::make_index_sequence<field_shape_count>());
    if ((list.first.present() & comparing) == 0) return;
    before = list.first;
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
                        ActiveElements& active, BothFeet<double>& feet) {
    const D d;
    const Reach<double> reach = reach_of(stretch);
    const auto move = [&](std::size_t from, std::size_t to) {
        active.element[to] = active.element[from];
        for (auto* column : {&active.least, &active.most, &active.peak, &active.whole,
                             &active.piece_middle, &active.piece_half}) {
            (*column)[to] = (*column)[from];
        }
    };
    keep_nearest_of(
        active, feet.before,
        [&]<Shape shape>(std::size_t first, std::size_t end, std::size_t to) HWY_ATTR {
            return keep_nearest<shape>(
                d, reach, first, end, to,
                [&](std::size_t i)
                    HWY_ATTR { return seen_active<shape>(field, stretch, scale, active, i); },
                [&](std::size_t i) {
                    return field.source[static_cast<std::size_t>(active.element[i])];
                },
                move,
                [&](std::size_t i) {
                    return active.is_whole
                               ? Piece<double>{0, 1}
                               : Piece<double>{active.piece_middle[i], active.piece_half[i]};
                },
                [&](std::size_t i, const Piece<double>& piece) {
                    active.piece_middle[i] = piece.middle;
                    active.piece_half[i] = piece.half;
                },
                feet.feet, feet.second);
        },
        move);
    active.end(active.size());
    active.is_whole = false;
}

void keep_nearest_parts_local(LocalElements& near, const LocalStretch& stretch,
                              BothFeet<float>& feet) {
    const F d;
    const Reach<float> reach = reach_of(stretch, near);
    const auto move = [&](std::size_t from, std::size_t to) { move_local(near, from, to); };
    keep_nearest_of(
        near, feet.before,
        [&]<Shape shape>(std::size_t first, std::size_t end, std::size_t to) HWY_ATTR {
            return keep_nearest<shape>(
                d, reach, first, end, to,
                [&](std::size_t i)
                    HWY_ATTR { return seen_local<shape>(near, near.numbers, reach, i); },
                [&](std::size_t i) { return near.source[i]; }, move,
                [&](std::size_t i) {
                    return Piece<float>{near.mx[i], near.my[i]};
                },
                [&](std::size_t i, const Piece<float>& piece) {
                    near.mx[i] = piece.middle;
                    near.my[i] = piece.half;
                },
                feet.feet, feet.second);
        },
        move);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
