// The entries of a window: what the inner loops add up, with bounds of what rounding does to each and
// of what is left out.
#if defined(IVORY_CORE_FIELD_ENTRIES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_ENTRIES_INL
#undef IVORY_CORE_FIELD_ENTRIES_INL
#else
#define IVORY_CORE_FIELD_ENTRIES_INL
#endif

#include <bit>
#include <cmath>
#include <cstring>

#include "core/field/joined.inl"
#include "core/field/places.inl"
#include "core/field/window.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// |away| as computed is off by `eta` in widths. With t |d - axis| and |t - middle| at most H, (2)
// costs 7 u H for p (d - axis, the product; o - origin; t - middle, d, the product; the sums),
// 2 u |c - M| and u^2 of its terms for c, and u (H + |c - M|) the difference. What finding the nearest point
// adds is the shape's.
template <Shape shape, class Tag>
HWY_INLINE EntryErrors<Tag> etas(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                 V<Tag> c_length, V<Tag> inverse, V<Tag> inverse_width) {
    const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
    const double u = on.u;
    const V<Tag> v_length = hn::Add(c(on.H), c_length);
    V<Tag> eta = hn::MulAdd(c(4 * u), c_length, c(8 * u * on.H + on.place_error));
    eta = hn::MulAdd(hn::Add(e.magnitude, c(on.end)), c(0x1p-98), eta);
    const EntryErrors<Tag> off = LanesOfShape<shape>::errors(d, on, e, eta, v_length, inverse);
    const V<Tag> scale = hn::Mul(inverse_width, hn::Set(d, Margins<hn::TFromD<Tag>>::more));
    return {hn::Mul(off.value, scale), hn::Mul(hn::Add(off.value, off.slope), scale)};
}

// What is known of some elements of a group when they enter a window.
template <class Tag, Shape shape>
struct Arrivals {
    Seen<Tag, shape> e;
    Vec3v<Tag> place;                                  // c - M
    V<Tag> inverse_width, least, most, peak, inverse;  // most: not of points
    V<Tag> whole;  // the greatest peak of all parts of the element
};

// The greatest sqrt(s) on the stretch: no place of it is farther from M than H.
template <Shape shape, class Tag>
HWY_INLINE V<Tag> greatest_root(Tag d, const Entering& on, const Arrivals<Tag, shape>& arrivals,
                                V<Tag> c_length) {
    if constexpr (has_axis<shape>) return hn::Sqrt(arrivals.most);
    const V<Tag> farthest = hn::Add(c_length, constant(d, on.H + on.place_error));
    return hn::Mul(hn::Mul(farthest, arrivals.inverse_width),
                   hn::Set(d, Margins<hn::TFromD<Tag>>::more));
}

// In widths, what `away` may turn by and still say enough of a slope in float. Where two places of a skeleton
// may be as good as equally near that is more than rounding.
template <Shape shape>
inline constexpr double greatest_turn = numbered<shape> ? 0.25 : 1e-2;

// In widths, what Newton's steps may leave of a foot without each ray's own proof of it: little beside what a
// stage is there to tell.
template <class Real>
inline constexpr double loose_foot = sizeof(Real) == sizeof(float) ? 0x1p-18 : 0x1p-36;

// The numbers of a piece of a part, which the stage keeps.
template <Shape shape, class Real>
const Real* keep_piece(const double* whole, double middle, double half, double unit,
                       StageEntries<Real>& stage) {
    using S = SkeletonOf<shape>;
    std::array<double, StageEntries<Real>::numbers_of_piece> numbers;
    S::numbers_of_piece(whole, middle, half, numbers);
    const std::span<Real> piece = stage.new_piece();
    const double per_unit = 1 / unit;
    for (std::size_t k = 0; k < piece.size(); ++k) {
        if constexpr (sizeof(Real) == sizeof(float))
            piece[k] = S::in_units(k, numbers[k], per_unit);
        else
            piece[k] = numbers[k];
    }
    return piece.data();
}

// From the field, in double.
template <Shape shape>
struct FieldArrivals {
    using Lanes = D;
    const Field& field;
    const Stretch& stretch;
    double scale, middle;
    const ActiveElements& active;

    HWY_INLINE Arrivals<D, shape> at(std::size_t i) const {
        const D d;
        const hn::Vec<I> index = hn::LoadU(I(), &active.element[i]);
        const auto place = [&](double o, const std::vector<double>& c, double axis) HWY_ATTR {
            return hn::Neg(offset_lanes(o, hn::GatherIndex(d, c.data(), index), middle, axis));
        };
        return {seen_active<shape>(field, stretch, scale, active, i),
                {place(stretch.origin.x, field.ax, stretch.axis.x),
                 place(stretch.origin.y, field.ay, stretch.axis.y),
                 place(stretch.origin.z, field.az, stretch.axis.z)},
                hn::GatherIndex(d, field.inverse_width.data(), index),
                hn::LoadU(d, &active.least[i]),
                hn::LoadU(d, &active.most[i]),
                hn::LoadU(d, &active.peak[i]),
                hn::LoadU(d, &active.inverse[i]),
                hn::LoadU(d, joined<shape> ? &active.whole[i] : &active.peak[i])};
    }
    [[nodiscard]] std::uint32_t element(std::size_t i) const {
        return static_cast<std::uint32_t>(active.element[i]);
    }
    [[nodiscard]] std::uint32_t source(std::size_t i) const { return field.source[element(i)]; }
    // For the lanes of a stage, which keeps those of pieces.
    template <class Real>
    [[nodiscard]] const Real* numbers(std::size_t i, StageEntries<Real>& stage) const {
        if constexpr (narrows<shape>) {
            if (!active.is_whole && active.piece_half[i] < 1) {
                return keep_piece<shape>(field.all_numbers().of(element(i)), active.piece_middle[i],
                                         active.piece_half[i], field.unit, stage);
            }
        }
        if constexpr (sizeof(Real) == sizeof(float))
            return field.all_numbers_in_units().of(element(i));
        else
            return field.all_numbers().of(element(i));
    }
};

// From elements in float; `middle` is the window's, relative to the same place.
template <Shape shape>
struct LocalArrivals {
    using Lanes = F;
    const Field& field;
    const LocalElements& near;
    Reach<float> reach;
    Vec3<float> middle;

    HWY_INLINE Arrivals<F, shape> at(std::size_t i) const {
        const F d;
        const auto place = [&](const std::vector<float>& c, float from)
                               HWY_ATTR { return hn::Sub(hn::LoadU(d, &c[i]), hn::Set(d, from)); };
        const auto e = seen_local<shape>(near, near.numbers, reach, i);
        return {e,
                {place(near.x, middle.x), place(near.y, middle.y), place(near.z, middle.z)},
                hn::Sqrt(e.inverse_square),
                hn::LoadU(d, &near.least[i]),
                hn::LoadU(d, &near.most[i]),
                hn::LoadU(d, &near.peak[i]),
                hn::LoadU(d, &near.inverse[i]),
                hn::LoadU(d, joined<shape> ? &near.whole[i] : &near.peak[i])};
    }
    [[nodiscard]] std::uint32_t element(std::size_t i) const {
        return static_cast<std::uint32_t>(near.element[i]);
    }
    [[nodiscard]] std::int32_t source(std::size_t i) const { return near.source[i]; }
    template <class>
    [[nodiscard]] const float* numbers(std::size_t i, StageEntries<float>& stage) const {
        if constexpr (narrows<shape>) {
            if (near.my[i] < 1) {
                return keep_piece<shape>(field.all_numbers().of(element(i)), double{near.mx[i]},
                                         double{near.my[i]}, field.unit, stage);
            }
        }
        return near.numbers.of(element(i));
    }
    // Those of i .. that the bits name join others.
    void leave(std::size_t i, std::uint32_t bits, double unit, ActiveElements& others) const {
        for (; bits != 0; bits &= bits - 1) {
            others.take(near, i + static_cast<std::size_t>(std::countr_zero(bits)), unit);
        }
    }
};

// Where elements go that have peaks above the cut of the strong ones: they enter `strong`, or are
// of another stage.
template <class Real>
struct StrongOnes {
    StageEntries<Real>* entries = nullptr;
    ActiveElements* others = nullptr;
    double unit = 1;  // of the others
};

// Some elements of one stage of a window: the strong ones, and others with peaks above the second
// cut, which enter `weak`. In float lengths are in units.
template <class Real, Shape shape, KernelKind kind, class Source>
void enter_group(const Source& source, const Entering& on, const CoarseCuts& cuts,
                 std::size_t first, std::size_t end, const StrongOnes<Real>& strong,
                 StageEntries<Real>* weak, StageSums& sums) {
    using Tag = typename Source::Lanes;
    constexpr bool is_coarse = sizeof(Real) == sizeof(float);
    constexpr std::size_t lanes_at_most = hn::MaxLanes(Tag());
    const Tag d;
    const std::size_t N = hn::Lanes(d);
    const V<Tag> zero = hn::Zero(d);
    const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
    const V<Tag> widened = hn::Set(d, Margins<hn::TFromD<Tag>>::more);
    V<Tag> error = zero, slope = zero, magnitude = zero, full_slope = zero;
    V<Tag> left_out_above = zero, left_out_below = zero;
    V<Tag> weak_above = zero, weak_below = zero, weak_slope = zero;
    M<Tag> bad = hn::FirstN(d, 0);
    alignas(64) Real quads[3][4 * lanes_at_most];  // of each lane, side by side
    const std::size_t strong_before = strong.entries != nullptr ? strong.entries->size : 0,
                      weak_before = weak != nullptr ? weak->size : 0;
    if (strong.entries != nullptr) strong.entries->make_room(end - first);
    if (weak != nullptr) weak->make_room(end - first);
    for (std::size_t i = first; i < end; i += N) {
        M<Tag> valid = hn::FirstN(d, end - i);
        const Arrivals<Tag, shape> arrivals = source.at(i);
        const Seen<Tag, shape>& e = arrivals.e;
        M<Tag> kinked = hn::Lt(arrivals.inverse, zero);
        const V<Tag> strength = hn::Abs(e.strength);
        const V<Tag> value = hn::Mul(hn::Mul(strength, arrivals.whole), widened);
        const V<Tag> per_length =
            hn::Mul(hn::Mul(hn::Add(widened, widened), strength), arrivals.inverse_width);
        const V<Tag> whole =
            hn::Mul(per_length, LanesOf<kind>::slope(d, arrivals.least, arrivals.peak));
        const V<Tag> c_length = hn::Mul(length_of(d, arrivals.place), widened);
        EntryErrors<Tag> eta =
            etas<shape>(d, on, e, c_length, arrivals.inverse, arrivals.inverse_width);
        M<Tag> is_proved = hn::FirstN(d, 0);
        if constexpr (proves_feet<shape>) {
            const EntryErrors<Tag> of_proved =
                etas<shape>(d, on, e, c_length, constant(d, -1), arrivals.inverse_width);
            is_proved = hn::Or(kinked, hn::And(hn::Gt(arrivals.inverse, zero),
                                               hn::Not(hn::Lt(eta.value, c(loose_foot<Real>)))));
            eta = {hn::IfThenElse(is_proved, of_proved.value, eta.value),
                   hn::IfThenElse(is_proved, of_proved.slope, eta.slope)};
        }
        EntryErrors<Tag> off =
            LanesOf<kind>::errors(d, on.u, eta, arrivals.least,
                                  greatest_root<shape>(d, on, arrivals, c_length), arrivals.peak);
        M<Tag> is_exact = hn::Lt(eta.value, c(5e-4));
        if constexpr (proves_feet<shape>) {
            // Where that is worth nothing `away` leads from some place of the skeleton: k is no more than it
            // should be, but for what rounding takes from |away|, with q r < 0.004 less than a hundredth of
            // Blinn's k, and 3 r of others.
            const V<Tag> all = hn::Add(hn::Add(c_length, e.parameter), c(on.H));
            const V<Tag> r =
                hn::Mul(hn::MulAdd(c(64 * on.u), all, c(on.place_error)), arrivals.inverse_width);
            const V<Tag> most = hn::MulAdd(arrivals.peak, c(1.01), hn::Mul(c(3), r));
            kinked = hn::Not(is_exact);
            is_proved = hn::And(is_proved, is_exact);
            off.value = hn::IfThenElse(is_exact, off.value, most);
            is_exact = hn::Or(is_exact, hn::Lt(r, c(1e-4)));
        }

        M<Tag> is_strong = valid, enters = valid;
        if constexpr (is_coarse) {
            is_strong = hn::AndNot(hn::Le(value, c(cuts.strong)), valid);
            if constexpr (sizeof(hn::TFromD<Tag>) == sizeof(float)) {
                if (strong.others != nullptr) {
                    source.leave(i, lane_bits(d, is_strong), strong.unit, *strong.others);
                    valid = hn::AndNot(is_strong, valid);
                }
            }
            enters = hn::AndNot(hn::Le(value, c(cuts.weak)), valid);
        }
        const M<Tag> leaves = hn::AndNot(enters, valid);
        const M<Tag> adds = hn::Gt(e.strength, zero);
        const V<Tag> left = hn::IfThenElseZero(leaves, value);
        left_out_above = hn::Add(left_out_above, hn::IfThenElseZero(adds, left));
        left_out_below = hn::Add(left_out_below, hn::IfThenZeroElse(adds, left));
        full_slope = hn::Add(full_slope, hn::IfThenElseZero(valid, whole));
        const V<Tag> slope_off =
            hn::IfThenElse(hn::Or(kinked, leaves), whole, hn::Mul(per_length, off.slope));
        slope = hn::Add(slope, hn::IfThenElseZero(valid, slope_off));
        error = hn::Add(error, hn::IfThenElseZero(enters, hn::Mul(strength, off.value)));
        magnitude = hn::Add(magnitude, hn::IfThenElseZero(enters, value));
        const M<Tag> is_weak = hn::AndNot(is_strong, enters);
        if constexpr (is_coarse) {
            const V<Tag> part = hn::IfThenElseZero(is_weak, value);
            weak_above = hn::Add(weak_above, hn::IfThenElseZero(adds, part));
            weak_below = hn::Add(weak_below, hn::IfThenZeroElse(adds, part));
            weak_slope = hn::Add(weak_slope, hn::IfThenElseZero(is_weak, whole));
        }

        const V<Tag> per_unit = c(1 / on.unit);
        const V<Tag> square = hn::Mul(e.inverse_square, c(on.unit * on.unit));
        V<Tag> parameter = e.parameter;
        V<Tag> m_scale = c(1);
        if constexpr (is_coarse && has_axis<shape>) {
            parameter =
                hn::Mul(parameter, c(unit_factor<SkeletonOf<shape>::parameter_power>(on.unit)));
            m_scale = c(unit_factor<SkeletonOf<shape>::m_power>(on.unit));
        }
        M<Tag> fit = is_exact;
        if constexpr (is_coarse) {
            // 1 / |m|^2 of a very short segment and such are beyond float.
            const V<Tag> largest = hn::Max(square, strength);
            const M<Tag> knows_slope = hn::Lt(eta.slope, c(greatest_turn<shape>));
            fit =
                hn::And(fit, hn::And(proves_feet<shape> ? hn::Or(knows_slope, kinked) : knows_slope,
                                     hn::Lt(largest, c(1e12))));
            if constexpr (has_axis<shape>) fit = hn::And(fit, hn::Lt(parameter, c(1e12)));
        }
        bad = hn::Or(bad, hn::AndNot(fit, enters));

        const auto put = [&](V<Tag> x0, V<Tag> x1, V<Tag> x2, V<Tag> x3, std::size_t j) HWY_ATTR {
            if constexpr (sizeof(Real) != sizeof(hn::TFromD<Tag>)) {
                const hn::Rebind<float, D> narrow;
                hn::StoreInterleaved4(hn::DemoteTo(narrow, x0), hn::DemoteTo(narrow, x1),
                                      hn::DemoteTo(narrow, x2), hn::DemoteTo(narrow, x3), narrow,
                                      quads[j]);
            } else {
                hn::StoreInterleaved4(x0, x1, x2, x3, d, quads[j]);
            }
        };
        const V<Tag> full = hn::Mul(hn::Mul(c(2 * LanesOf<kind>::slope_sign), e.strength), square);
        put(hn::Mul(arrivals.place.x, per_unit), hn::Mul(arrivals.place.y, per_unit),
            hn::Mul(arrivals.place.z, per_unit), hn::Mul(square, c(LanesOf<kind>::argument_scale)),
            0);
        V<Tag> taper_rate = zero;
        if constexpr (tapers<shape>) taper_rate = e.taper_rate;
        if constexpr (proves_feet<shape>) {
            const V<Tag> proof = hn::Mul(hn::Mul(hn::Abs(full), hn::Mul(widened, widened)),
                                         LanesOf<kind>::steepest(d, arrivals.least));
            taper_rate = hn::IfThenElseZero(is_proved, hn::Max(proof, c(least_square<float>)));
        }
        V<Tag> joins = zero;
        if constexpr (joined<shape>) {
            alignas(64) hn::TFromD<Tag> of_lane[lanes_at_most] = {};
            const std::uint32_t bits =
                joins_of(i, end, N, [&](std::size_t k) { return source.source(k); });
            for (std::size_t k = 0; k < N; ++k) {
                of_lane[k] = static_cast<hn::TFromD<Tag>>(bits >> k & 1);
            }
            joins = hn::Load(d, of_lane);
        }
        put(e.strength, hn::IfThenZeroElse(kinked, full), taper_rate, joins, 1);
        if constexpr (has_axis<shape>) {
            put(hn::Mul(e.m.x, m_scale), hn::Mul(e.m.y, m_scale), hn::Mul(e.m.z, m_scale),
                parameter, 2);
        }
        const auto enter = [&](StageEntries<Real>& stage, M<Tag> which) HWY_ATTR {
            for (std::uint32_t bits = lane_bits(d, which); bits != 0; bits &= bits - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(bits));
                stage.element[stage.size] = source.element(i + k);
                static_assert(sizeof(BundleEntry<Real>) == 12 * sizeof(Real));
                auto* const to = reinterpret_cast<Real*>(&stage.entry[stage.size]);
                std::memcpy(to, quads[0] + 4 * k, 4 * sizeof(Real));
                std::memcpy(to + 4, quads[1] + 4 * k, 4 * sizeof(Real));
                if constexpr (has_axis<shape>) {
                    std::memcpy(to + 8, quads[2] + 4 * k, 4 * sizeof(Real));
                }
                if constexpr (numbered<shape>) {
                    stage.entry[stage.size].set_numbers(
                        source.template numbers<Real>(i + k, stage));
                }
                ++stage.size;
            }
        };
        if (strong.entries != nullptr) enter(*strong.entries, is_strong);
        if (weak != nullptr) enter(*weak, is_weak);
    }
    constexpr std::size_t group = group_of(shape, kind);
    if (strong.entries != nullptr) {
        strong.entries->end_group(group, strong.entries->size - strong_before);
    }
    if (weak != nullptr) weak->end_group(group, weak->size - weak_before);
    sums.error += sum_of(error);
    sums.slope += sum_of(slope);
    sums.magnitude += sum_of(magnitude);
    sums.full_slope += sum_of(full_slope);
    sums.left_out_above += sum_of(left_out_above);
    sums.left_out_below += sum_of(left_out_below);
    sums.weak_above += sum_of(weak_above);
    sums.weak_below += sum_of(weak_below);
    sums.weak_slope += sum_of(weak_slope);
    sums.usable = sums.usable && hn::AllFalse(d, bad);
}

template <class Real>
Entering entering(const Stretch& s, double unit) {
    return {.u = sizeof(Real) == sizeof(float) ? 0x1p-24 : 0x1p-53,
            .unit = unit,
            .H = 0.5 * (s.end - s.begin) * more + s.end * s.spread * more + s.radius * more,
            .end = s.end,
            .place_error = 0,
            .least_rho = std::sqrt(double{least_square<Real>}) * unit * more};
}

StageSums coarse(const Field& field, const Stretch& stretch, double scale, const CoarseCuts& cuts,
                 const ActiveElements& active, Window& window) {
    StageSums sums;
    window.strong.clear();
    window.weak.clear();
    const Entering on = entering<float>(stretch, field.unit);
    for_groups_of(active.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                  std::size_t end) HWY_ATTR {
        const FieldArrivals<shape> source{field, stretch, scale, window.middle, active};
        enter_group<float, shape, kind>(source, on, cuts, first, end, {&window.strong},
                                        &window.weak, sums);
    });
    return sums;
}

// c - M: beside what the elements' places are off by, and their own roundings, that of the middle's
// place and of the difference; |place| <= |c - M| + |middle|. `middle` is that of the window,
// relative to the elements' place.
StageSums enter_from_local(const Field& field, const LocalElements& near,
                           const LocalStretch& stretch, double middle, const CoarseCuts& cuts,
                           const StrongOnes<float>& strong, StageEntries<float>& weak) {
    StageSums sums;
    if (strong.entries != nullptr) strong.entries->clear();
    if (strong.others != nullptr) {
        strong.others->make_room(near.size());
        strong.others->end(0);
    }
    weak.clear();
    const Reach<float> reach = reach_of(stretch);
    const auto place = [&](double base, double axis) {
        return static_cast<float>(base + middle * axis);
    };
    const Vec3<float> from{place(stretch.base.x, stretch.axis.x),
                           place(stretch.base.y, stretch.axis.y),
                           place(stretch.base.z, stretch.axis.z)};
    const double size =
        std::sqrt(double{from.x} * double{from.x} + double{from.y} * double{from.y} +
                  double{from.z} * double{from.z});
    const double last = (stretch.t_offset + stretch.end) * more;
    const Entering on{.u = 0x1p-24,
                      .unit = 1,
                      .H = 0.5 * (stretch.end - stretch.begin) * more +
                           last * stretch.spread * more + stretch.radius * more,
                      .end = last,
                      .place_error = 0x1p-23 * double{near.magnitude} + 0x1.1p-23 * size,
                      .least_rho = std::sqrt(double{least_square<float>}) * more};
    GroupStarts none;
    GroupStarts& starts = strong.others != nullptr ? strong.others->first : none;
    starts.clear();
    for_groups_of(near.first, [&]<Shape shape, KernelKind kind>(
                                  std::size_t group, std::size_t first, std::size_t end) HWY_ATTR {
        if (strong.others != nullptr) starts.begin(group, strong.others->size());
        const LocalArrivals<shape> source{field, near, reach, from};
        enter_group<float, shape, kind>(source, on, cuts, first, end, strong, &weak, sums);
    });
    if (strong.others != nullptr) {
        const std::size_t count = strong.others->size();
        starts.end(count);
        strong.others->end(count);
    }
    return sums;
}

StageSums coarse_local(const Field& field, const LocalElements& near, const LocalStretch& stretch,
                       double middle, const CoarseCuts& cuts, Window& window) {
    return enter_from_local(field, near, stretch, middle, cuts, {&window.strong}, window.weak);
}

StageSums fine(const Field& field, const Stretch& stretch, double scale,
               const ActiveElements& active, Window& window) {
    StageSums sums;
    window.fine.clear();
    const Entering on = entering<double>(stretch, 1);
    for_groups_of(active.first, [&]<Shape shape, KernelKind kind>(std::size_t, std::size_t first,
                                                                  std::size_t end) HWY_ATTR {
        const FieldArrivals<shape> source{field, stretch, scale, window.middle, active};
        enter_group<double, shape, kind>(source, on, {}, first, end, {&window.fine}, nullptr, sums);
    });
    return sums;
}

StageSums fine_in_float(const Field& field, const LocalElements& near, const LocalStretch& stretch,
                        double middle, double unit, double cut, Window& window,
                        ActiveElements& others) {
    return enter_from_local(field, near, stretch, middle, {.strong = cut, .weak = 0},
                            {.others = &others, .unit = unit}, window.fine_in_float);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
