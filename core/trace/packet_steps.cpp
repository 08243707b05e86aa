#include "core/trace/packet_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/packet_steps.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
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

// Calls visit.operator()<shape, kernel>(first, count) for each group that has entries.
template <class Counts, class Visit>
HWY_INLINE void for_groups(const Counts& counts, const Visit& visit) {
    std::size_t first = 0;
    for_shapes_and_kernels([&]<Shape shape, KernelKind kind>() HWY_ATTR
                           __attribute__((always_inline)) {
        const std::uint32_t count = counts[group_of(shape, kind)];
        if (count != 0) visit.template operator()<shape, kind>(first, count);
        first += count;
    });
}

template <class Tag>
HWY_INLINE void add(Tag d, const StageEntries<hn::TFromD<Tag>>& stage, const Vec3v<Tag>& p,
                    const Vec3v<Tag>& direction, FieldValue<Tag>& sum) {
    for_groups(stage.count,
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

// values - minus, computed in double.
HWY_INLINE V<F> rounded_difference(const double* values, double minus) {
    const D d;
    const V<D> lo = hn::Sub(hn::LoadU(d, values), hn::Set(d, minus));
#if HWY_TARGET == HWY_SCALAR
    return hn::DemoteTo(F(), lo);
#else
    const hn::Half<F> half;
    const V<D> hi = hn::Sub(hn::LoadU(d, values + hn::Lanes(d)), hn::Set(d, minus));
    return hn::Combine(F(), hn::DemoteTo(half, hi), hn::DemoteTo(half, lo));
#endif
}

void prepare(Lanes& lanes) {
    const F d;
    const hn::RebindToSigned<F> di;
    const std::size_t N = hn::Lanes(d);
    const auto walking = hn::Set(di, std::int32_t{Lanes::walking});
    const auto unused = hn::Set(di, std::int32_t{Lanes::unused});
    for (std::size_t k = 0; k < lanes.count; k += N) {
        const auto used = hn::FirstN(di, lanes.count - k);
        // The last vector is whole: numbers, but nobody's.
        const auto put = [&](const double* values, float* to) HWY_ATTR {
            hn::StoreU(
                hn::IfThenElseZero(hn::RebindMask(d, used), rounded_difference(values + k, 0)), d,
                to + k);
        };
        put(lanes.dx, lanes.fx.data());
        put(lanes.dy, lanes.fy.data());
        put(lanes.dz, lanes.fz.data());
        hn::StoreU(hn::IfThenElse(used, walking, unused), di, &lanes.state[k]);
    }
}

// What the walk needs to know of the stage that it runs in.
template <class Real>
struct Stage;

// The walk's formulas are monotonic in what they are given, and their own few roundings (below
// 2^-20 in all, or 2^-48) are less than what `tight` takes away or adds; those with a rough square
// root and a rough inverse (2^-10.4 together) are less than what `rough` does.
template <>
struct Stage<float> {
    static constexpr float tight = 0x1p-18f, rough = 0x1p-10f;
    static constexpr double last_place = 0x1p-22, tiny = 1e-20, huge = 3e38;
    static constexpr int most_guesses = 6;
    static constexpr Lanes::State takes = Lanes::walking, leaves = Lanes::doubtful;

    // Where f is farther below 0 than this many times what the strong entries leave open, they say
    // enough.
    static constexpr double far_below = 2;

    const Window& window;
    double unit;
    double settled;  // of half the window: the enclosure does the rest

    const auto& entries() const { return window.strong; }
    const StageBounds& bounds() const { return window.strong_bounds; }
    const auto& more_entries() const { return window.weak; }
    const StageBounds& close_bounds() const { return window.coarse_bounds; }
    double begin() const { return window.tau_begin; }
    double end() const { return window.tau_end; }
};

template <>
struct Stage<double> {
    static constexpr double tight = 0x1p-44, rough = tight;
    static constexpr double last_place = 0x1p-50, tiny = 1e-200, huge = 1e300;
    static constexpr double settled = 0x1p-36;
    static constexpr int most_guesses = 20;
    static constexpr Lanes::State takes = Lanes::doubtful, leaves = Lanes::undecided;

    const Window& window;
    static constexpr double unit = 1;

    const auto& entries() const { return window.fine; }
    const StageBounds& bounds() const { return window.fine_bounds; }
    double begin() const { return (window.begin - window.middle) * (1 + 0x1p-50); }
    double end() const { return (window.end - window.middle) * (1 + 0x1p-50); }
};

template <class Tag>
HWY_INLINE std::uint64_t bits_of(Tag d, M<Tag> mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < (hn::Lanes(d) + 7) / 8; ++k) {
        bits |= std::uint64_t{bytes[k]} << (8 * k);
    }
    return bits;
}

// Those in that state; what lies beyond the end is another part's.
HWY_INLINE M<F> lanes_in(F d, Lanes::State state, const Lanes& lanes, std::size_t first,
                         std::size_t end) {
    const hn::RebindToSigned<F> di;
    const auto in_state =
        hn::Eq(hn::LoadU(di, &lanes.state[first]), hn::Set(di, std::int32_t{state}));
    return hn::And(hn::RebindMask(d, in_state), hn::FirstN(d, end - first));
}

// The states of so many lanes as a vector has doubles; such vectors turn into integers and back on
// every machine.
HWY_INLINE V<D> states_of(const Lanes& lanes, std::size_t first) {
    return hn::PromoteTo(D(), hn::LoadU(hn::Rebind<std::int32_t, D>(), &lanes.state[first]));
}

HWY_INLINE M<D> lanes_in(D d, Lanes::State state, const Lanes& lanes, std::size_t first,
                         std::size_t end) {
    return hn::And(hn::Eq(states_of(lanes, first), hn::Set(d, static_cast<double>(state))),
                   hn::FirstN(d, end - first));
}

bool any(const Lanes& lanes, Lanes::State state, std::size_t first, std::size_t end) {
    const F d;
    for (std::size_t k = first; k < end; k += hn::Lanes(d)) {
        if (!hn::AllFalse(d, lanes_in(d, state, lanes, k, end))) return true;
    }
    return false;
}

void conclude(const Lanes& lanes, BundleIsolations& isolations) {
    const F d;
    const hn::RebindToSigned<F> di;
    const hn::Rebind<std::uint8_t, F> bytes;
    const auto set = [&](Status status)
                         HWY_ATTR { return hn::Set(di, static_cast<std::int32_t>(status)); };
    for (std::size_t k = 0; k < lanes.count; k += hn::Lanes(d)) {
        const auto state = hn::LoadU(di, &lanes.state[k]);
        const auto is_miss = hn::Eq(state, hn::Set(di, std::int32_t{Lanes::walking}));
        const auto is_hit = hn::Eq(state, hn::Set(di, std::int32_t{Lanes::hit}));
        const auto status =
            hn::IfThenElse(is_miss, set(Status::miss),
                           hn::IfThenElse(is_hit, set(Status::hit), set(Status::unresolved)));
        hn::StoreU(hn::DemoteTo(bytes, status), bytes,
                   reinterpret_cast<std::uint8_t*>(&isolations.status[k]));
    }
}

// Directions, and what (2) of core/field/bundle.h adds to them in the window's middle.
template <class Tag>
struct RayLanes {
    Vec3v<Tag> direction, middle;
};

HWY_INLINE RayLanes<D> rays_of(D d, const Window& window, double, const Lanes& lanes,
                               std::size_t first) {
    const V<D> x = hn::LoadU(d, lanes.dx + first), y = hn::LoadU(d, lanes.dy + first),
               z = hn::LoadU(d, lanes.dz + first), middle = hn::Set(d, window.middle);
    return {{x, y, z},
            {hn::Mul(middle, hn::Sub(x, hn::Set(d, window.axis.x))),
             hn::Mul(middle, hn::Sub(y, hn::Set(d, window.axis.y))),
             hn::Mul(middle, hn::Sub(z, hn::Set(d, window.axis.z)))}};
}

HWY_INLINE RayLanes<F> rays_of(F d, const Window& window, double unit, const Lanes& lanes,
                               std::size_t first) {
    const V<F> middle = hn::Set(d, static_cast<float>(window.middle / unit));
    return {{hn::LoadU(d, &lanes.fx[first]), hn::LoadU(d, &lanes.fy[first]),
             hn::LoadU(d, &lanes.fz[first])},
            {hn::Mul(middle, rounded_difference(lanes.dx + first, window.axis.x)),
             hn::Mul(middle, rounded_difference(lanes.dy + first, window.axis.y)),
             hn::Mul(middle, rounded_difference(lanes.dz + first, window.axis.z))}};
}

constexpr int most_steps = 48;

template <class Tag>
Walked walk_stage(Tag d, const Stage<hn::TFromD<Tag>>& stage, double threshold,
                  std::size_t begin_lane, std::size_t end_lane, Lanes& lanes, Cancellation& stop) {
    using Real = hn::TFromD<Tag>;
    using S = Stage<Real>;
    constexpr Real tight = S::tight;
    const Window& window = stage.window;
    const double unit = stage.unit;
    const std::size_t N = hn::Lanes(d);
    const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<Real>(value)); };
    constexpr bool has_weak = sizeof(Real) == sizeof(float);
    constexpr double widened = 1 + 0x1p-20;
    const StageBounds& bounds = stage.bounds();
    const V<Tag> all_above = c(bounds.above * widened), all_below = c(bounds.below * widened),
                 all_slope_error = c(bounds.slope * widened);
    // f'' per unit^2, made larger by what the formulas may lose.
    const V<Tag> rise = c(window.rise * unit * unit * (1 + 2 * tight) + S::tiny);
    const V<Tag> fall = c(window.fall * unit * unit * (1 + 2 * tight) + S::tiny);
    const V<Tag> begin = c(stage.begin()), end = c(stage.end());
    // The sum tau + step is off by half a unit of its last place.
    const V<Tag> slack = c(S::last_place * stage.end());
    const V<Tag> settled = c(stage.settled * stage.end());
    const V<Tag> zero = hn::Zero(d), one_less = c(1 - tight), one_more = c(1 + tight);
    const V<Tag> least = c(least_square<Real>);
    Walked walked;
    std::uint64_t work = N * stage.entries().size;  // of a step, at most
    if constexpr (has_weak) work += N * stage.more_entries().size;

    for (std::size_t first = begin_lane; first < end_lane; first += N) {
        M<Tag> walking = lanes_in(d, S::takes, lanes, first, end_lane);
        if (hn::AllFalse(d, walking)) continue;
        const M<Tag> taken = walking;
        const RayLanes<Tag> rays = rays_of(d, window, unit, lanes, first);
        const Vec3v<Tag>&direction = rays.direction, &middle = rays.middle;
        V<Tag> tau = begin, guess_lo = zero, guess_hi = zero;
        V<Tag> last_tau = zero, last_slope = zero;  // of the step before
        M<Tag> guessing = hn::FirstN(d, 0), found = guessing, undecided = guessing;
        V<Tag> guesses = zero;  // of each lane, so that no lane's way depends on its neighbours
        for (int step = 0; step < most_steps; ++step) {
            const M<Tag> active = hn::Or(walking, guessing);
            walked.steps += hn::CountTrue(d, active);
            if (stop.after(work)) return walked;
            const Vec3v<Tag> p{hn::MulAdd(tau, direction.x, middle.x),
                               hn::MulAdd(tau, direction.y, middle.y),
                               hn::MulAdd(tau, direction.z, middle.z)};
            FieldValue<Tag> value = evaluate(d, stage.entries(), threshold, p, direction);
            V<Tag> above = all_above, below = all_below, slope_error = all_slope_error;
            if constexpr (has_weak) {
                const M<Tag> close = hn::And(
                    active, hn::Or(guessing,
                                   hn::Not(hn::Lt(value.f, hn::Mul(c(-S::far_below), all_above)))));
                if (stage.more_entries().size > 0 && !hn::AllFalse(d, close)) {
                    walked.close_steps += hn::CountTrue(d, close);
                    FieldValue<Tag> sum = value;
                    add(d, stage.more_entries(), p, direction, sum);
                    value = {hn::IfThenElse(close, sum.f, value.f),
                             hn::IfThenElse(close, sum.slope, value.slope)};
                    const StageBounds& closer = stage.close_bounds();
                    above = hn::IfThenElse(close, c(closer.above * widened), above);
                    below = hn::IfThenElse(close, c(closer.below * widened), below);
                    slope_error = hn::IfThenElse(close, c(closer.slope * widened), slope_error);
                }
            }

            // A guess follows Newton, kept where the root is known to be.
            const V<Tag> onto_zero = hn::Mul(value.f, rough_inverse(d, value.slope));
            const V<Tag> newton = hn::Min(hn::Max(hn::Sub(tau, onto_zero), guess_lo), guess_hi);
            guesses = hn::Add(guesses, hn::IfThenElseZero(guessing, c(1)));
            const M<Tag> settles =
                hn::And(guessing, hn::Or(hn::Le(hn::Abs(hn::Sub(newton, tau)), settled),
                                         hn::Ge(guesses, c(S::most_guesses))));

            // f(tau) < 0 must be certain for anything else to be.
            const V<Tag> f_hi = hn::Add(value.f, above);
            const V<Tag> f_lo = hn::Mul(hn::Sub(value.f, below), one_more);
            const V<Tag> slope_lo = hn::Sub(value.slope, slope_error);
            const V<Tag> slope_hi = hn::Add(value.slope, slope_error);
            undecided = hn::Or(undecided, hn::And(walking, hn::Not(hn::Lt(f_hi, zero))));
            walking = hn::AndNot(undecided, walking);

            // The parabola below f: with a zero in the window, g rises up to there, and on up to
            // its vertex, which lies beyond what the rough numbers add to that zero.
            const V<Tag> firm = hn::Mul(slope_lo, one_less);
            const V<Tag> below_square = hn::MulAdd(firm, firm, hn::Mul(hn::Add(fall, fall), f_lo));
            const V<Tag> turning =
                hn::MulAdd(hn::Mul(firm, hn::Set(d, Real{16} * S::rough * S::rough)), firm, least);
            const V<Tag> steepness = hn::Add(firm, rough_sqrt(d, below_square));
            const V<Tag> latest =
                hn::Mul(hn::Mul(c(-2 * (1 + S::rough)), f_lo), rough_inverse(d, steepness));
            const V<Tag> latest_tau = hn::Add(tau, latest);
            const M<Tag> rises =
                hn::And(walking, hn::And(hn::And(hn::Gt(firm, zero), hn::Gt(below_square, turning)),
                                         hn::Le(latest_tau, end)));

            // The parabola above f: up to its zero there is no root.
            const V<Tag> a = hn::Mul(f_hi, one_less);
            const V<Tag> b = hn::MulAdd(hn::Abs(slope_hi), hn::Set(d, tight), slope_hi);
            const V<Tag> root = rough_sqrt(d, hn::MulAdd(b, b, hn::Mul(hn::Mul(c(-2), a), rise)));
            const M<Tag> upward = hn::Gt(b, zero);
            const V<Tag> numerator = hn::IfThenElse(upward, hn::Mul(c(-2), a), hn::Sub(root, b));
            const V<Tag> denominator = hn::IfThenElse(upward, hn::Add(root, b), rise);
            const V<Tag> quotient = hn::Mul(numerator, rough_inverse(d, denominator));
            const V<Tag> safe = hn::MulSub(quotient, c(1 - S::rough), slack);
            const M<Tag> steps_on = hn::AndNot(rises, walking);
            // Nothing gets on, or a number is lost: not slack < safe < infinity.
            undecided = hn::Or(
                undecided,
                hn::AndNot(hn::And(hn::Gt(safe, slack), hn::Lt(safe, c(S::huge))), steps_on));
            const V<Tag> next = hn::Add(tau, safe);

            // Lanes change their ways.
            guess_lo = hn::IfThenElse(rises, tau, guess_lo);
            guess_hi = hn::IfThenElse(rises, latest_tau, guess_hi);
            // The zero of f + f' x + f'' x^2 / 2, with f'' from the step before: a guess.
            const V<Tag> curvature =
                hn::Mul(hn::Sub(value.slope, last_slope),
                        rough_inverse(d, hn::Max(hn::Sub(tau, last_tau), c(S::tiny))));
            const V<Tag> bent =
                hn::MulAdd(value.slope, value.slope,
                           hn::Mul(hn::Mul(c(-2), value.f), step > 0 ? curvature : zero));
            const V<Tag> turned = rough_sqrt(d, hn::Max(bent, least));
            const V<Tag> onward =
                hn::Mul(hn::Mul(c(-2), value.f), rough_inverse(d, hn::Add(value.slope, turned)));
            const V<Tag> first_guess = hn::Min(hn::Max(hn::Add(tau, onward), tau), latest_tau);
            last_tau = tau;
            last_slope = value.slope;
            tau = hn::IfThenElse(steps_on, next, tau);
            tau = hn::IfThenElse(guessing, newton, tau);
            tau = hn::IfThenElse(rises, first_guess, tau);
            found = hn::Or(found, settles);
            guessing = hn::Or(hn::AndNot(settles, guessing), rises);
            walking = hn::AndNot(hn::Or(undecided, hn::Ge(tau, end)), steps_on);
            if (hn::AllFalse(d, hn::Or(walking, guessing))) break;
        }
        undecided = hn::Or(undecided, hn::Or(walking, guessing));  // no end of steps
        if (hn::AllFalse(d, hn::Or(found, undecided)) && S::takes == Lanes::walking) continue;
        const hn::RebindToSigned<Tag> di;
        if constexpr (sizeof(Real) == sizeof(float)) {
            const auto set = [&](Lanes::State state)
                                 HWY_ATTR { return hn::Set(di, std::int32_t{state}); };
            const auto state =
                hn::IfThenElse(hn::RebindMask(di, undecided), set(S::leaves),
                               hn::IfThenElse(hn::RebindMask(di, found), set(Lanes::candidate),
                                              set(Lanes::walking)));
            hn::BlendedStore(state, hn::RebindMask(di, taken), di, &lanes.state[first]);
        } else {
            const std::uint64_t taken_bits = bits_of(d, taken), found_bits = bits_of(d, found),
                                undecided_bits = bits_of(d, undecided);
            for (std::size_t k = 0; k < N; ++k) {
                if ((taken_bits >> k & 1) == 0) continue;
                const bool is_undecided = (undecided_bits >> k & 1) != 0;
                lanes.state[first + k] = is_undecided                 ? S::leaves
                                         : (found_bits >> k & 1) != 0 ? Lanes::candidate
                                                                      : Lanes::walking;
                if (is_undecided) {
                    lanes.t_lo[first + k] = window.begin;
                    lanes.t_hi[first + k] = infinity<double>;
                }
            }
        }
        // Candidates are those of this window: there are none from before.
        alignas(64) Real at[HWY_MAX_BYTES / sizeof(Real)];
        hn::Store(tau, d, at);
        const D wide;
        for (std::size_t k = 0; k < N && first + k < end_lane; k += hn::Lanes(wide)) {
            V<D> place;
            if constexpr (sizeof(Real) == sizeof(float)) {
                place = hn::PromoteTo(wide, hn::Load(hn::Rebind<float, D>(), at + k));
            } else {
                place = hn::Load(wide, at + k);
            }
            const V<D> t = hn::MulAdd(place, hn::Set(wide, unit), hn::Set(wide, window.middle));
            hn::BlendedStore(t, lanes_in(wide, Lanes::candidate, lanes, first + k, end_lane), wide,
                             &lanes.t[first + k]);
        }
    }
    return walked;
}

// Newton's step of x half windows leaves some x^2 of one, the enclosure's first some x^4: little
// beside a cell.
double settled_share(const Window& window, double cell) {
    const double in_half_windows = 2 * cell / (window.end - window.begin);
    return std::clamp(std::sqrt(std::sqrt(0.125 * in_half_windows)), 0x1p-10, 0x1p-5);
}

Walked walk(const Window& window, double threshold, double unit, double cell, std::size_t first,
            std::size_t end, Lanes& lanes, Cancellation& stop) {
    const Stage<float> stage{window, unit, settled_share(window, cell)};
    return walk_stage(F(), stage, threshold, first, end, lanes, stop);
}

std::uint64_t walk_again(const Window& window, double threshold, std::size_t first, std::size_t end,
                         Lanes& lanes, Cancellation& stop) {
    // `faint` entries are not walked along.
    if (!window.fine_usable || window.faint.size > 0) {
        for (std::size_t k = first; k < end; ++k) {
            if (lanes.state[k] != Lanes::doubtful) continue;
            lanes.state[k] = Lanes::undecided;
            lanes.t_lo[k] = window.begin;
            lanes.t_hi[k] = infinity<double>;
        }
        return 0;
    }
    return walk_stage(D(), Stage<double>{window}, threshold, first, end, lanes, stop).steps;
}

constexpr std::size_t widest = 8;  // doubles in a vector of any target

// (2) of core/field/bundle.h.
HWY_INLINE Vec3v<D> place(const Window& window, const Vec3v<D>& direction, V<D> t) {
    const D d;
    const V<D> middle = hn::Set(d, window.middle);
    const V<D> tau = hn::Sub(t, middle);
    const auto component = [&](V<D> along, double axis) HWY_ATTR {
        return hn::MulAdd(tau, along, hn::Mul(middle, hn::Sub(along, hn::Set(d, axis))));
    };
    return {component(direction.x, window.axis.x), component(direction.y, window.axis.y),
            component(direction.z, window.axis.z)};
}

HWY_INLINE V<D> greatest_power_of_two(D d, V<D> x) {
    const hn::RebindToUnsigned<D> bits;
    return hn::BitCast(
        d, hn::And(hn::BitCast(bits, x), hn::Set(bits, std::uint64_t{0x7ff0000000000000})));
}

// The cell of the grid (Precision in core/trace/isolate.h), in units of t: directions scaled so
// that their largest component lies in [1, 2) make t half as long there, as in core/trace/clip.h,
// and so does the cell. Bit by bit the one of a ray alone.
HWY_INLINE V<D> cell_of(D d, double half_width, const Vec3v<D>& direction) {
    const auto c = [&](double value) HWY_ATTR { return hn::Set(d, value); };
    const V<D> largest =
        hn::Max(hn::Max(hn::Abs(direction.x), hn::Abs(direction.y)), hn::Abs(direction.z));
    const V<D> shift = hn::IfThenElse(hn::Lt(largest, c(1)), c(2), c(1));
    const V<D> sx = hn::Mul(direction.x, shift), sy = hn::Mul(direction.y, shift),
               sz = hn::Mul(direction.z, shift);
    const V<D> square = hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz));
    const V<D> speed = hn::Mul(hn::Sqrt(square), c(1 + 8 * 0x1p-53));
    return hn::Mul(
        greatest_power_of_two(d, hn::Mul(hn::Div(c(half_width), speed), c(1 - 8 * 0x1p-53))),
        shift);
}

// That cell where it is the same for all directions, of length 1 within 2^-50; else 0.
double common_cell(double half_width) {
    const auto power = [](double x) {
        int exponent = 0;
        std::frexp(x, &exponent);
        return std::ldexp(0.5, exponent);
    };
    const double least = power(half_width * (1 - 0x1p-47));
    return least == power(half_width * (1 + 0x1p-47)) ? least : 0;
}

// Vectors of doubles for as many lanes as one of floats has.
constexpr std::size_t halves = HWY_TARGET == HWY_SCALAR ? 1 : 2;

template <std::size_t n, class Visit>
HWY_INLINE void for_each_of(const Visit& visit) {
    visit(std::integral_constant<std::size_t, 0>());
    if constexpr (n > 1) visit(std::integral_constant<std::size_t, 1>());
}

// x + y, and to `lost` what that is off by (Knuth, The Art of Computer Programming 2, 4.2.2).
HWY_INLINE V<D> two_sum(V<D> x, V<D> y, V<D>& lost) {
    const V<D> sum = hn::Add(x, y);
    const V<D> of_y = hn::Sub(sum, x);
    lost = hn::Add(lost, hn::Add(hn::Sub(x, hn::Sub(sum, of_y)), hn::Sub(y, of_y)));
    return sum;
}

// `lost`: where sums are compensated.
template <Shape shape, KernelKind kind, bool compensated, std::size_t n>
HWY_INLINE void add_fine_group(D d, const BundleEntry<double>* entry, std::uint32_t count,
                               const Vec3v<D> (&p)[n], const Vec3v<D> (&direction)[n],
                               FieldValue<D> (&sum)[n], V<D> (&lost)[n]) {
    for (const auto* const end = entry + count; entry != end; ++entry) {
        for_each_of<n>([&](auto half) HWY_ATTR {
            V<D> square;
            const Vec3v<D> away = away_from<shape>(d, *entry, p[half], square);
            const KernelValue<D> value =
                LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry->inverse_square)));
            const V<D> strength = hn::Set(d, entry->strength);
            sum[half].f = compensated ? two_sum(sum[half].f, hn::Mul(strength, value.k), lost[half])
                                      : hn::MulAdd(strength, value.k, sum[half].f);
            const V<D> slope = hn::Mul(hn::Set(d, entry->slope), value.dk);
            sum[half].slope = hn::MulAdd(slope, dot<D>(away, direction[half]), sum[half].slope);
        });
    }
}

template <bool compensated, std::size_t n>
HWY_INLINE void add_fine(const Window& window, const Vec3v<D> (&p)[n],
                         const Vec3v<D> (&direction)[n], FieldValue<D> (&value)[n]) {
    const D d;
    V<D> lost[n];
    for_each_of<n>([&](auto half) HWY_ATTR { lost[half] = hn::Zero(d); });
    for_groups(window.fine.count,
               [&]<Shape shape, KernelKind kind>(std::size_t first, std::uint32_t count) HWY_ATTR {
                   add_fine_group<shape, kind, compensated>(d, window.fine.entry.data() + first,
                                                            count, p, direction, value, lost);
               });
    if constexpr (compensated) {
        for_each_of<n>([&](auto half)
                           HWY_ATTR { value[half].f = hn::Add(value[half].f, lost[half]); });
    }
}

template <Shape shape, KernelKind kind>
HWY_INLINE void add_faint_group(F d, const BundleEntry<float>* entry, std::uint32_t count,
                                const Vec3v<F>& p, V<F>& sum) {
    for (const auto* const end = entry + count; entry != end; ++entry) {
        V<F> square;
        away_from<shape>(d, *entry, p, square);
        const V<F> k = LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry->inverse_square))).k;
        sum = hn::MulAdd(hn::Set(d, entry->strength), k, sum);
    }
}

// Of the first n halves of a vector of floats, in double: n <= halves.
template <std::size_t n>
HWY_INLINE V<F> narrowed(const V<D> (&x)[n], double factor) {
    const hn::Rebind<float, D> narrow;
    const V<D> by = hn::Set(D(), factor);
    const auto lo = hn::DemoteTo(narrow, hn::Mul(x[0], by));
#if HWY_TARGET == HWY_SCALAR
    return lo;
#else
    return hn::Combine(F(), hn::DemoteTo(narrow, hn::Mul(x[n - 1], by)), lo);
#endif
}

// f of the fine stage, and the slope of its entries in double.
template <std::size_t n>
void evaluate_fine(const Window& window, double threshold, double unit, const Vec3v<D> (&p)[n],
                   const Vec3v<D> (&direction)[n], FieldValue<D> (&value)[n]) {
    const D d;
    const F narrow;
    for_each_of<n>([&](auto half) HWY_ATTR {
        value[half] = {hn::Set(d, -threshold), hn::Zero(d)};
    });
    if (window.compensated) {
        add_fine<true>(window, p, direction, value);
    } else {
        add_fine<false>(window, p, direction, value);
    }
    if (window.faint.size == 0) return;
    V<D> x[n], y[n], z[n];
    for_each_of<n>([&](auto half) HWY_ATTR {
        x[half] = p[half].x;
        y[half] = p[half].y;
        z[half] = p[half].z;
    });
    const Vec3v<F> near{narrowed(x, 1 / unit), narrowed(y, 1 / unit), narrowed(z, 1 / unit)};
    V<F> faint = hn::Zero(narrow);
    for_groups(window.faint.count, [&]<Shape shape, KernelKind kind>(std::size_t first,
                                                                     std::uint32_t count) HWY_ATTR {
        add_faint_group<shape, kind>(narrow, window.faint.entry.data() + first, count, near, faint);
    });
    alignas(64) float sums[HWY_MAX_BYTES / sizeof(float)];
    hn::Store(faint, narrow, sums);
    for_each_of<n>([&](auto half) HWY_ATTR {
        const auto sum = hn::Load(hn::Rebind<float, D>(), sums + half * hn::Lanes(d));
        value[half].f = hn::Add(value[half].f, hn::PromoteTo(d, sum));
    });
}

struct Enclosing {
    const Window& window;
    double threshold, unit, half_width;
    double common_cell;  // see there
    double left_out;
};

// With g(t) = f without what was left out, and `above`, `below` bounds of that and of rounding:
// f(m + x) <= g(m) + above + (slope over |x| <= delta) x for both signs of x. So f < 0 before the
// least zero of these lines, back to where g began to rise, and f > 0 after the greatest one.
// In a refined window g is another sum, and what rises before m - delta is that of the walk,
// g0 = f - (at most left_out): so delta is made so large that f(m - delta) < -left_out there. Then
// g0 + left_out is below 0 there and before, and so is f.
//
// These are the enclosures of a vector of lanes, as far as they have come.
struct Enclosed {
    M<D> open;    // more steps may bring more
    M<D> done;    // lo .. hi are the grid lines about the root
    V<D> lo, hi;  // otherwise f < 0 up to lo, and, unless it is infinite, the root before hi
    V<D> m;       // where to look next
    V<D> cell, inverse_cell;

    // With f and its slope at m.
    HWY_INLINE void take(const Enclosing& task, const FieldValue<D>& value) {
        const D d;
        const Window& window = task.window;
        const auto c = [&](double x) HWY_ATTR { return hn::Set(d, x); };
        const StageBounds& bounds = window.fine_bounds;
        const V<D> curvature = c(std::fmax(window.rise, window.fall) * (1 + 0x1p-40) + 1e-200);
        const V<D> zero = hn::Zero(d);
        const V<D> f_hi = hn::Add(value.f, c(bounds.above));
        const V<D> f_lo = hn::Sub(value.f, c(bounds.below));
        const V<D> size = hn::Add(hn::Max(hn::Abs(f_lo), hn::Abs(f_hi)), c(task.left_out));
        const V<D> inverse = hn::Div(c(1), value.slope);
        const V<D> delta = hn::Mul(hn::Mul(c(2.001), size), inverse);
        const V<D> bend = hn::MulAdd(curvature, delta, c(bounds.slope));
        const V<D> slope_lo = hn::Mul(hn::Sub(value.slope, bend), c(1 - 0x1p-40));
        // Then size / slope_lo < delta, and f < -left_out at m - delta.
        const M<D> firm = hn::And(
            hn::And(hn::Gt(value.slope, zero), hn::Gt(slope_lo, hn::Mul(value.slope, c(0.5)))),
            hn::And(hn::Ge(hn::Sub(m, delta), c(window.begin)),
                    hn::Le(hn::Add(m, delta), c(window.end))));
        // The zeros of the outer lines, each with its steeper or flatter slope: with b = bend /
        // slope < 1/2, 1 / (1 - b) <= 1 + b + 2 b^2 and 1 / (1 + b) >= 1 - b.
        const V<D> b = hn::Mul(bend, inverse);
        const V<D> flat = hn::Mul(hn::MulAdd(hn::MulAdd(c(2), b, c(1)), b, c(1)),
                                  hn::Mul(inverse, c(1 + 0x1p-40)));
        const V<D> steep = hn::Mul(hn::Sub(c(1), b), hn::Mul(inverse, c(1 - 0x1p-40)));
        const V<D> first_x =
            hn::Mul(hn::Neg(f_hi), hn::IfThenElse(hn::Gt(f_hi, zero), flat, steep));
        const V<D> last_x = hn::Mul(hn::Neg(f_lo), hn::IfThenElse(hn::Gt(f_lo, zero), steep, flat));
        const V<D> rounding = hn::Mul(hn::Add(m, delta), c(0x1p-51));
        const V<D> from = hn::Sub(hn::Add(m, first_x), rounding);
        const V<D> to = hn::Add(hn::Add(m, last_x), rounding);
        const V<D> line = hn::Mul(hn::Floor(hn::Mul(from, inverse_cell)), cell);
        const V<D> next = hn::Add(line, cell);
        const M<D> known = hn::And(open, firm);
        const M<D> decided =
            hn::And(known, hn::And(hn::And(hn::Gt(from, line), hn::Lt(to, next)),
                                   // finer cells than 8 ulp are made by other means
                                   hn::Gt(cell, hn::Mul(m, c(0x1p-48)))));
        lo = hn::IfThenElse(known, hn::IfThenElse(decided, line, from), lo);
        hi = hn::IfThenElse(known, hn::IfThenElse(decided, next, to), hi);
        done = hn::Or(done, decided);
        // The next m lies within delta of this one, so that g still rises up to there.
        open = hn::AndNot(decided, known);
        m = hn::IfThenElse(open, hn::NegMulAdd(value.f, inverse, m), m);
    }
};

HWY_INLINE Enclosed not_enclosed(const Enclosing& task, const Vec3v<D>& direction, V<D> m,
                                 M<D> lanes) {
    const D d;
    const V<D> cell = task.common_cell > 0 ? hn::Set(d, task.common_cell)
                                           : cell_of(d, task.half_width, direction);
    return {lanes,
            hn::FirstN(d, 0),
            hn::Set(d, task.window.begin),
            hn::Set(d, infinity<double>),
            m,
            cell,
            hn::Div(hn::Set(d, 1), cell)};
}

// Returns the pairs of a lane and a step.
template <std::size_t n>
HWY_INLINE std::size_t enclose_lanes(const Enclosing& task, const Vec3v<D> (&direction)[n],
                                     Enclosed (&enclosed)[n]) {
    const D d;
    std::size_t steps = 0;
    for (int step = 0; step < 4; ++step) {
        std::size_t open = 0;
        for_each_of<n>([&](auto half) HWY_ATTR { open += hn::CountTrue(d, enclosed[half].open); });
        if (open == 0) break;
        steps += open;
        Vec3v<D> p[n];
        FieldValue<D> value[n];
        for_each_of<n>([&](auto half) HWY_ATTR {
            p[half] = place(task.window, direction[half], enclosed[half].m);
        });
        evaluate_fine(task.window, task.threshold, task.unit, p, direction, value);
        for_each_of<n>([&](auto half) HWY_ATTR { enclosed[half].take(task, value[half]); });
    }
    return steps;
}

// Lanes that stand alone are gathered from here and there.
struct Batch {
    static constexpr std::size_t room = HWY_MAX_BYTES / sizeof(float);
    alignas(64) double dx[room] = {}, dy[room] = {}, dz[room] = {}, t[room] = {};
    std::uint32_t lane[room];
    std::size_t count = 0;
};

// What becomes of lanes that are not done.
struct Outcome {
    Lanes::State pinned, otherwise;
};

// The first 8 n of a batch, or as many as n vectors have.
template <std::size_t n>
std::uint64_t enclose_batch(const Enclosing& task, const Outcome& outcome, Batch& batch,
                            Lanes& lanes) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    Vec3v<D> direction[n];
    Enclosed enclosed[n];
    for_each_of<n>([&](auto half) HWY_ATTR {
        const std::size_t at = half * N;
        direction[half] = {hn::Load(d, batch.dx + at), hn::Load(d, batch.dy + at),
                           hn::Load(d, batch.dz + at)};
        enclosed[half] = not_enclosed(task, direction[half], hn::Load(d, batch.t + at),
                                      hn::FirstN(d, batch.count - std::min(at, batch.count)));
    });
    const std::uint64_t steps = enclose_lanes(task, direction, enclosed);
    for_each_of<n>([&](auto half) HWY_ATTR {
        alignas(64) double lo[HWY_MAX_BYTES / sizeof(double)], hi[HWY_MAX_BYTES / sizeof(double)];
        hn::Store(enclosed[half].lo, d, lo);
        hn::Store(enclosed[half].hi, d, hi);
        const std::uint64_t hits = bits_of(d, enclosed[half].done);
        for (std::size_t k = 0; k < N && half * N + k < batch.count; ++k) {
            const std::uint32_t lane = batch.lane[half * N + k];
            lanes.state[lane] = (hits >> k & 1) != 0       ? Lanes::hit
                                : hi[k] < infinity<double> ? outcome.pinned
                                                           : outcome.otherwise;
            lanes.t_lo[lane] = lo[k];
            lanes.t_hi[lane] = hi[k];
            lanes.t[lane] = 0.5 * (lo[k] + hi[k]);
        }
    });
    batch.count = 0;
    return steps;
}

std::uint64_t enclose_batch(const Enclosing& task, const Outcome& outcome, Batch& batch,
                            Lanes& lanes) {
    if (batch.count > hn::Lanes(D())) return enclose_batch<halves>(task, outcome, batch, lanes);
    return batch.count > 0 ? enclose_batch<1>(task, outcome, batch, lanes) : 0;
}

std::uint64_t enclose(const Window& window, double threshold, double unit, double half_width,
                      double left_out, std::size_t first, std::size_t end, Lanes::State pinned,
                      Lanes::State otherwise, Lanes& lanes, Cancellation& stop) {
    if (!window.fine_usable) {
        for (std::size_t k = first; k < end; ++k) {
            if (lanes.state[k] != Lanes::candidate) continue;
            lanes.state[k] = otherwise;
            lanes.t_lo[k] = window.begin;
            lanes.t_hi[k] = infinity<double>;
        }
        return 0;
    }
    const D d;
    const F narrow;
    const hn::Rebind<std::int32_t, D> state_lanes;
    const std::size_t N = hn::Lanes(d), step = halves * N;
    const auto set = [&](Lanes::State state)
                         HWY_ATTR { return hn::Set(d, static_cast<double>(state)); };
    const Enclosing task{window, threshold, unit, half_width, common_cell(half_width), left_out};
    const Outcome outcome{pinned, otherwise};
    Batch batch;
    std::uint64_t steps = 0;
    for (std::size_t k = first; k < end; k += step) {
        const M<F> candidates = lanes_in(narrow, Lanes::candidate, lanes, k, end);
        const std::size_t count = hn::CountTrue(narrow, candidates);
        if (count == 0) continue;
        if (stop.after(step * (window.fine.size + window.faint.size))) return steps;
        if (2 * count <= step) {
            std::uint64_t bits = bits_of(narrow, candidates);
            for (; bits != 0; bits &= bits - 1) {
                const std::size_t lane = k + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
                const std::size_t at = batch.count++;
                batch.lane[at] = static_cast<std::uint32_t>(lane);
                batch.dx[at] = lanes.dx[lane];
                batch.dy[at] = lanes.dy[lane];
                batch.dz[at] = lanes.dz[lane];
                batch.t[at] = lanes.t[lane];
                if (batch.count == step) steps += enclose_batch(task, outcome, batch, lanes);
            }
            continue;
        }
        Vec3v<D> direction[halves];
        Enclosed enclosed[halves];
        M<D> taken[halves];
        for_each_of<halves>([&](auto half) HWY_ATTR {
            const std::size_t at = k + half * N;
            direction[half] = {hn::LoadU(d, lanes.dx + at), hn::LoadU(d, lanes.dy + at),
                               hn::LoadU(d, lanes.dz + at)};
            taken[half] = lanes_in(d, Lanes::candidate, lanes, at, std::max(at, end));
            enclosed[half] =
                not_enclosed(task, direction[half], hn::LoadU(d, &lanes.t[at]), taken[half]);
        });
        steps += enclose_lanes(task, direction, enclosed);
        for_each_of<halves>([&](auto half) HWY_ATTR {
            const std::size_t at = k + half * N;
            const Enclosed& e = enclosed[half];
            const M<D> is_pinned = hn::Lt(e.hi, hn::Set(d, infinity<double>));
            const V<D> state = hn::IfThenElse(
                e.done, set(Lanes::hit), hn::IfThenElse(is_pinned, set(pinned), set(otherwise)));
            const V<D> states = hn::IfThenElse(taken[half], state, states_of(lanes, at));
            hn::StoreU(hn::DemoteTo(state_lanes, states), state_lanes, &lanes.state[at]);
            hn::BlendedStore(e.lo, taken[half], d, lanes.t_lo + at);
            hn::BlendedStore(e.hi, taken[half], d, lanes.t_hi + at);
            hn::BlendedStore(hn::Mul(hn::Set(d, 0.5), hn::Add(e.lo, e.hi)), taken[half], d,
                             &lanes.t[at]);
        });
    }
    return steps + enclose_batch(task, outcome, batch, lanes);
}

struct SurfaceSum {
    Vec3v<D> gradient, color;
    V<D> weight;
};

template <Shape shape, KernelKind kind>
HWY_INLINE void add_surface(D d, const BundleEntry<double>* entry, const std::uint32_t* element,
                            std::uint32_t count, const Field& field, const Vec3v<D>& p,
                            SurfaceSum& sum, M<D>& defined) {
    for (std::uint32_t k = 0; k < count; ++k) {
        V<D> square;
        const Vec3v<D> away = away_from<shape>(d, entry[k], p, square);
        const KernelValue<D> value =
            LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry[k].inverse_square)));
        const double inverse_square = entry[k].inverse_square * (1 / LanesOf<kind>::argument_scale);
        const V<D> slope = hn::Mul(
            hn::Set(d, 2 * LanesOf<kind>::slope_sign * entry[k].strength * inverse_square), value.dk);
        sum.gradient = {hn::MulAdd(slope, away.x, sum.gradient.x),
                        hn::MulAdd(slope, away.y, sum.gradient.y),
                        hn::MulAdd(slope, away.z, sum.gradient.z)};
        if constexpr (SkeletonOf<shape>::has_kinks) {
            defined = hn::And(
                defined, hn::Or(LanesOfShape<shape>::is_defined(d, entry[k], inverse_square, p),
                                hn::Eq(value.dk, hn::Zero(d))));
        }
        if (entry[k].strength > 0) {
            const Color& color = field.color[element[k]];
            const V<D> part = hn::Mul(hn::Set(d, entry[k].strength), value.k);
            sum.color = {hn::MulAdd(part, hn::Set(d, color.x), sum.color.x),
                         hn::MulAdd(part, hn::Set(d, color.y), sum.color.y),
                         hn::MulAdd(part, hn::Set(d, color.z), sum.color.z)};
            sum.weight = hn::Add(sum.weight, part);
        }
    }
}

void surface(const Window& window, const Field& field, const Lanes& lanes,
             std::span<const std::uint32_t> index, const double* t, SurfacePoint* surface,
             Cancellation& stop) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    for (std::size_t first = 0; first < index.size(); first += N) {
        if (stop.after(N * window.fine.size)) return;
        alignas(64) double dx[widest], dy[widest], dz[widest], at[widest];
        for (std::size_t k = 0; k < N; ++k) {
            const std::size_t item = std::min(first + k, index.size() - 1);
            const std::uint32_t lane = index[item];
            dx[k] = lanes.dx[lane];
            dy[k] = lanes.dy[lane];
            dz[k] = lanes.dz[lane];
            at[k] = t[item];
        }
        const V<D> m = hn::Load(d, at);
        const Vec3v<D> p = place(window, {hn::Load(d, dx), hn::Load(d, dy), hn::Load(d, dz)}, m);
        const V<D> zero = hn::Zero(d);
        SurfaceSum sum{{zero, zero, zero}, {zero, zero, zero}, zero};
        M<D> defined = hn::FirstN(d, N);
        for_groups(window.fine.count, [&]<Shape shape, KernelKind kind>(
                                          std::size_t group, std::uint32_t count) HWY_ATTR {
            add_surface<shape, kind>(d, window.fine.entry.data() + group,
                                     window.fine.element.data() + group, count, field, p, sum,
                                     defined);
        });
        const V<D> length = hn::Sqrt(dot<D>(sum.gradient, sum.gradient));
        const V<D> inverse = hn::Div(hn::Set(d, -1.0), length);
        const V<D> share = hn::Div(hn::Set(d, 1.0), sum.weight);
        defined = hn::And(defined, hn::And(hn::Gt(length, hn::Set(d, 1e-100)),
                                           hn::Gt(sum.weight, hn::Set(d, 1e-100))));
        const V<D> nan = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
        alignas(64) double out[6][widest];
        hn::Store(hn::IfThenElse(defined, hn::Mul(sum.gradient.x, inverse), nan), d, out[0]);
        hn::Store(hn::Mul(sum.gradient.y, inverse), d, out[1]);
        hn::Store(hn::Mul(sum.gradient.z, inverse), d, out[2]);
        hn::Store(hn::Mul(sum.color.x, share), d, out[3]);
        hn::Store(hn::Mul(sum.color.y, share), d, out[4]);
        hn::Store(hn::Mul(sum.color.z, share), d, out[5]);
        for (std::size_t k = 0; k < N && first + k < index.size(); ++k) {
            surface[first + k] = {{out[0][k], out[1][k], out[2][k]},
                                  {out[3][k], out[4][k], out[5][k]}};
        }
    }
}

// Sums of what is only looked at.
struct LookSum {
    Vec3v<F> gradient, color;
    V<F> weight;
};

template <Shape shape, KernelKind kind>
HWY_INLINE void add_look(F d, const BundleEntry<float>* entry, const std::uint32_t* element,
                         std::uint32_t count, const Field& field, const Vec3v<F>& p, LookSum& sum) {
    constexpr auto to_slope = static_cast<float>(2 * LanesOf<kind>::slope_sign / LanesOf<kind>::argument_scale);
    for (std::uint32_t k = 0; k < count; ++k) {
        const BundleEntry<float>& e = entry[k];
        V<F> square;
        const Vec3v<F> away = away_from<shape>(d, e, p, square);
        const KernelValue<F> value = LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, e.inverse_square)));
        const V<F> slope = hn::Mul(hn::Set(d, to_slope * e.strength * e.inverse_square), value.dk);
        sum.gradient = {hn::MulAdd(slope, away.x, sum.gradient.x),
                        hn::MulAdd(slope, away.y, sum.gradient.y),
                        hn::MulAdd(slope, away.z, sum.gradient.z)};
        if (field.one_color || !(e.strength > 0)) continue;
        const V<F> part = hn::Mul(hn::Set(d, e.strength), value.k);
        const std::uint32_t i = element[k];
        sum.color = {hn::MulAdd(part, hn::Set(d, field.red[i]), sum.color.x),
                     hn::MulAdd(part, hn::Set(d, field.green[i]), sum.color.y),
                     hn::MulAdd(part, hn::Set(d, field.blue[i]), sum.color.z)};
        sum.weight = hn::Add(sum.weight, part);
    }
}

// The bounds of f and f' hold for the sum of positive F_i and for the gradient too: for each entry
// they bound the errors of F and of |grad F|.
Looked look(const Window& window, const Field& field, double unit, double limit, const Lanes& lanes,
            std::size_t first_lane, std::size_t end_lane, BundleSurfaces& surfaces, Cancellation& stop) {
    const F d;
    const D wide;
    const std::size_t N = hn::Lanes(d);
    const V<F> zero = hn::Zero(d);
    constexpr double firm_share = 0x1p9;
    const StageBounds& bounds = window.coarse_bounds;
    const V<D> begin = hn::Set(wide, window.begin), middle = hn::Set(wide, window.middle),
               end = hn::Set(wide, std::fmin(window.end, limit)),
               per_unit = hn::Set(wide, 1 / unit),
               nowhere = hn::Set(wide, std::numeric_limits<double>::quiet_NaN());
    Looked looked;
    for (std::size_t first = first_lane; first < end_lane; first += N) {
        const M<F> hits = lanes_in(d, Lanes::hit, lanes, first, end_lane);
        if (hn::AllFalse(d, hits)) continue;
        alignas(64) double places[HWY_MAX_BYTES / sizeof(float)];
        for (std::size_t k = 0; k < N; k += hn::Lanes(wide)) {
            const V<D> t = hn::LoadU(wide, &lanes.t[first + k]);
            const M<D> inside = hn::And(hn::Ge(t, begin), hn::Lt(t, end));
            const V<D> tau = hn::Mul(hn::Sub(t, middle), per_unit);
            hn::Store(hn::IfThenElse(inside, tau, nowhere), wide, places + k);
        }
        const V<F> tau = rounded_difference(places, 0);
        const M<F> wanted = hn::AndNot(hn::IsNaN(tau), hits);
        if (hn::AllFalse(d, wanted)) continue;
        looked.wanted += hn::CountTrue(d, wanted);
        if (stop.after(N * (window.strong.size + window.weak.size))) return looked;
        const V<F> t = hn::IfThenElseZero(wanted, tau);
        const RayLanes<F> rays = rays_of(d, window, unit, lanes, first);
        const Vec3v<F> p{hn::MulAdd(t, rays.direction.x, rays.middle.x),
                         hn::MulAdd(t, rays.direction.y, rays.middle.y),
                         hn::MulAdd(t, rays.direction.z, rays.middle.z)};
        LookSum sum{{zero, zero, zero}, {zero, zero, zero}, zero};
        for (const StageEntries<float>* stage : {&window.strong, &window.weak}) {
            for_groups(stage->count, [&]<Shape shape, KernelKind kind>(
                                         std::size_t group, std::uint32_t count) HWY_ATTR {
                add_look<shape, kind>(d, stage->entry.data() + group, stage->element.data() + group,
                                      count, field, p, sum);
            });
        }
        const V<F> length = hn::Sqrt(dot<F>(sum.gradient, sum.gradient));
        M<F> firm = hn::Gt(length, hn::Set(d, static_cast<float>(firm_share * bounds.slope)));
        const V<F> inverse = hn::Div(hn::Set(d, -1.0F), length);
        Vec3v<F> color;
        if (field.one_color) {
            const Color c = field.color.empty() ? Color{} : field.color.front();
            color = {hn::Set(d, static_cast<float>(c.x)), hn::Set(d, static_cast<float>(c.y)),
                     hn::Set(d, static_cast<float>(c.z))};
        } else {
            const double error = std::fmax(bounds.above, bounds.below);
            firm = hn::And(firm,
                           hn::Gt(sum.weight, hn::Set(d, static_cast<float>(firm_share * error))));
            const V<F> share = hn::Div(hn::Set(d, 1.0F), sum.weight);
            color = {hn::Mul(sum.color.x, share), hn::Mul(sum.color.y, share),
                     hn::Mul(sum.color.z, share)};
        }
        const M<F> known = hn::And(wanted, firm);
        looked.known += hn::CountTrue(d, known);
        const auto put = [&](V<F> value, std::array<float, BundleSurfaces::room>& column)
                             HWY_ATTR { hn::BlendedStore(value, known, d, &column[first]); };
        put(hn::Mul(sum.gradient.x, inverse), surfaces.nx);
        put(hn::Mul(sum.gradient.y, inverse), surfaces.ny);
        put(hn::Mul(sum.gradient.z, inverse), surfaces.nz);
        put(color.x, surfaces.r);
        put(color.y, surfaces.g);
        put(color.z, surfaces.b);
    }
    return looked;
}

}  // namespace

const PacketSteps& steps_of_target() {
    static const PacketSteps steps{prepare, any,  walk,    walk_again,
                                   enclose, look, surface, conclude};
    return steps;
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(steps_of_target);

const PacketSteps& packet_steps() { return HWY_DYNAMIC_DISPATCH(steps_of_target)(); }

}  // namespace ivory
#endif
