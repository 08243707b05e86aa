// Safe steps of a packet: up to where a root cannot be ruled out, and on to a guess of it.
#if defined(IVORY_CORE_TRACE_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_WALK_INL
#undef IVORY_CORE_TRACE_WALK_INL
#else
#define IVORY_CORE_TRACE_WALK_INL
#endif

#include <algorithm>
#include <cmath>

#include "core/field/condensed.inl"
#include "core/trace/field_lanes.inl"
#include "core/trace/packet_lanes.inl"

#define IVORY_LANES
#include "core/trace/safe_step.h"
#undef IVORY_LANES

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// What the walk needs to know of the stage that it runs in.
template <class Real>
struct Stage;

template <>
struct Stage<float> {
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

constexpr int most_steps = 48;
constexpr double reach_of_steps = 4;  // of the next, in those of the last one

// Of f's other branches, joined elements with b > 0 being the greatest of several parts: on the way to
// the zero x of the parabola below the one that is known, each rises all along, if its slope is at
// least half of that one's, or stays below 0, if it is less.
template <class Tag>
HWY_INLINE M<Tag> no_other_first(Tag d, V<Tag> f_hi, V<Tag> slope_lo, V<Tag> rise, V<Tag> fall,
                                 V<Tag> x) {
    using Real = hn::TFromD<Tag>;
    const V<Tag> half = hn::Set(d, Real{0.5}), slope = hn::Mul(slope_lo, half);
    const V<Tag> gain = hn::Mul(hn::MulAdd(hn::Mul(rise, half), x, slope), x);
    const V<Tag> room = hn::Mul(f_hi, hn::Set(d, Real{2} * StepMargins<Real>::tight - 1));
    return hn::And(hn::Gt(slope, hn::Mul(hn::Mul(fall, x),
                                         hn::Set(d, 1 + Real{2} * StepMargins<Real>::tight))),
                   hn::Lt(gain, room));
}

template <class Tag>
Walked walk_stage(Tag d, const Stage<hn::TFromD<Tag>>& stage, double threshold,
                  std::size_t begin_lane, std::size_t end_lane, Lanes& lanes, Cancellation& stop) {
    using Real = hn::TFromD<Tag>;
    using S = Stage<Real>;
    using Margin = StepMargins<Real>;
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
    const V<Tag> window_rise = c(window.rise * unit * unit * (1 + 2 * Margin::tight) + S::tiny);
    const V<Tag> window_fall = c(window.fall * unit * unit * (1 + 2 * Margin::tight) + S::tiny);
    const V<Tag> begin = c(stage.begin()), end = c(stage.end());
    // The sum tau + step is off by half a unit of its last place.
    const V<Tag> slack = c(S::last_place * stage.end());
    const V<Tag> settled = c(stage.settled * stage.end());
    const V<Tag> zero = hn::Zero(d), one_more = c(1 + Margin::tight);
    const V<Tag> least = c(least_square<Real>);
    JoinedEntries joined = joined_entries(stage.entries());
    if constexpr (has_weak) joined.add(joined_entries(stage.more_entries()));
    const V<Tag> error = c(2 * widened * (bounds.above + bounds.below));
    const V<Tag> least_reach = c(0x1p-10 * stage.end());
    Branches<Tag> branches;
    branches.begin(zero, zero, zero);
    Walked walked;
    std::uint64_t work = N * stage.entries().size;  // of a step, at most
    if constexpr (has_weak) {
        work += N * stage.more_entries().size;
        if (window.condensed != nullptr) work += N * Condensed::room / 16;
    }

    for (std::size_t first = begin_lane; first < end_lane; first += N) {
        M<Tag> walking = lanes_in(d, S::takes, lanes, first, end_lane);
        if (hn::AllFalse(d, walking)) continue;
        const M<Tag> taken = walking;
        const RayLanes<Tag> rays = rays_of(d, window, unit, lanes, first);
        const Vec3v<Tag>&direction = rays.direction, &middle = rays.middle;
        V<Tag> tau = begin, guess_lo = zero, guess_hi = zero;
        V<Tag> last_tau = zero, last_slope = zero;  // of the step before
        M<Tag> guessing = hn::FirstN(d, 0), found = guessing, undecided = guessing;
        V<Tag> reach = hn::Sub(end, tau);  // as far as which other branches are asked for
        V<Tag> guesses = zero;  // of each lane, so that no lane's way depends on its neighbours
        for (int step = 0; step < most_steps; ++step) {
            const M<Tag> active = hn::Or(walking, guessing);
            walked.steps += hn::CountTrue(d, active);
            if (stop.after(work)) return walked;
            const Vec3v<Tag> p{hn::MulAdd(tau, direction.x, middle.x),
                               hn::MulAdd(tau, direction.y, middle.y),
                               hn::MulAdd(tau, direction.z, middle.z)};
            if (joined.any()) {
                reach = hn::Max(hn::Min(reach, hn::Sub(end, tau)), least_reach);
                branches.begin(reach, hn::Mul(rough_inverse(d, reach), c(1 - 2 * Margin::rough)),
                               error);
            }
            FieldValue<Tag> value = evaluate(d, stage.entries(), threshold, p, direction, branches);
            V<Tag> above = all_above, below = all_below, slope_error = all_slope_error;
            if constexpr (!has_weak) {
                if (window.along != nullptr) {
                    add_condensed(d, *window.along, tau, value.f, value.slope);
                }
            }
            if constexpr (has_weak) {
                if (window.condensed != nullptr) {
                    add_condensed(d, *window.condensed, p, direction, value.f, value.slope);
                }
                const M<Tag> close = hn::And(
                    active, hn::Or(guessing,
                                   hn::Not(hn::Lt(value.f, hn::Mul(c(-S::far_below), all_above)))));
                if (stage.more_entries().size > 0 && !hn::AllFalse(d, close)) {
                    walked.close_steps += hn::CountTrue(d, close);
                    FieldValue<Tag> sum = value;
                    // For lanes that are not close what is more is too much, which does no harm.
                    add(d, stage.more_entries(), p, direction, sum, branches);
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

            V<Tag> rise = window_rise, fall = window_fall;
            if (joined.any()) {
                above = hn::MulAdd(branches.more, c(widened), above);
                below = hn::MulAdd(branches.less, c(widened), below);
                rise = hn::MulAdd(branches.rise, c(1 + 4 * Margin::tight), rise);
                fall = hn::MulAdd(branches.fall, c(1 + 4 * Margin::tight), fall);
            }

            // f(tau) < 0 must be certain for anything else to be.
            const V<Tag> f_hi = hn::Add(value.f, above);
            const V<Tag> f_lo = hn::Mul(hn::Sub(value.f, below), one_more);
            V<Tag> slope_lo = hn::Sub(value.slope, slope_error);
            V<Tag> slope_hi = hn::Add(value.slope, slope_error);
            if (joined.any()) slope_hi = hn::Add(slope_hi, branches.above);
            // Where some carve, all branches have to rise.
            if (joined.some_carve) slope_lo = hn::Sub(slope_lo, branches.anywhere);
            undecided = hn::Or(undecided, hn::And(walking, hn::Not(hn::Lt(f_hi, zero))));
            walking = hn::AndNot(undecided, walking);

            // The parabola below f: with a zero in the window, g rises up to there.
            const LatestZero<Tag> latest = latest_zero(d, f_lo, slope_lo, fall);
            const V<Tag> latest_tau = hn::Add(tau, latest.x);
            M<Tag> rises = hn::And(walking, hn::And(latest.is_firm, hn::Le(latest_tau, end)));
            if (joined.any()) rises = hn::And(rises, hn::Le(latest.x, reach));
            if (joined.some_add) {
                rises = hn::And(rises, no_other_first(d, f_hi, slope_lo, rise, fall, latest.x));
            }

            // The parabola above f: up to its zero there is no root.
            const V<Tag> quotient = parabola_zero(d, f_hi, slope_hi, rise);
            V<Tag> safe = hn::MulSub(quotient, c(1 - Margin::rough), slack);
            if (joined.any()) {
                // What is known of other branches holds as far as they were asked for. Where that is far beyond
                // the step less may hold it up.
                safe = hn::Min(safe, hn::Sub(reach, slack));
                const M<Tag> holds_up =
                    hn::Gt(hn::Mul(branches.above, safe), hn::Mul(hn::Abs(f_hi), c(0.25)));
                reach = hn::IfThenElse(holds_up, hn::Mul(safe, c(reach_of_steps)), end);
            }
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
    if (!window.fine_usable || window.fine_in_float.size > 0) {
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
