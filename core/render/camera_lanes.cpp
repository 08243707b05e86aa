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
    if (view.is_orthographic()) {
        std::fill_n(dx, count, view.forward.x);
        std::fill_n(dy, count, view.forward.y);
        std::fill_n(dz, count, view.forward.z);
        return;
    }
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

TileBundles tile_bundles(const View& view, int width, int height, int i, int j, int samples) {
    // The corners of 4 x 4 squares stand at 0, 3, 4, 7, .. 15; of more samples likewise.
    constexpr std::size_t edges = 8;
    std::array<double, edges> of_column, of_row;
    for (std::size_t n = 0; n < edges; ++n) {
        const int side = 4 * samples;
        const int edge = side * static_cast<int>(n / 2) + (side - 1) * static_cast<int>(n % 2);
        of_column[n] = plane_u(view, width, height, i + edge);
        of_row[n] = plane_v(view, height, j + edge);
    }
    TileBundles bundles;
    // Visits the number of each of them, its first column and row and how many edges it has.
    const auto for_bundles = [&](const auto& visit) {
        visit(0, 0, 0, edges);
        for (std::size_t quarter = 0; quarter < 4; ++quarter) {
            const std::size_t x = quarter % 2 * 4, y = quarter / 2 * 4;
            visit(1 + quarter, x, y, 4);
            for (std::size_t square = 0; square < 4; ++square) {
                visit(5 + quarter * 4 + square, x + square % 2 * 2, y + square / 2 * 2, 2);
            }
        }
    };
    if (view.is_orthographic()) {
        for_bundles([&](std::size_t number, std::size_t x, std::size_t y, std::size_t side) {
            bundles[number] = orthographic_bundle(view, of_column[x], of_column[x + side - 1],
                                                  of_row[y], of_row[y + side - 1]);
        });
        return bundles;
    }
    alignas(64) std::array<double, edges * edges> u, v, dx, dy, dz;
    for (std::size_t k = 0; k < edges * edges; ++k) {
        u[k] = of_column[k % edges];
        v[k] = of_row[k / edges];
    }
    primary_directions(view, u.size(), u.data(), v.data(), dx.data(), dy.data(), dz.data());
    for_bundles([&](std::size_t number, std::size_t x, std::size_t y, std::size_t side) {
        const auto direction = [&](std::size_t at) { return Vec3d{dx[at], dy[at], dz[at]}; };
        const std::size_t first = y * edges + x, last = first + (side - 1) * edges;
        bundles[number] = bundle_of(view.origin, {direction(first), direction(first + side - 1),
                                                  direction(last), direction(last + side - 1)});
    });
    // As cone_around has it: the claims about rounding are for frames that are not skewed.
    if (!(std::abs(dot(view.forward, view.right)) <= 0.5)) {
        for (Bundle& skewed : bundles) skewed.spread = 1;
    }
    return bundles;
}

}  // namespace ivory
#endif
