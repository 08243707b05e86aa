#include "core/render/shade_lanes.h"

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

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

// The material and the room. Shares of the light that falls in.
constexpr double diffuse = 0.78;
constexpr double highlight = 0.24;  // at the middle of a lamp's reflection
constexpr double sky = 0.12;        // light from all around, from the zenith
constexpr double ground = 0.03;     // and from below
constexpr double rim = 0.06;        // what grazing sight mirrors of the surroundings

struct Vec3v {
    V x, y, z;
};

HWY_INLINE V dot(const Vec3v& a, const Vec3v& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vec3v set(const Vec3d& v) {
    const D d;
    return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
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
    constexpr double knee = 0.80;
    const V one = hn::Set(d, 1.0);
    const V beyond = hn::Div(hn::Sub(x, hn::Set(d, knee)), hn::Set(d, 1 - knee));
    const V bent = hn::Add(hn::Set(d, knee),
                           hn::Mul(hn::Set(d, 1 - knee), hn::Div(beyond, hn::Add(one, beyond))));
    return hn::IfThenElse(hn::Le(x, hn::Set(d, knee)), x, bent);
}

void shade(const Lighting& lighting, ShadingLanes& lanes) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), half = hn::Set(d, 0.5);
    for (std::size_t k = 0; k < lanes.count; k += N) {
        const Vec3v to_viewer{hn::Neg(hn::Load(d, &lanes.dx[k])),
                              hn::Neg(hn::Load(d, &lanes.dy[k])),
                              hn::Neg(hn::Load(d, &lanes.dz[k]))};
        Vec3v normal{hn::Load(d, &lanes.nx[k]), hn::Load(d, &lanes.ny[k]),
                     hn::Load(d, &lanes.nz[k])};
        const Vec3v color{hn::Load(d, &lanes.r[k]), hn::Load(d, &lanes.g[k]),
                          hn::Load(d, &lanes.b[k])};
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
                                    hn::Min(one, hn::Mul(hn::Set(d, 4.0), lit)));
            const V share = hn::Mul(hn::Set(d, diffuse), lit);
            const auto add = [&](V sum, V of_color, double radiance) HWY_ATTR {
                const V lamp_light = hn::Set(d, radiance);
                const V more = hn::Add(hn::Mul(share, hn::Mul(of_color, lamp_light)),
                                       hn::Mul(gloss, lamp_light));
                return hn::Add(sum, hn::IfThenElseZero(is_lit, more));
            };
            light = {add(light.x, color.x, lamp.radiance.x), add(light.y, color.y, lamp.radiance.y),
                     add(light.z, color.z, lamp.radiance.z)};
        }
        hn::Store(shoulder(light.x), d, &lanes.r[k]);
        hn::Store(shoulder(light.y), d, &lanes.g[k]);
        hn::Store(shoulder(light.z), d, &lanes.b[k]);
    }
}

}  // namespace

void shade_of_target(const Lighting& lighting, ShadingLanes& lanes) { shade(lighting, lanes); }

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(shade_of_target);

void shade_lanes(const Lighting& lighting, ShadingLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(shade_of_target)(lighting, lanes);
}

}  // namespace ivory
#endif
