// Elements as floats, relative to a place nearby.
#if defined(IVORY_CORE_FIELD_PLACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_PLACES_INL
#undef IVORY_CORE_FIELD_PLACES_INL
#else
#define IVORY_CORE_FIELD_PLACES_INL
#endif

#include <algorithm>
#include <cmath>

#include "core/field/seen.inl"
#include "core/math/offset.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// (o - c) + t d of core/math/offset.h, whose proof wants products without error.
HWY_INLINE V<D> offset_lanes(double o, V<D> c, double t, double direction) {
#if HWY_NATIVE_FMA
    const V<D> origin = constant(o);
    const V<D> difference = hn::Sub(origin, c);
    const V<D> back = hn::Sub(difference, origin);
    const V<D> difference_low =
        hn::Sub(hn::Sub(origin, hn::Sub(difference, back)), hn::Add(c, back));
    const double product = t * direction;
    const V<D> product_low = constant(std::fma(t, direction, -product));
    const V<D> sum = hn::Add(difference, constant(product));
    const V<D> sum_back = hn::Sub(sum, difference);
    const V<D> sum_low =
        hn::Add(hn::Sub(constant(product), sum_back), hn::Sub(difference, hn::Sub(sum, sum_back)));
    return hn::Add(sum, hn::Add(sum_low, hn::Add(difference_low, product_low)));
#else
    const D d;
    HWY_ALIGN double lane[HWY_MAX_BYTES / sizeof(double)];
    hn::Store(c, d, lane);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) lane[k] = offset(o, lane[k], t, direction);
    return hn::Load(d, lane);
#endif
}

void place_local(const Field& field, const Stretch& bundle, double middle, LocalElements& near) {
    const D d;
    const I di;
    const hn::Rebind<float, D> narrow;
    const hn::Rebind<std::int32_t, D> narrow_index;
    const V<D> outward = constant(-1 / field.unit);
    // Vectors are read whole: what stands beyond the last element may be of another field.
    std::fill_n(near.element.begin() + static_cast<std::ptrdiff_t>(near.size()), hn::Lanes(d), 0);
    for (std::size_t i = 0; i < near.size(); i += hn::Lanes(d)) {
        const hn::Vec<I> index = hn::PromoteTo(di, hn::LoadU(narrow_index, &near.element[i]));
        const auto place = [&](double o, const std::vector<double>& c, double axis,
                               std::vector<float>& values) HWY_ATTR {
            const V<D> from = offset_lanes(o, hn::GatherIndex(d, c.data(), index), middle, axis);
            hn::StoreU(hn::DemoteTo(narrow, hn::Mul(from, outward)), narrow, &values[i]);
        };
        place(bundle.origin.x, field.ax, bundle.axis.x, near.x);
        place(bundle.origin.y, field.ay, bundle.axis.y, near.y);
        place(bundle.origin.z, field.az, bundle.axis.z, near.z);
    }
    near.magnitude = 0;
}

// The elements of a list as floats, but for their places.
template <Shape shape>
void near_group(const Field& field, const ActiveElements& active, std::size_t first,
                std::size_t end, LocalElements& near) {
    const D d;
    const I di;
    const hn::Rebind<float, D> narrow;
    const double unit = field.unit;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const hn::Vec<I> index = hn::LoadU(di, &active.element[i]);
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        const auto put = [&](V<D> x, std::vector<float>& to)
                             HWY_ATTR { hn::StoreU(hn::DemoteTo(narrow, x), narrow, &to[i]); };
        put(hn::Mul(column(field.strength), constant(field.scale)), near.strength);
        put(hn::Mul(column(field.inverse_square), constant(unit * unit)), near.inverse_square);
        if constexpr (has_axis<shape>) {
            using S = SkeletonOf<shape>;
            const V<D> m_factor = constant(unit_factor<S::m_power>(unit));
            put(hn::Mul(column(field.mx), m_factor), near.mx);
            put(hn::Mul(column(field.my), m_factor), near.my);
            put(hn::Mul(column(field.mz), m_factor), near.mz);
            put(hn::Min(hn::Mul(column(field.parameter),
                                constant(unit_factor<S::parameter_power>(unit))),
                        constant(1e30)),
                near.parameter);
            if constexpr (tapers<shape>) {
                const V<D> per_width = column(field.inverse_width), width_a = column(field.width_a);
                put(hn::Mul(hn::Sub(column(field.width_b), width_a), per_width), near.taper_rate);
            }
            if constexpr (has_length<shape>) {
                put(hn::Mul(column(field.length), constant(unit_factor<1>(unit))), near.length);
            }
        }
        put(hn::Mul(hn::LoadU(d, &active.least[i]), constant(1 - 0x1p-22)), near.least);
        put(hn::Mul(hn::LoadU(d, &active.most[i]), constant(1 + 0x1p-22)), near.most);
        put(hn::MulAdd(hn::LoadU(d, &active.peak[i]), constant(1 + 0x1p-22), constant(1e-37)),
            near.peak);
        for (std::size_t k = i; k < i + hn::Lanes(d); ++k) {
            near.element[k] = static_cast<std::int32_t>(active.element[k]);
            if constexpr (SkeletonOf<shape>::is_joined) {
                near.whole[k] = static_cast<float>(active.whole[k] * (1 + 0x1p-22)) + 1e-37f;
                const auto element = static_cast<std::size_t>(active.element[k]);
                near.source[k] = static_cast<std::int32_t>(field.source[element]);
            }
        }
    }
}

void enter_local(const Field& field, const Stretch& bundle, double middle,
                 const ActiveElements& active, LocalElements& near) {
    near.make_room(active.size());
    near.first = active.first;
    near.numbers = field.all_numbers_in_units();
    for_groups_of(active.first,
                  [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first, std::size_t end)
                      HWY_ATTR { near_group<shape>(field, active, first, end, near); });
    place_local(field, bundle, middle, near);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
