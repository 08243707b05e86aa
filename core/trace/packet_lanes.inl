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
        put(lanes.dx, lanes.fx.data());
        put(lanes.dy, lanes.fy.data());
        put(lanes.dz, lanes.fz.data());
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
