#include "core/render/shade_lanes.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/shade_lanes.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using I = hn::RebindToSigned<D>;
using V = hn::Vec<D>;

// The material and the room. Shares of the light that falls in.
constexpr float diffuse = 0.78F;
constexpr float highlight = 0.24F;  // at the middle of a lamp's reflection
constexpr float sky = 0.12F;        // light from all around, from the zenith
constexpr float ground = 0.03F;     // and from below
constexpr float rim = 0.06F;        // what grazing sight mirrors of the surroundings

struct Vec3v {
    V x, y, z;
};

HWY_INLINE V dot(const Vec3v& a, const Vec3v& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vec3v set(const Vec3d& v) {
    const D d;
    return {hn::Set(d, static_cast<float>(v.x)), hn::Set(d, static_cast<float>(v.y)),
            hn::Set(d, static_cast<float>(v.z))};
}

// x^48: half as bright where the normal is 10 degrees away from the highlight's middle.
HWY_INLINE V lobe(V x) {
    const V x2 = hn::Mul(x, x);
    const V x4 = hn::Mul(x2, x2);
    const V x8 = hn::Mul(x4, x4);
    const V x16 = hn::Mul(x8, x8);
    return hn::Mul(hn::Mul(x16, x16), x16);
}

// Where light adds up beyond `knee` it bends smoothly towards 1 instead of being cut off there.
HWY_INLINE V shoulder(V x) {
    const D d;
    constexpr float knee = 0.80F;
    const auto is_straight = hn::Le(x, hn::Set(d, knee));
    if (hn::AllTrue(d, is_straight)) return x;
    const V one = hn::Set(d, 1.0F);
    const V beyond = hn::Div(hn::Sub(x, hn::Set(d, knee)), hn::Set(d, 1 - knee));
    const V bent = hn::Add(hn::Set(d, knee),
                           hn::Mul(hn::Set(d, 1 - knee), hn::Div(beyond, hn::Add(one, beyond))));
    return hn::IfThenElse(is_straight, x, bent);
}

// A vector of doubles, which stand at a multiple of its length in an array of 256.
HWY_INLINE V rounded(const double* values) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(D(), static_cast<float>(*values));
#else
    const hn::ScalableTag<double> wide;
    const hn::Half<D> half;
    return hn::Combine(D(), hn::DemoteTo(half, hn::LoadU(wide, values + hn::Lanes(wide))),
                       hn::DemoteTo(half, hn::LoadU(wide, values)));
#endif
}

// Bytes of linear light, clamped to 0..1.
HWY_INLINE hn::Vec<I> byte_of(V linear, const SrgbTable& table) {
    const D d;
    const I di;
    const auto set = [&](std::uint32_t bits)
                         HWY_ATTR { return hn::Set(di, static_cast<std::int32_t>(bits)); };
    const V x = hn::Min(hn::Max(linear, hn::Set(d, SrgbTable::darkest)), hn::Set(d, 1.0F));
    const auto bits = hn::Sub(hn::BitCast(di, x), set(SrgbTable::first_bits));
    // Entries are below 2^32: their byte is shifted down as one without a sign.
    const auto at = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(table.entry.data()),
                                    hn::ShiftRight<16>(bits));
    const auto byte = hn::And(hn::ShiftRight<24>(at), set(0xff));
    const auto comes_next = hn::Lt(hn::And(bits, set(0xffff)), hn::And(at, set(0xffffff)));
    return hn::Add(byte, hn::IfThenZeroElse(comes_next, set(1)));
}

// Calls put(k, count, light, none_there) for vectors of pixels, or background(k, count) where none of
// them has a surface.
template <class Put, class Background>
HWY_INLINE void shade(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                      std::size_t size, const Put& put, const Background& background) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0F), half = hn::Set(d, 0.5F);
    for (std::size_t k = 0; k < size; k += N) {
        const std::size_t count = std::min(N, size - k);
        Vec3v normal{hn::LoadU(d, &looks.nx[k]), hn::LoadU(d, &looks.ny[k]),
                     hn::LoadU(d, &looks.nz[k])};
        const auto none_there = hn::IsNaN(normal.x);
        if (hn::CountTrue(d, hn::And(none_there, hn::FirstN(d, count))) == count) {
            background(k, count);
            continue;
        }
        const Vec3v to_viewer{hn::Neg(rounded(&rays.dx[k])), hn::Neg(rounded(&rays.dy[k])),
                              hn::Neg(rounded(&rays.dz[k]))};
        const Vec3v color{hn::LoadU(d, &looks.r[k]), hn::LoadU(d, &looks.g[k]),
                          hn::LoadU(d, &looks.b[k])};
        const auto none = hn::And(hn::And(hn::Eq(normal.x, zero), hn::Eq(normal.y, zero)),
                                  hn::Eq(normal.z, zero));
        normal = {hn::IfThenElse(none, to_viewer.x, normal.x),
                  hn::IfThenElse(none, to_viewer.y, normal.y),
                  hn::IfThenElse(none, to_viewer.z, normal.z)};
        V facing = dot(normal, to_viewer);
        const auto turned = hn::Lt(facing, zero);
        normal = {hn::IfThenElse(turned, hn::Neg(normal.x), normal.x),
                  hn::IfThenElse(turned, hn::Neg(normal.y), normal.y),
                  hn::IfThenElse(turned, hn::Neg(normal.z), normal.z)};
        facing = hn::Abs(facing);

        // From all around: brighter from above; at grazing sight the surface mirrors (Schlick
        // 1994).
        const V upward = hn::Add(half, hn::Mul(half, dot(normal, set(lighting.zenith))));
        const V around = hn::Add(hn::Set(d, ground), hn::Mul(hn::Set(d, sky - ground), upward));
        const V graze = hn::Sub(one, hn::Min(facing, one));
        const V graze2 = hn::Mul(graze, graze);
        const V mirrored = hn::Mul(hn::Mul(hn::Set(d, rim), upward), hn::Mul(graze2, graze2));
        Vec3v light{hn::Add(hn::Mul(around, color.x), mirrored),
                    hn::Add(hn::Mul(around, color.y), mirrored),
                    hn::Add(hn::Mul(around, color.z), mirrored)};

        for (const Lighting::Lamp& lamp : lighting.lamps) {
            const Vec3v direction = set(lamp.direction);
            const V lit = dot(normal, direction);
            const auto is_lit = hn::Gt(lit, zero);
            if (hn::AllFalse(d, is_lit)) continue;
            // Halfway between viewer and lamp; opposite to each other they have no halfway, and
            // then the surface cannot face both.
            const Vec3v halfway{hn::Add(direction.x, to_viewer.x),
                                hn::Add(direction.y, to_viewer.y),
                                hn::Add(direction.z, to_viewer.z)};
            const V across = hn::Div(dot(normal, halfway), hn::Sqrt(dot(halfway, halfway)));
            // Fades in with the light itself, so that no highlight is cut at the edge of the
            // shadow.
            const V gloss = hn::Mul(hn::Mul(hn::Set(d, highlight), lobe(hn::Min(across, one))),
                                    hn::Min(one, hn::Mul(hn::Set(d, 4.0F), lit)));
            const V share = hn::Mul(hn::Set(d, diffuse), lit);
            const auto add = [&](V sum, V of_color, double radiance) HWY_ATTR {
                const V lamp_light = hn::Set(d, static_cast<float>(radiance));
                const V more = hn::Add(hn::Mul(share, hn::Mul(of_color, lamp_light)),
                                       hn::Mul(gloss, lamp_light));
                return hn::Add(sum, hn::IfThenElseZero(is_lit, more));
            };
            light = {add(light.x, color.x, lamp.radiance.x), add(light.y, color.y, lamp.radiance.y),
                     add(light.z, color.z, lamp.radiance.z)};
        }
        put(k, count, Vec3v{shoulder(light.x), shoulder(light.y), shoulder(light.z)}, none_there);
    }
}

}  // namespace

void shade_of_target(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                     std::span<Rgba8> colors) {
    const I di;
    const SrgbTable& table = srgb_table();
    shade(
        lighting, rays, looks, colors.size(),
        [&](std::size_t k, std::size_t count, const Vec3v& light, hn::Mask<D> none_there) HWY_ATTR {
            const auto red = byte_of(light.x, table);
            const auto green = hn::ShiftLeft<8>(byte_of(light.y, table));
            const auto blue = hn::ShiftLeft<16>(byte_of(light.z, table));
            const auto opaque = hn::Set(di, std::int32_t{-0x1000000});
            const auto background = hn::Set(
                di, static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(lighting.background)));
            const auto bytes = hn::IfThenElse(hn::RebindMask(di, none_there), background,
                                              hn::Or(hn::Or(red, green), hn::Or(blue, opaque)));
            alignas(64) std::int32_t out[HWY_MAX_BYTES / sizeof(float)];
            hn::Store(bytes, di, out);
            std::memcpy(&colors[k], out, count * sizeof(Rgba8));
        },
        [&](std::size_t k, std::size_t count) {
            std::fill_n(&colors[k], count, lighting.background);
        });
}

void light_of_target(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                     std::size_t size, LightColumns& light) {
    const D d;
    const auto column = [&](std::array<float, LightColumns::room>& values, std::size_t k, V channel,
                            double of_background, hn::Mask<D> none_there) HWY_ATTR {
        const V clamped = hn::Min(hn::Max(channel, hn::Zero(d)), hn::Set(d, 1.0F));
        hn::StoreU(
            hn::IfThenElse(none_there, hn::Set(d, static_cast<float>(of_background)), clamped), d,
            &values[k]);
    };
    const Color& background = lighting.background_light;
    shade(
        lighting, rays, looks, size,
        [&](std::size_t k, std::size_t, const Vec3v& lit, hn::Mask<D> none_there) HWY_ATTR {
            column(light.r, k, lit.x, background.x, none_there);
            column(light.g, k, lit.y, background.y, none_there);
            column(light.b, k, lit.z, background.z, none_there);
        },
        [&](std::size_t k, std::size_t count) {
            std::fill_n(&light.r[k], count, static_cast<float>(background.x));
            std::fill_n(&light.g[k], count, static_cast<float>(background.y));
            std::fill_n(&light.b[k], count, static_cast<float>(background.z));
        });
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(shade_of_target);
HWY_EXPORT(light_of_target);

void shade_lanes(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                 std::span<Rgba8> colors) {
    static_assert(std::endian::native == std::endian::little && sizeof(Rgba8) == 4);
    HWY_DYNAMIC_DISPATCH(shade_of_target)(lighting, rays, looks, colors);
}

void light_lanes(const Lighting& lighting, const RayBundle& rays, const Looks& looks,
                 std::size_t size, LightColumns& light) {
    HWY_DYNAMIC_DISPATCH(light_of_target)(lighting, rays, looks, size, light);
}

}  // namespace ivory
#endif
