// The enclosure of the roots of a packet, in double, on the grid of core/trace/isolate.h.
#if defined(IVORY_CORE_TRACE_ENCLOSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_ENCLOSE_INL
#undef IVORY_CORE_TRACE_ENCLOSE_INL
#else
#define IVORY_CORE_TRACE_ENCLOSE_INL
#endif

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/field/condensed.inl"
#include "core/trace/field_lanes.inl"
#include "core/trace/packet_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

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

template <Shape shape, KernelKind kind, bool compensated>
HWY_NOINLINE void add_joined_fine_group(D d, const BundleEntry<double>* entry, std::uint32_t count,
                                        const Vec3v<D>& p, const Vec3v<D>& direction,
                                        FieldValue<D>& sum, Branches<D>& branches, V<D>& lost) {
    for (const auto* const end = entry + count; entry != end;) {
        const V<D> strength = hn::Set(d, entry->strength);
        const V<D> k = add_element<shape, kind>(d, entry, p, direction, sum.slope, branches);
        sum.f = compensated ? two_sum(sum.f, hn::Mul(strength, k), lost)
                            : hn::MulAdd(strength, k, sum.f);
    }
}

// `lost`: where sums are compensated.
template <Shape shape, KernelKind kind, bool compensated, std::size_t n>
HWY_INLINE void add_fine_group(D d, const BundleEntry<double>* entry, std::uint32_t count,
                               const Vec3v<D> (&p)[n], const Vec3v<D> (&direction)[n],
                               FieldValue<D> (&sum)[n], Branches<D> (&branches)[n],
                               V<D> (&lost)[n]) {
    if constexpr (SkeletonOf<shape>::is_joined) {
        for_each_of<n>([&](auto half) HWY_ATTR {
            add_joined_fine_group<shape, kind, compensated>(
                d, entry, count, p[half], direction[half], sum[half], branches[half], lost[half]);
        });
        return;
    }
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
                         const Vec3v<D> (&direction)[n], FieldValue<D> (&value)[n],
                         Branches<D> (&branches)[n]) {
    const D d;
    V<D> lost[n];
    for_each_of<n>([&](auto half) HWY_ATTR { lost[half] = hn::Zero(d); });
    for_groups(window.fine, [&]<Shape shape, KernelKind kind>(std::size_t first,
                                                              std::uint32_t count) HWY_ATTR {
        add_fine_group<shape, kind, compensated>(d, window.fine.entry.data() + first, count, p,
                                                 direction, value, branches, lost);
    });
    if constexpr (compensated) {
        for_each_of<n>([&](auto half)
                           HWY_ATTR { value[half].f = hn::Add(value[half].f, lost[half]); });
    }
}

// `open`: what f may be off by where feet are to be proved. Of many the sums of some are added up.
template <Shape shape, KernelKind kind>
HWY_INLINE void add_float_group(F d, const BundleEntry<float>* entry, std::uint32_t count,
                                const Vec3v<F>& p, V<F>& total, V<F>& open) {
    V<F> sum = hn::Zero(d);
    std::uint32_t added = 0;
    for (const auto* const end = entry + count; entry != end; ++entry) {
        if (++added % float_sum_length == 0) {
            total = hn::Add(total, sum);
            sum = hn::Zero(d);
        }
        if constexpr (proves_feet<shape>) {
            if (any_proof(entry)) {
                sum = hn::MulAdd(hn::Set(d, entry->strength),
                                 greatest_part<shape, kind>(d, entry, p, open), sum);
                continue;
            }
        }
        V<F> square;
        away_from<shape>(d, *entry, p, square);
        V<F> s = hn::Mul(square, hn::Set(d, entry->inverse_square));
        if constexpr (SkeletonOf<shape>::is_joined) {
            for (; entry->joins != 0; ++entry) {
                away_from<shape>(d, entry[1], p, square);
                s = hn::Min(s, hn::Mul(square, hn::Set(d, entry[1].inverse_square)));
            }
        }
        sum = hn::MulAdd(hn::Set(d, entry->strength), LanesOf<kind>::at(d, s).k, sum);
    }
    total = hn::Add(total, sum);
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
void evaluate_fine(const Window& window, double threshold, double unit, bool has_joined,
                   const Vec3v<D> (&p)[n], const Vec3v<D> (&direction)[n],
                   FieldValue<D> (&value)[n], Branches<D> (&branches)[n]) {
    const D d;
    const F narrow;
    for_each_of<n>([&](auto half) HWY_ATTR {
        value[half] = {hn::Set(d, -threshold), hn::Zero(d)};
    });
    if (window.compensated) {
        add_fine<true>(window, p, direction, value, branches);
    } else {
        add_fine<false>(window, p, direction, value, branches);
    }
    if (window.fine_in_float.size == 0) return;
    V<D> x[n], y[n], z[n];
    for_each_of<n>([&](auto half) HWY_ATTR {
        x[half] = p[half].x;
        y[half] = p[half].y;
        z[half] = p[half].z;
    });
    const Vec3v<F> in_units{narrowed(x, 1 / unit), narrowed(y, 1 / unit), narrowed(z, 1 / unit)};
    V<F> in_float = hn::Zero(narrow), open = hn::Zero(narrow);
    for_groups(window.fine_in_float,
               [&]<Shape shape, KernelKind kind>(std::size_t first, std::uint32_t count) HWY_ATTR {
                   add_float_group<shape, kind>(narrow, window.fine_in_float.entry.data() + first,
                                                count, in_units, in_float, open);
               });
    alignas(64) float sums[HWY_MAX_BYTES / sizeof(float)];
    alignas(64) float opens[HWY_MAX_BYTES / sizeof(float)];
    hn::Store(in_float, narrow, sums);
    hn::Store(open, narrow, opens);
    for_each_of<n>([&](auto half) HWY_ATTR {
        const auto sum = hn::Load(hn::Rebind<float, D>(), sums + half * hn::Lanes(d));
        value[half].f = hn::Add(value[half].f, hn::PromoteTo(d, sum));
        if (!has_joined) return;
        const auto both = hn::Load(hn::Rebind<float, D>(), opens + half * hn::Lanes(d));
        branches[half].more = hn::Add(branches[half].more, hn::PromoteTo(d, both));
        branches[half].less = hn::Add(branches[half].less, hn::PromoteTo(d, both));
    });
}

struct Enclosing {
    const Window& window;
    double threshold, unit, half_width;
    double common_cell;  // see there
    double left_out;
    bool has_joined;
    double error;  // of the difference of two values, at most

    // What the lines of a step are asked for: the first guess is that near, others nearer by far, but for what
    // is open there.
    [[nodiscard]] double first_reach() const { return (window.end - window.begin) * 0x1p-6; }
    [[nodiscard]] double least_reach() const { return (window.end - window.begin) * 0x1p-14; }
};

// With g(t) = f without what was left out, and `above`, `below` bounds of that and of rounding:
// f(m + x) <= g(m) + above + (slope over |x| <= delta) x for both signs of x, the slopes being those
// of any part of a joined element. So f < 0 before the least zero of these lines, back to where g
// began to rise, and f > 0 after the greatest one.
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
    V<D> reach;   // and as far as which other branches are asked for
    V<D> cell, inverse_cell;

    // With f and its slope at m, and its branches as far as `reach`.
    HWY_INLINE void take(const Enclosing& task, const FieldValue<D>& value,
                         const Branches<D>& branches) {
        const D d;
        const Window& window = task.window;
        const auto c = [&](double x) HWY_ATTR { return hn::Set(d, x); };
        const StageBounds& bounds = window.fine_bounds;
        V<D> curvature = c(std::fmax(window.rise, window.fall) * (1 + 0x1p-40) + 1e-200);
        const V<D> zero = hn::Zero(d);
        V<D> f_hi = hn::Add(value.f, c(bounds.above));
        V<D> f_lo = hn::Sub(value.f, c(bounds.below));
        if (task.has_joined) {
            const V<D> widened = c(1 + 0x1p-40);
            f_hi = hn::MulAdd(branches.more, widened, f_hi);
            f_lo = hn::NegMulAdd(branches.less, widened, f_lo);
            curvature = hn::MulAdd(hn::Max(branches.rise, branches.fall), widened, curvature);
        }
        const V<D> size = hn::Add(hn::Max(hn::Abs(f_lo), hn::Abs(f_hi)), c(task.left_out));
        const V<D> inverse = hn::Div(c(1), value.slope);
        const V<D> delta = hn::Mul(hn::Mul(c(2.001), size), inverse);
        V<D> bend = hn::MulAdd(curvature, delta, c(bounds.slope));
        if (task.has_joined) {
            bend = hn::Add(
                bend, hn::IfThenElse(hn::Le(delta, reach), hn::Max(branches.above, branches.below),
                                     hn::Add(branches.anywhere, branches.beyond)));
        }
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
        if (task.has_joined) {  // delta there, if f is nearly 0
            const V<D> off = hn::Sub(size, hn::Abs(value.f));
            reach = hn::Max(c(task.least_reach()), hn::Mul(hn::Mul(c(2.25), off), inverse));
        }
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
            hn::Set(d, task.first_reach()),
            cell,
            hn::Div(hn::Set(d, 1), cell)};
}

// Returns the pairs of a lane and a step.
template <std::size_t n>
HWY_INLINE std::size_t enclose_lanes(const Enclosing& task, const RayLanes<D> (&ray)[n],
                                     Enclosed (&enclosed)[n]) {
    const D d;
    std::size_t steps = 0;
    Vec3v<D> direction[n];
    for_each_of<n>([&](auto half) HWY_ATTR { direction[half] = ray[half].direction; });
    for (int step = 0; step < 4; ++step) {
        std::size_t open = 0;
        for_each_of<n>([&](auto half) HWY_ATTR { open += hn::CountTrue(d, enclosed[half].open); });
        if (open == 0) break;
        steps += open;
        Vec3v<D> p[n];
        FieldValue<D> value[n];
        Branches<D> branches[n];
        if (task.has_joined) {
            for_each_of<n>([&](auto half) HWY_ATTR {
                const V<D> reach = enclosed[half].reach;
                branches[half].begin(reach, hn::Div(hn::Set(d, 1 - 0x1p-40), reach),
                                     hn::Set(d, task.error));
            });
        }
        for_each_of<n>([&](auto half)
                           HWY_ATTR { p[half] = place(task.window, ray[half], enclosed[half].m); });
        evaluate_fine(task.window, task.threshold, task.unit, task.has_joined, p, direction, value,
                      branches);
        if (task.window.along != nullptr) {
            for_each_of<n>([&](auto half) HWY_ATTR {
                const V<D> tau = hn::Sub(enclosed[half].m, hn::Set(d, task.window.middle));
                add_condensed(d, *task.window.along, tau, value[half].f, value[half].slope);
            });
        }
        for_each_of<n>([&](auto half)
                           HWY_ATTR { enclosed[half].take(task, value[half], branches[half]); });
    }
    return steps;
}

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
    RayLanes<D> ray[n];
    Enclosed enclosed[n];
    for_each_of<n>([&](auto half) HWY_ATTR {
        const std::size_t at = half * N;
        ray[half] = rays_of(task.window, batch.rays(at));
        enclosed[half] = not_enclosed(task, ray[half].direction, hn::Load(d, batch.t + at),
                                      hn::FirstN(d, batch.count - std::min(at, batch.count)));
    });
    const std::uint64_t steps = enclose_lanes(task, ray, enclosed);
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
    const double error = 2 * (window.fine_bounds.above + window.fine_bounds.below);
    const Enclosing task{
        window,
        threshold,
        unit,
        half_width,
        common_cell(half_width),
        left_out,
        joined_entries(window.fine).any() || joined_entries(window.fine_in_float).any(),
        error};
    const Outcome outcome{pinned, otherwise};
    Batch batch;
    std::uint64_t steps = 0;
    for (std::size_t k = first; k < end; k += step) {
        const M<F> candidates = lanes_in(narrow, Lanes::candidate, lanes, k, end);
        const std::size_t count = hn::CountTrue(narrow, candidates);
        if (count == 0) continue;
        if (stop.after(step * (window.fine.size + window.fine_in_float.size))) return steps;
        if (2 * count <= step) {
            std::uint64_t bits = bits_of(narrow, candidates);
            for (; bits != 0; bits &= bits - 1) {
                const std::size_t lane = k + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
                batch.add(lane, lanes);
                if (batch.count == step) steps += enclose_batch(task, outcome, batch, lanes);
            }
            continue;
        }
        RayLanes<D> ray[halves];
        Enclosed enclosed[halves];
        M<D> taken[halves];
        for_each_of<halves>([&](auto half) HWY_ATTR {
            const std::size_t at = k + half * N;
            ray[half] = rays_of(d, window, unit, lanes, at);
            taken[half] = lanes_in(d, Lanes::candidate, lanes, at, std::max(at, end));
            enclosed[half] =
                not_enclosed(task, ray[half].direction, hn::LoadU(d, &lanes.t[at]), taken[half]);
        });
        steps += enclose_lanes(task, ray, enclosed);
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
