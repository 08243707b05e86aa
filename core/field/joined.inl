// The parts of one element, side by side in a list: what is known of them becomes what is known of the
// element (core/shape/joined.h).
#if defined(IVORY_CORE_FIELD_JOINED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_JOINED_INL
#undef IVORY_CORE_FIELD_JOINED_INL
#else
#define IVORY_CORE_FIELD_JOINED_INL
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/field/seen.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <Shape shape>
inline constexpr bool joined = SkeletonOf<shape>::is_joined;

// Of what was bounded part by part in first .. end, all of it still there: elements that cannot exceed
// the cut leave, and parts that another is nearer than on all of the stretch; of those they leave
// exactly what there was. Those that are kept know the greatest k of any, so that they share one fate.
// Returns the new end.
template <class List, class StrengthOf, class SourceOf, class Move>
std::size_t join_parts(List& list, std::size_t first, std::size_t end, double cut, double widened,
                       const StrengthOf& strength_of, const SourceOf& source_of, const Move& move,
                       PeakSums& sums) {
    std::size_t to = first;
    for (std::size_t from = first; from < end;) {
        const auto source = source_of(from);
        auto most = list.most[from], peak = list.peak[from];
        std::size_t next = from + 1;
        for (; next < end && source_of(next) == source; ++next) {
            most = std::min(most, list.most[next]);
            peak = std::max(peak, list.peak[next]);
        }
        const double strength = strength_of(from);
        const double value = std::abs(strength) * static_cast<double>(peak) * widened;
        if (value <= cut) {
            (strength > 0 ? sums.left_out_above : sums.left_out_below) += value;
        } else {
            sums.magnitude += value;
            if (strength > 0) sums.above += value;
            for (std::size_t i = from; i < next; ++i) {
                if (list.least[i] > most) continue;
                if (i != to) move(i, to);
                list.whole[to] = peak;
                ++to;
            }
        }
        from = next;
    }
    return to;
}

// With all that is known of it before `bend`, but `inverse`.
HWY_INLINE void move_local(LocalElements& list, std::size_t from, std::size_t to) {
    list.element[to] = list.element[from];
    list.source[to] = list.source[from];
    for (auto* column : {&list.x, &list.y, &list.z, &list.strength, &list.inverse_square, &list.mx,
                         &list.my, &list.mz, &list.parameter, &list.length, &list.taper_rate,
                         &list.least, &list.most, &list.peak, &list.whole}) {
        (*column)[to] = (*column)[from];
    }
}

// One bit for each of so many lanes from i on: the next one, before `end`, is another part of the same.
template <class SourceOf>
HWY_INLINE std::uint32_t joins_of(std::size_t i, std::size_t end, std::size_t lanes,
                                  const SourceOf& source_of) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < lanes && i + k + 1 < end; ++k) {
        bits |= std::uint32_t{source_of(i + k) == source_of(i + k + 1)} << k;
    }
    return bits;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
