#include "core/render/camera_lanes.h"

#include <algorithm>
#include <cmath>

#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/render/camera_lanes.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

void directions_of_target(const View& view, std::size_t count, const double* us, const double* vs,
                          double* dx, double* dy, double* dz) {
    const D d;
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
        const V u = hn::LoadU(d, us + k), v = hn::LoadU(d, vs + k);
        const auto component = [&](double forward, double right, double top) HWY_ATTR {
            return hn::Add(hn::Add(hn::Set(d, forward), hn::Mul(u, hn::Set(d, right))),
                           hn::Mul(v, hn::Set(d, top)));
        };
        const V x = component(view.forward.x, view.right.x, view.top.x);
        const V y = component(view.forward.y, view.right.y, view.top.y);
        const V z = component(view.forward.z, view.right.z, view.top.z);
        const V norm = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
        hn::StoreU(hn::Div(x, norm), d, dx + k);
        hn::StoreU(hn::Div(y, norm), d, dy + k);
        hn::StoreU(hn::Div(z, norm), d, dz + k);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(directions_of_target);

void primary_directions(const View& view, std::size_t count, const double* u, const double* v,
                        double* dx, double* dy, double* dz) {
    HWY_DYNAMIC_DISPATCH(directions_of_target)(view, count, u, v, dx, dy, dz);
}

namespace {

// The directions within an angle below 90 degrees of an axis form a convex cone: if those of the
// four corners lie in it, all between them do, and |d - axis| grows with the angle. What rounding
// does to a direction is below 32 2^-53 (cone_around in camera.cpp), and to the chord below 2^-50.
Bundle bundle_of(const Vec3d& origin, const std::array<Vec3d, 4>& corners) {
    const Vec3d sum = (corners[0] + corners[1]) + (corners[2] + corners[3]);
    const double norm = std::sqrt(dot(sum, sum));
    Bundle bundle{origin, {sum.x / norm, sum.y / norm, sum.z / norm}, 0};
    for (const Vec3d& corner : corners) {
        const Vec3d off = corner - bundle.axis;
        bundle.spread = std::max(bundle.spread, std::sqrt(dot(off, off)) + 0x1p-45);
    }
    return bundle;
}

}  // namespace

TileBundles tile_bundles(const View& view, int width, int height, int i, int j) {
    // The corners of 4 x 4 squares stand at 0, 3, 4, 7, .. 15.
    constexpr std::size_t edges = 8;
    std::array<double, edges> of_column, of_row;
    for (std::size_t n = 0; n < edges; ++n) {
        const int edge = static_cast<int>(4 * (n / 2) + 3 * (n % 2));
        of_column[n] = plane_u(view, width, height, i + edge);
        of_row[n] = plane_v(view, height, j + edge);
    }
    alignas(64) std::array<double, edges * edges> u, v, dx, dy, dz;
    for (std::size_t k = 0; k < edges * edges; ++k) {
        u[k] = of_column[k % edges];
        v[k] = of_row[k / edges];
    }
    primary_directions(view, u.size(), u.data(), v.data(), dx.data(), dy.data(), dz.data());
    // Of `side` edges from column x and row y on.
    const auto bundle = [&](std::size_t x, std::size_t y, std::size_t side) {
        const auto direction = [&](std::size_t at) { return Vec3d{dx[at], dy[at], dz[at]}; };
        const std::size_t first = y * edges + x, last = first + (side - 1) * edges;
        return bundle_of(view.camera.position, {direction(first), direction(first + side - 1),
                                                direction(last), direction(last + side - 1)});
    };
    TileBundles bundles;
    bundles[0] = bundle(0, 0, 8);
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
        const std::size_t x = quarter % 2 * 4, y = quarter / 2 * 4;
        bundles[1 + quarter] = bundle(x, y, 4);
        for (std::size_t square = 0; square < 4; ++square) {
            bundles[5 + quarter * 4 + square] = bundle(x + square % 2 * 2, y + square / 2 * 2, 2);
        }
    }
    // As cone_around has it: the claims about rounding are for frames that are not skewed.
    if (!(std::abs(dot(view.forward, view.right)) <= 0.5)) {
        for (Bundle& skewed : bundles) skewed.spread = 1;
    }
    return bundles;
}

}  // namespace ivory
#endif
