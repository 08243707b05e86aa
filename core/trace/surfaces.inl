// Normals and colours of a packet's hits: in float where that is good enough, else in double.
#if defined(IVORY_CORE_TRACE_SURFACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_SURFACES_INL
#undef IVORY_CORE_TRACE_SURFACES_INL
#else
#define IVORY_CORE_TRACE_SURFACES_INL
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/field/condensed.inl"
#include "core/trace/field_lanes.inl"
#include "core/trace/packet_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

struct SurfaceSum {
    Vec3v<D> gradient, color;
    V<D> weight;
};

// Of the nearest part of a joined element: s times the kernel's argument_scale, and the gradient of s
// halved. Not defined where another part is as near, to `gap` of s + 1, and lies in another direction,
// to `turn` of the length squared.
template <class Tag>
struct NearestPart {
    V<Tag> s;
    Vec3v<Tag> half_gradient;
    M<Tag> defined;
};

// The first one is entry[k]; then `k` is the last.
template <Shape shape, class Tag>
HWY_INLINE NearestPart<Tag> nearest_part(Tag d, const BundleEntry<hn::TFromD<Tag>>* entry,
                                         std::uint32_t& k, double per_scale, const Vec3v<Tag>& p,
                                         double gap, double turn) {
    using Real = hn::TFromD<Tag>;
    const V<Tag> near = hn::Set(d, static_cast<Real>(gap)),
                 apart = hn::Set(d, static_cast<Real>(turn));
    V<Tag> unproved =
        hn::Set(d, boundless<Real>);  // the least s of what may be nearer than was found
    const auto at = [&](const BundleEntry<Real>& e) HWY_ATTR {
        V<Tag> square;
        Vec3v<Tag> away;
        bool is_proved = false;
        if constexpr (proves_feet<shape>) {
            is_proved = e.proof() != 0;
            if (is_proved) {
                const ProvedFoot<Tag> foot = LanesOfShape<shape>::proved_foot(d, e, p, hn::Zero(d));
                away = foot.away;
                square = foot.square;
                // The foot is no farther than `pull` from there.
                const M<Tag> is_close =
                    hn::Le(hn::Mul(foot.pull, foot.pull), hn::Mul(apart, square));
                const V<Tag> least =
                    hn::Mul(hn::Sub(square, foot.slack), hn::Set(d, e.inverse_square));
                unproved = hn::IfThenElse(is_close, unproved, hn::Min(unproved, least));
            }
        }
        if (!is_proved) away = away_from<shape>(d, e, p, square);
        const V<Tag> factor = hn::Set(d, static_cast<Real>(e.inverse_square * per_scale));
        return NearestPart<Tag>{
            hn::Mul(square, hn::Set(d, e.inverse_square)),
            {hn::Mul(factor, away.x), hn::Mul(factor, away.y), hn::Mul(factor, away.z)},
            hn::FirstN(d, hn::Lanes(d))};
    };
    NearestPart<Tag> best = at(entry[k]);
    while (entry[k].joins != 0) {
        const NearestPart<Tag> part = at(entry[++k]);
        const Vec3v<Tag>&a = best.half_gradient, &b = part.half_gradient;
        const Vec3v<Tag> between{hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
        const M<Tag> nearer = hn::Lt(part.s, best.s);
        const M<Tag> as_near =
            hn::Le(hn::Abs(hn::Sub(part.s, best.s)), hn::MulAdd(near, best.s, near));
        const M<Tag> turns = hn::Gt(dot<Tag>(between, between), hn::Mul(apart, dot<Tag>(a, a)));
        best = {hn::IfThenElse(nearer, part.s, best.s),
                {hn::IfThenElse(nearer, b.x, a.x), hn::IfThenElse(nearer, b.y, a.y),
                 hn::IfThenElse(nearer, b.z, a.z)},
                hn::AndNot(hn::And(as_near, turns), hn::Or(nearer, best.defined))};
    }
    if constexpr (proves_feet<shape>) {
        best.defined = hn::And(best.defined,
                               hn::Gt(unproved, hn::Add(hn::MulAdd(near, best.s, near), best.s)));
    }
    return best;
}

template <Shape shape, KernelKind kind>
HWY_INLINE void add_surface(D d, const BundleEntry<double>* entry, const std::uint32_t* element,
                            std::uint32_t count, const Field& field, const Vec3v<D>& p,
                            SurfaceSum& sum, M<D>& defined) {
    for (std::uint32_t k = 0; k < count; ++k) {
        Vec3v<D> away;
        V<D> slope;
        KernelValue<D> value;
        if constexpr (SkeletonOf<shape>::is_joined) {
            const NearestPart<D> part = nearest_part<shape>(
                d, entry, k, 1 / LanesOf<kind>::argument_scale, p, 0x1p-30, 0x1p-50);
            away = part.half_gradient;
            value = LanesOf<kind>::at(d, part.s);
            slope =
                hn::Mul(hn::Set(d, 2 * LanesOf<kind>::slope_sign * entry[k].strength), value.dk);
            defined = hn::And(defined, hn::Or(part.defined, hn::Eq(value.dk, hn::Zero(d))));
        } else {
            V<D> square;
            away = away_from<shape>(d, entry[k], p, square);
            value = LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry[k].inverse_square)));
            const double inverse_square =
                entry[k].inverse_square * (1 / LanesOf<kind>::argument_scale);
            slope = hn::Mul(
                hn::Set(d, 2 * LanesOf<kind>::slope_sign * entry[k].strength * inverse_square),
                value.dk);
            if constexpr (SkeletonOf<shape>::has_kinks) {
                defined = hn::And(
                    defined, hn::Or(LanesOfShape<shape>::is_defined(d, entry[k], inverse_square, p),
                                    hn::Eq(value.dk, hn::Zero(d))));
            }
        }
        sum.gradient = {hn::MulAdd(slope, away.x, sum.gradient.x),
                        hn::MulAdd(slope, away.y, sum.gradient.y),
                        hn::MulAdd(slope, away.z, sum.gradient.z)};
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
             std::span<const std::uint32_t> index, SurfacePoint* surface, Cancellation& stop) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    for (std::size_t first = 0; first < index.size(); first += N) {
        if (stop.after(N * window.fine.size)) return;
        Batch batch;
        alignas(64) double at[widest];
        for (std::size_t k = 0; k < N; ++k) {
            const std::uint32_t lane = index[std::min(first + k, index.size() - 1)];
            batch.add(lane, lanes);
            at[k] = lanes.t[lane];
        }
        const V<D> m = hn::Load(d, at);
        const Vec3v<D> p = place(window, rays_of(window, batch.rays(0)), m);
        const V<D> zero = hn::Zero(d);
        SurfaceSum sum{{zero, zero, zero}, {zero, zero, zero}, zero};
        M<D> defined = hn::FirstN(d, N);
        for_groups(window.fine, [&]<Shape shape, KernelKind kind>(std::size_t group,
                                                                  std::uint32_t count) HWY_ATTR {
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
struct FloatSurfaceSum {
    Vec3v<F> gradient, color;
    V<F> weight;
};

template <Shape shape, KernelKind kind>
HWY_INLINE void add_float_surface(F d, const BundleEntry<float>* entry,
                                  const std::uint32_t* element, std::uint32_t count,
                                  const Field& field, const Vec3v<F>& p, FloatSurfaceSum& sum,
                                  M<F>& defined) {
    constexpr auto to_slope =
        static_cast<float>(2 * LanesOf<kind>::slope_sign / LanesOf<kind>::argument_scale);
    for (std::uint32_t k = 0; k < count; ++k) {
        Vec3v<F> away;
        V<F> slope;
        KernelValue<F> value;
        if constexpr (SkeletonOf<shape>::is_joined) {
            // 2 q eta + eta^2 of both is less than the gap, and the turn is what a look may be off by.
            const NearestPart<F> part = nearest_part<shape>(d, entry, k, 1, p, 0x1p-8, 0x1p-20);
            away = part.half_gradient;
            value = LanesOf<kind>::at(d, part.s);
            slope = hn::Mul(hn::Set(d, to_slope * entry[k].strength), value.dk);
            defined = hn::And(defined, part.defined);
        } else {
            V<F> square;
            away = away_from<shape>(d, entry[k], p, square);
            value = LanesOf<kind>::at(d, hn::Mul(square, hn::Set(d, entry[k].inverse_square)));
            slope = hn::Mul(hn::Set(d, to_slope * entry[k].strength * entry[k].inverse_square),
                            value.dk);
        }
        const BundleEntry<float>& e = entry[k];
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
SeenSurfaces look(const Window& window, const Field& field, double unit, double limit,
                  const Lanes& lanes, std::size_t first_lane, std::size_t end_lane,
                  BundleSurfaces& surfaces, Cancellation& stop) {
    const F d;
    const D wide;
    const std::size_t N = hn::Lanes(d);
    const V<F> zero = hn::Zero(d);
    // A vector that is off by that share of its length turns by no more than 2^-8, its own roundings and all;
    // the other leaves as much again.
    constexpr double firm_share = 0x1p9, firm_condensed_share = 0x1.04p8;
    const StageBounds& bounds = window.coarse_bounds;
    const V<D> begin = hn::Set(wide, window.begin), middle = hn::Set(wide, window.middle),
               end = hn::Set(wide, std::fmin(window.end, limit)),
               per_unit = hn::Set(wide, 1 / unit),
               nowhere = hn::Set(wide, std::numeric_limits<double>::quiet_NaN());
    SeenSurfaces looked;
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
        FloatSurfaceSum sum{{zero, zero, zero}, {zero, zero, zero}, zero};
        M<F> defined = wanted;
        for (const StageEntries<float>* stage : {&window.strong, &window.weak}) {
            for_groups(*stage, [&]<Shape shape, KernelKind kind>(std::size_t group,
                                                                 std::uint32_t count) HWY_ATTR {
                add_float_surface<shape, kind>(d, stage->entry.data() + group,
                                               stage->element.data() + group, count, field, p, sum,
                                               defined);
            });
        }
        double least_length = firm_share * bounds.slope;
        if (window.condensed != nullptr) {
            sum.gradient = gradient_of(d, *window.condensed, p);
            least_length = firm_condensed_share * window.gradient_error;
        }
        const V<F> length = hn::Sqrt(dot<F>(sum.gradient, sum.gradient));
        M<F> firm = hn::And(defined, hn::Gt(length, hn::Set(d, static_cast<float>(least_length))));
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
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
