#include "core/render/camera_lanes.h"

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

void directions_of_target(const View& view, int width, int height, std::size_t count,
                          const double* i, const double* j, double* dx, double* dy, double* dz) {
    const D d;
    const std::size_t N = hn::Lanes(d);
    const V half = hn::Set(d, 0.5), one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
    const V columns = hn::Set(d, static_cast<double>(width));
    const V rows = hn::Set(d, static_cast<double>(height));
    const V s = hn::Set(d, view.s);
    for (std::size_t k = 0; k < count; k += N) {
        const V u = hn::Div(
            hn::Mul(
                hn::Mul(hn::Sub(hn::Div(hn::Mul(two, hn::Add(hn::LoadU(d, i + k), half)), columns),
                                one),
                        s),
                columns),
            rows);
        const V v = hn::Mul(
            hn::Sub(one, hn::Div(hn::Mul(two, hn::Add(hn::LoadU(d, j + k), half)), rows)), s);
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

void primary_directions(const View& view, int width, int height, std::size_t count, const double* i,
                        const double* j, double* dx, double* dy, double* dz) {
    HWY_DYNAMIC_DISPATCH(directions_of_target)(view, width, height, count, i, j, dx, dy, dz);
}

}  // namespace ivory
#endif
