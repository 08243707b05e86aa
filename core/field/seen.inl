// The elements of a field as the lanes see them from a stretch of a bundle.
#if defined(IVORY_CORE_FIELD_SEEN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_SEEN_INL
#undef IVORY_CORE_FIELD_SEEN_INL
#else
#define IVORY_CORE_FIELD_SEEN_INL
#endif

#include <cmath>
#include <vector>

#include "core/field/bundle_steps.h"
#include "core/shape/shape_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <Shape shape>
inline constexpr bool has_axis = SkeletonOf<shape>::has_axis;
// Whether the skeleton is as long as m, and not of the size of `parameter`.
template <Shape shape>
inline constexpr bool has_length = SkeletonOf<shape>::m_power == 1;

template <Shape shape>
inline constexpr bool tapers = SkeletonOf<shape>::is_taper;
template <Shape shape>
inline constexpr bool numbered = SkeletonOf<shape>::has_numbers;

HWY_INLINE Reach<double> reach_of(const Stretch& s) {
    return {s.axis, {}, s.begin, s.end, s.spread, s.radius, 0, s.end};
}

HWY_INLINE Reach<float> reach_of(const LocalStretch& s) {
    const auto narrow = [](const Vec3d& v) {
        return Vec3<float>{static_cast<float>(v.x), static_cast<float>(v.y),
                           static_cast<float>(v.z)};
    };
    const double magnitude = std::fmax(std::abs(s.begin), std::abs(s.end)) + std::abs(s.base.x) +
                             std::abs(s.base.y) + std::abs(s.base.z);
    return {narrow(s.axis),
            narrow(s.base),
            static_cast<float>(s.begin),
            static_cast<float>(s.end),
            static_cast<float>(s.spread * (1 + 0x1p-22)),
            static_cast<float>(s.radius * (1 + 0x1p-22)),
            static_cast<float>(s.t_offset * (1 + 0x1p-22)),
            static_cast<float>(magnitude * (1 + 0x1p-22))};
}

// Of elements whose places are off by more than their own rounding.
HWY_INLINE Reach<float> reach_of(const LocalStretch& s, const LocalElements& near) {
    Reach<float> reach = reach_of(s);
    reach.magnitude += 0x1p-5F * near.magnitude;  // margin of that: 2^-22
    return reach;
}

// Elements i of the field by their indices; and those of a list of floats from i on.
template <Shape shape>
HWY_INLINE Seen<D, shape> seen_in_field(const Field& field, const Stretch& stretch, double scale,
                                        hn::Vec<I> index) {
    const D d;
    const auto column = [&](const std::vector<double>& values)
                            HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
    Seen<D, shape> e;
    e.v = {hn::Sub(column(field.ax), constant(stretch.origin.x)),
           hn::Sub(column(field.ay), constant(stretch.origin.y)),
           hn::Sub(column(field.az), constant(stretch.origin.z))};
    if constexpr (has_axis<shape>) {
        e.m = {column(field.mx), column(field.my), column(field.mz)};
        e.parameter = column(field.parameter);
        if constexpr (has_length<shape>)
            e.size = column(field.length);
        else
            e.size = e.parameter;
    }
    e.strength = hn::Mul(column(field.strength), constant(scale));
    e.inverse_square = column(field.inverse_square);
    if constexpr (tapers<shape>) {
        const V<D> per_width = column(field.inverse_width), width_a = column(field.width_a);
        e.taper_rate = hn::Mul(hn::Sub(column(field.width_b), width_a), per_width);
    }
    if constexpr (numbered<shape>) {
        HWY_ALIGN hn::TFromD<I> element[hn::MaxLanes(D())];
        hn::Store(index, I(), element);
        e.see(field.all_numbers(), element);
    }
    e.finish();
    return e;
}

// Those of a list from i on, as far as they have been narrowed down.
template <Shape shape>
HWY_INLINE Seen<D, shape> seen_active(const Field& field, const Stretch& stretch, double scale,
                                      const ActiveElements& active, std::size_t i) {
    Seen<D, shape> e =
        seen_in_field<shape>(field, stretch, scale, hn::LoadU(I(), &active.element[i]));
    if constexpr (narrows<shape>) {
        if (!active.is_whole) {
            e.m.x = hn::LoadU(D(), &active.piece_middle[i]);
            e.m.y = hn::LoadU(D(), &active.piece_half[i]);
        }
    }
    return e;
}

template <Shape shape>
HWY_INLINE Seen<F, shape> seen_local(const LocalElements& near, const PartNumbers<float>& numbers,
                                     const Reach<float>& reach, std::size_t i) {
    const F d;
    const auto column = [&](const std::vector<float>& values)
                            HWY_ATTR { return hn::LoadU(d, &values[i]); };
    Seen<F, shape> e;
    e.v = {hn::Sub(column(near.x), hn::Set(d, reach.base.x)),
           hn::Sub(column(near.y), hn::Set(d, reach.base.y)),
           hn::Sub(column(near.z), hn::Set(d, reach.base.z))};
    if constexpr (has_axis<shape>) {
        e.m = {column(near.mx), column(near.my), column(near.mz)};
        e.parameter = column(near.parameter);
        if constexpr (has_length<shape>)
            e.size = column(near.length);
        else
            e.size = e.parameter;
    }
    e.strength = column(near.strength);
    e.inverse_square = column(near.inverse_square);
    if constexpr (tapers<shape>) {
        e.taper_rate = column(near.taper_rate);
    }
    if constexpr (numbered<shape>) e.see(numbers, &near.element[i]);
    e.finish();
    return e;
}

// Calls visit.operator()<shape, kernel>(group, first, end) for the groups that have elements.
template <class Visit>
HWY_INLINE void for_groups_of(const GroupStarts& starts, const Visit& visit) {
    for_shapes([&]<Shape shape>() HWY_ATTR {
        constexpr std::uint64_t all = ((std::uint64_t{1} << kernel_count) - 1)
                                      << group_of(shape, KernelKind{});
        if ((starts.present() & all) == 0) return;
        for_kernels<shape>([&]<Shape, KernelKind kind>() HWY_ATTR {
            constexpr std::size_t group = group_of(shape, kind);
            if (!starts.has(group)) return;
            const auto [first, end] = starts.range(group);
            if (first != end) visit.template operator()<shape, kind>(group, first, end);
        });
    });
}

HWY_INLINE double sum_of(V<D> x) { return hn::GetLane(hn::SumOfLanes(D(), x)); }

// Each lane's sum is rounded as often as there are summands; the sum over lanes is not.
#if HWY_TARGET != HWY_SCALAR
HWY_INLINE double sum_of(V<F> x) {
    return sum_of(hn::PromoteTo(D(), hn::LowerHalf(x))) +
           sum_of(hn::PromoteTo(D(), hn::UpperHalf(hn::Half<F>(), x)));
}
#else
HWY_INLINE double sum_of(V<F> x) { return hn::GetLane(x); }
#endif

template <class Tag>
HWY_INLINE std::uint32_t lane_bits(Tag d, M<Tag> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
