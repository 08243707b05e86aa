// What is certain of all rays of a pixel, from the one in its middle (core/trace/footprint.h).
#if defined(IVORY_CORE_TRACE_CERTIFY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_CERTIFY_INL
#undef IVORY_CORE_TRACE_CERTIFY_INL
#else
#define IVORY_CORE_TRACE_CERTIFY_INL
#endif

#include "core/trace/field_lanes.inl"
#include "core/trace/packet_lanes.inl"
#include "core/trace/walk.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// f in the middle, grad f of what is neither joined nor kinked there, its slope along the ray, and that with
// a guess of what is joined.
struct Middle {
    V<F> f, open;  // f may be more or less by as much
    Vec3v<F> gradient;
    V<F> known_slope, slope;
};

template <Shape shape, KernelKind kind>
HWY_INLINE void add_middle(F d, const BundleEntry<float>* entry, std::uint32_t count,
                           const Vec3v<F>& p, const Vec3v<F>& direction, Middle& sum) {
    for (const auto* const end = entry + count; entry != end; ++entry) {
        if constexpr (proves_feet<shape>) {
            if (any_proof(entry)) {
                Branches<F> branches;
                branches.begin(hn::Zero(d), hn::Zero(d), hn::Zero(d));
                const V<F> strength = hn::Set(d, entry->strength);
                const V<F> k =
                    add_proved_parts<shape, kind>(d, entry, p, direction, sum.slope, branches);
                sum.f = hn::MulAdd(strength, k, sum.f);
                sum.open = hn::Add(sum.open, hn::Add(branches.more, branches.less));
                --entry;
                continue;
            }
        }
        V<F> square;
        Vec3v<F> away = away_from<shape>(d, *entry, p, square);
        V<F> s = hn::Mul(square, hn::Set(d, entry->inverse_square));
        V<F> full = hn::Set(d, entry->slope);
        if constexpr (SkeletonOf<shape>::is_joined) {
            for (; entry->joins != 0; ++entry) {
                const Vec3v<F> other = away_from<shape>(d, entry[1], p, square);
                const V<F> s_other = hn::Mul(square, hn::Set(d, entry[1].inverse_square));
                const M<F> nearer = hn::Not(hn::Ge(s_other, s));  // what is no number shows
                s = hn::IfThenElse(nearer, s_other, s);
                full = hn::IfThenElse(nearer, hn::Set(d, entry[1].slope), full);
                away = {hn::IfThenElse(nearer, other.x, away.x),
                        hn::IfThenElse(nearer, other.y, away.y),
                        hn::IfThenElse(nearer, other.z, away.z)};
            }
        }
        const KernelValue<F> value = LanesOf<kind>::at(d, s);
        sum.f = hn::MulAdd(hn::Set(d, entry->strength), value.k, sum.f);
        const V<F> slope = hn::Mul(full, value.dk);
        if constexpr (SkeletonOf<shape>::is_joined) {
            sum.slope = hn::MulAdd(slope, dot<F>(away, direction), sum.slope);
        } else {
            sum.gradient = {hn::MulAdd(slope, away.x, sum.gradient.x),
                            hn::MulAdd(slope, away.y, sum.gradient.y),
                            hn::MulAdd(slope, away.z, sum.gradient.z)};
        }
    }
}

// The middle rays of a window, and by how much f can differ from there to the pixel's other rays.
struct FootprintStage {
    const Window& window;
    float threshold;
    // Per unit: rho >= the distance of another ray, steepest of what has no gradient, the second
    // derivatives in any direction and the curvature along the ray.
    float rho, unknown_slope, across, rise;
    float above, below;

    HWY_INLINE Middle middle(const RayLanes<F>& rays, V<F> tau) const {
        const F d;
        const V<F> zero = hn::Zero(d);
        const Vec3v<F> p{hn::MulAdd(tau, rays.direction.x, rays.middle.x),
                         hn::MulAdd(tau, rays.direction.y, rays.middle.y),
                         hn::MulAdd(tau, rays.direction.z, rays.middle.z)};
        Middle sum{hn::Set(d, -threshold), zero, {zero, zero, zero}, zero, zero};
        for (const StageEntries<float>* stage : {&window.strong, &window.weak}) {
            for_groups(*stage, [&]<Shape shape, KernelKind kind>(std::size_t first,
                                                                 std::uint32_t count) HWY_ATTR {
                add_middle<shape, kind>(d, stage->entry.data() + first, count, p, rays.direction,
                                        sum);
            });
        }
        sum.known_slope = dot<F>(sum.gradient, rays.direction);
        sum.slope = hn::Add(sum.slope, sum.known_slope);
        return sum;
    }
    // |f(p') - f(p)| for p' of another ray at the same t: the gradient's part and that of the second
    // derivatives over at most rho.
    HWY_INLINE V<F> lateral(const Middle& at) const {
        const F d;
        constexpr float widened = 1 + 0x1p-10F;
        const V<F> length = hn::Sqrt(dot<F>(at.gradient, at.gradient));
        return hn::Mul(hn::Add(length, hn::Set(d, unknown_slope + 0.5F * across * rho)),
                       hn::Set(d, rho * widened));
    }
};

constexpr int most_footprint_steps = 48, most_entry_guesses = 4, most_root_steps = 8;
// A root is known to so many distances of the pixel's rays.
constexpr double close_to_root = 1.0 / 64;
// And where the normal may turn by more over rho, in radians, the middle does not say how the pixel looks.
constexpr double most_turn = 0.5;

// Lanes that walk, up to where f + lateral < 0 cannot be told any longer, and from there to a place where
// f - lateral > 0: all of the pixel's rays have their first root between. If that is not in the window, the
// next one, which has to begin where this one ends, goes on.
std::uint64_t certify(const Window& window, const FootprintBounds& bounds, double threshold,
                      double unit, std::size_t begin_lane, std::size_t end_lane, Lanes& lanes,
                      EnteringRays& entering, Cancellation& stop) {
    using Margin = StepMargins<float>;
    constexpr double widened = 1 + 0x1p-18;
    const F d;
    const std::size_t N = hn::Lanes(d);
    const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<float>(value)); };
    const double per_square = unit * unit * widened;
    const FootprintStage stage{
        window,
        static_cast<float>(threshold),
        static_cast<float>(bounds.rho / unit * widened),
        static_cast<float>((window.coarse_bounds.slope + bounds.across.joined_slope * unit) *
                           widened),
        static_cast<float>(bounds.across.curvature * per_square),
        static_cast<float>(window.rise * unit * unit * (1 + 2 * Margin::tight) + 1e-20),
        static_cast<float>(window.coarse_bounds.above * widened),
        static_cast<float>(window.coarse_bounds.below * widened)};
    const V<F> zero = hn::Zero(d), begin = c(window.tau_begin), end = c(window.tau_end);
    const V<F> slack = c(0x1p-22 * window.tau_end);
    const V<F> rise = hn::Set(d, stage.rise);
    // Along the ray f gains what is not smooth at its steepest, and `lateral` at most rho times the
    // second derivatives.
    const V<F> more_slope =
        c((double{stage.unknown_slope} + double{stage.across} * stage.rho) * widened);
    const std::uint64_t work = N * (window.strong.size + window.weak.size);
    std::uint64_t steps = 0;
    for (std::size_t first = begin_lane; first < end_lane; first += N) {
        const M<F> enters = lanes_in(d, Lanes::entering, lanes, first, end_lane);
        M<F> walking = lanes_in(d, Lanes::walking, lanes, first, end_lane);
        const M<F> taken = hn::Or(walking, enters);
        if (hn::AllFalse(d, taken)) continue;
        M<F> near = hn::FirstN(d, 0), undecided = near, found = near;
        const RayLanes<F> rays = rays_of(d, window, unit, lanes, first);
        V<F> tau = begin, f_near = zero, slope_near = zero, lateral_near = zero;
        for (int step = 0; step < most_footprint_steps && !hn::AllFalse(d, walking); ++step) {
            steps += hn::CountTrue(d, walking);
            if (stop.after(work)) return steps;
            const Middle middle = stage.middle(rays, tau);
            const V<F> lateral = stage.lateral(middle);
            const V<F> f_hi =
                hn::Add(hn::Add(middle.f, middle.open), hn::Add(hn::Set(d, stage.above), lateral));
            const M<F> below = hn::And(walking, hn::Lt(f_hi, zero));
            undecided = hn::Or(undecided, hn::AndNot(below, walking));
            const V<F> slope_hi = hn::Add(middle.known_slope, more_slope);
            const V<F> safe =
                hn::MulSub(parabola_zero(d, f_hi, slope_hi, rise), c(1 - Margin::rough), slack);
            // Close enough that a root is the likelier end.
            const M<F> comes_near = hn::And(
                below,
                hn::And(hn::Gt(middle.slope, zero), hn::Gt(f_hi, hn::Mul(c(-0.75), lateral))));
            const M<F> steps_on = hn::AndNot(comes_near, below);
            undecided =
                hn::Or(undecided,
                       hn::AndNot(hn::And(hn::Gt(safe, slack), hn::Lt(safe, c(3e38))), steps_on));
            f_near = hn::IfThenElse(comes_near, middle.f, f_near);
            slope_near = hn::IfThenElse(comes_near, middle.slope, slope_near);
            lateral_near = hn::IfThenElse(comes_near, lateral, lateral_near);
            near = hn::Or(near, comes_near);
            tau = hn::IfThenElse(steps_on, hn::Add(tau, safe), tau);
            walking = hn::And(hn::AndNot(undecided, steps_on), hn::Lt(tau, end));
        }
        undecided = hn::Or(undecided, walking);

        const auto is_inside = [&](const Middle& middle, V<F> lateral) HWY_ATTR {
            return hn::Gt(
                hn::Sub(hn::Sub(middle.f, middle.open), hn::Add(hn::Set(d, stage.below), lateral)),
                zero);
        };
        V<F> inside = tau, f_inside = zero;
        if (!hn::AllFalse(d, enters)) {
            steps += hn::CountTrue(d, enters);
            const Middle middle = stage.middle(rays, begin);
            const V<F> lateral = stage.lateral(middle);
            found = hn::And(enters, is_inside(middle, lateral));
            const M<F> onward = hn::AndNot(found, hn::And(enters, hn::Gt(middle.slope, zero)));
            undecided = hn::Or(undecided, hn::AndNot(hn::Or(found, onward), enters));
            tau = hn::IfThenElse(enters, begin, tau);
            inside = hn::IfThenElse(enters, begin, inside);
            f_inside = hn::IfThenElse(found, middle.f, f_inside);
            f_near = hn::IfThenElse(enters, middle.f, f_near);
            slope_near = hn::IfThenElse(onward, middle.slope, slope_near);
            lateral_near = hn::IfThenElse(onward, lateral, lateral_near);
            near = hn::Or(near, onward);
        }
        // The place where all are inside, by Newton's method onto f = lateral and some more.
        M<F> guessing = near, at_end = hn::FirstN(d, 0);
        V<F> slope = slope_near, f = f_near, aim = lateral_near;
        for (int guess = 0; guess < most_entry_guesses && !hn::AllFalse(d, guessing); ++guess) {
            steps += hn::CountTrue(d, guessing);
            if (stop.after(work)) return steps;
            const V<F> wanted = hn::MulAdd(aim, c(1.25), c(1.25 * (stage.above + stage.below)));
            const V<F> onward = hn::Mul(hn::Sub(wanted, f), rough_inverse(d, slope));
            inside = hn::IfThenElse(guessing, hn::Min(hn::Max(hn::Add(inside, onward), tau), end),
                                    inside);
            const Middle middle = stage.middle(rays, inside);
            aim = stage.lateral(middle);
            f = middle.f;
            slope = middle.slope;
            const M<F> all_inside = hn::And(guessing, is_inside(middle, aim));
            f_inside = hn::IfThenElse(guessing, f, f_inside);
            found = hn::Or(found, all_inside);
            // still rising: else it is on the way out again
            guessing = hn::And(hn::AndNot(all_inside, guessing), hn::Gt(slope, zero));
            const M<F> comes_to_end = hn::And(guessing, hn::Ge(inside, end));
            at_end = hn::Or(at_end, comes_to_end);
            guessing = hn::AndNot(comes_to_end, guessing);
        }
        undecided = hn::Or(undecided, hn::AndNot(hn::Or(found, at_end), near));
        // The middle's own root, where f changes its sign in the window: from the chord on by Newton's
        // steps, kept between.
        const M<F> crosses = hn::And(hn::And(hn::Or(found, at_end), near),
                                     hn::And(hn::Lt(f_near, zero), hn::Gt(f_inside, zero)));
        // Or rounding had it in the window before and here.
        const M<F> begins = hn::And(enters, hn::Ge(f_near, zero));
        V<F> root = begin;
        if (!hn::AllFalse(d, crosses)) {
            const V<F> share = hn::Div(hn::Neg(f_near), hn::Sub(f_inside, f_near));
            root = hn::IfThenElse(crosses, hn::MulAdd(hn::Sub(inside, tau), share, tau), root);
            V<F> lo = tau, hi = inside, steepness = zero;
            M<F> moving = crosses;
            for (int step = 0; step < most_root_steps && !hn::AllFalse(d, moving); ++step) {
                steps += hn::CountTrue(d, moving);
                const Middle middle = stage.middle(rays, root);
                steepness =
                    hn::IfThenElse(moving, dot<F>(middle.gradient, middle.gradient), steepness);
                const M<F> before = hn::Lt(middle.f, zero);
                lo = hn::IfThenElse(before, root, lo);
                hi = hn::IfThenElse(before, hi, root);
                const V<F> newton =
                    hn::Sub(root, hn::Mul(middle.f, rough_inverse(d, middle.slope)));
                const M<F> within = hn::And(hn::Gt(middle.slope, zero),
                                            hn::And(hn::Ge(newton, lo), hn::Le(newton, hi)));
                const V<F> next = hn::IfThenElse(within, newton, hn::Mul(c(0.5), hn::Add(lo, hi)));
                const V<F> moved = hn::Abs(hn::Sub(next, root));
                root = hn::IfThenElse(moving, next, root);
                moving = hn::And(moving, hn::Gt(moved, c(close_to_root * double{stage.rho})));
            }
            if (bounds.across.joined_slope == 0) {
                const double turning = double{stage.across} * stage.rho / most_turn;
                undecided =
                    hn::Or(undecided, hn::And(crosses, hn::Lt(steepness, c(turning * turning))));
            }
        }
        const std::uint64_t found_bits = bits_of(d, found), undecided_bits = bits_of(d, undecided),
                            taken_bits = bits_of(d, taken), enters_bits = bits_of(d, enters),
                            end_bits = bits_of(d, at_end), crosses_bits = bits_of(d, crosses),
                            begins_bits = bits_of(d, begins);
        constexpr std::size_t lanes_at_most = HWY_MAX_BYTES / sizeof(float);
        alignas(64) float at[lanes_at_most];
        hn::Store(root, d, at);
        for (std::size_t k = 0; k < N && first + k < end_lane; ++k) {
            const std::size_t lane = first + k;
            const auto is = [&](std::uint64_t bits) { return (bits >> k & 1) != 0; };
            if (!is(taken_bits)) continue;
            std::int32_t& state = lanes.state[lane];
            if (is(undecided_bits) || (is(enters_bits) && entering.end[lane] != window.begin)) {
                state = Lanes::undecided;
                continue;
            }
            if (!is(found_bits) && !is(end_bits)) continue;  // walks on
            if (!is(enters_bits)) entering.seen[lane] = 0;
            entering.end[lane] = window.end;
            entering.pending[lane] = is(found_bits) ? 0 : 1;
            if (entering.seen[lane] != 0) {
                state = is(found_bits) ? Lanes::hit : Lanes::entering;
                continue;
            }
            // The root is in this window, or was at its very begin.
            if (is(found_bits) || is(crosses_bits) || is(begins_bits)) {
                entering.seen[lane] = 1;
                state = Lanes::hit;
                lanes.t[lane] = std::clamp(window.middle + double{at[k]} * unit, window.begin,
                                           std::nextafter(window.end, window.begin));
            } else {
                state = Lanes::entering;
            }
        }
    }
    return steps;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
