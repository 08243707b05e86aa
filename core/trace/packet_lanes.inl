// The rays of a packet as vectors: their states, their directions, and how they begin and end.
#if defined(IVORY_CORE_TRACE_PACKET_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_TRACE_PACKET_LANES_INL
#undef IVORY_CORE_TRACE_PACKET_LANES_INL
#else
#define IVORY_CORE_TRACE_PACKET_LANES_INL
#endif

#include <cstdint>

#include "core/shape/shape_lanes.inl"
#include "core/trace/packet_steps.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

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
        put(lanes.rays.x, lanes.fx.data());
        put(lanes.rays.y, lanes.fy.data());
        put(lanes.rays.z, lanes.fz.data());
        hn::StoreU(hn::IfThenElse(used, walking, unused), di, &lanes.state[k]);
    }
}

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

// p(t) = middle + (t - the window's middle) direction: (2) of core/field/bundle_field.h.
template <class Tag>
struct RayLanes {
    Vec3v<Tag> direction, middle;
};

// Of vectors of directions and, unless null, origins.
HWY_INLINE RayLanes<D> rays_of(const Window& window, const RayColumns& from) {
    const D d;
    const V<D> x = hn::LoadU(d, from.x), y = hn::LoadU(d, from.y), z = hn::LoadU(d, from.z),
               middle = hn::Set(d, window.middle);
    RayLanes<D> rays{{x, y, z},
                     {hn::Mul(middle, hn::Sub(x, hn::Set(d, window.axis.x))),
                      hn::Mul(middle, hn::Sub(y, hn::Set(d, window.axis.y))),
                      hn::Mul(middle, hn::Sub(z, hn::Set(d, window.axis.z)))}};
    if (from.ox == nullptr) return rays;
    const auto add = [&](V<D>& to, const double* origin, double common) HWY_ATTR {
        to = hn::Add(to, hn::Sub(hn::LoadU(d, origin), hn::Set(d, common)));
    };
    add(rays.middle.x, from.ox, window.origin.x);
    add(rays.middle.y, from.oy, window.origin.y);
    add(rays.middle.z, from.oz, window.origin.z);
    return rays;
}

HWY_INLINE RayLanes<D> rays_of(D, const Window& window, double, const Lanes& lanes,
                               std::size_t first) {
    return rays_of(window, lanes.rays.from(first));
}

HWY_INLINE RayLanes<F> rays_of(F d, const Window& window, double unit, const Lanes& lanes,
                               std::size_t first) {
    const V<F> middle = hn::Set(d, static_cast<float>(window.middle / unit));
    RayLanes<F> rays{{hn::LoadU(d, &lanes.fx[first]), hn::LoadU(d, &lanes.fy[first]),
                      hn::LoadU(d, &lanes.fz[first])},
                     {hn::Mul(middle, rounded_difference(lanes.rays.x + first, window.axis.x)),
                      hn::Mul(middle, rounded_difference(lanes.rays.y + first, window.axis.y)),
                      hn::Mul(middle, rounded_difference(lanes.rays.z + first, window.axis.z))}};
    if (lanes.rays.ox != nullptr) {
        const V<F> per_unit = hn::Set(d, static_cast<float>(1 / unit));  // a power of two
        const auto add = [&](V<F>& to, const double* origin, double from) HWY_ATTR {
            to = hn::MulAdd(rounded_difference(origin + first, from), per_unit, to);
        };
        add(rays.middle.x, lanes.rays.ox, window.origin.x);
        add(rays.middle.y, lanes.rays.oy, window.origin.y);
        add(rays.middle.z, lanes.rays.oz, window.origin.z);
    }
    return rays;
}

constexpr std::size_t widest = 8;  // doubles in a vector of any target

// Lanes that stand alone are gathered from here and there.
struct Batch {
    static constexpr std::size_t room = HWY_MAX_BYTES / sizeof(float);
    alignas(64) double dx[room] = {}, dy[room] = {}, dz[room] = {}, t[room] = {};
    alignas(64) double ox[room] = {}, oy[room] = {}, oz[room] = {};
    bool has_origins = false;
    std::uint32_t lane[room];
    std::size_t count = 0;

    [[nodiscard]] RayColumns rays(std::size_t at) const {
        if (!has_origins) return {dx + at, dy + at, dz + at};
        return {dx + at, dy + at, dz + at, ox + at, oy + at, oz + at};
    }
    void add(std::size_t from, const Lanes& lanes) {
        lane[count] = static_cast<std::uint32_t>(from);
        dx[count] = lanes.rays.x[from];
        dy[count] = lanes.rays.y[from];
        dz[count] = lanes.rays.z[from];
        has_origins = lanes.rays.ox != nullptr;
        if (has_origins) {
            ox[count] = lanes.rays.ox[from];
            oy[count] = lanes.rays.oy[from];
            oz[count] = lanes.rays.oz[from];
        }
        t[count++] = lanes.t[from];
    }
};

HWY_INLINE Vec3v<D> place(const Window& window, const RayLanes<D>& ray, V<D> t) {
    const V<D> tau = hn::Sub(t, hn::Set(D(), window.middle));
    return {hn::MulAdd(tau, ray.direction.x, ray.middle.x),
            hn::MulAdd(tau, ray.direction.y, ray.middle.y),
            hn::MulAdd(tau, ray.direction.z, ray.middle.z)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
