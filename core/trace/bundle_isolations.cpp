#include "core/trace/bundle_isolations.h"

#include <algorithm>

#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/bundle_isolations.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

}  // namespace

BundleTally tally_of_target(const BundleIsolations& isolations, std::size_t count) {
    const hn::ScalableTag<std::uint8_t> bytes;
    const auto* const status = reinterpret_cast<const std::uint8_t*>(isolations.status.data());
    BundleTally tally;
    for (std::size_t first = 0; first < count; first += hn::Lanes(bytes)) {
        // Below AVX-512, x86 takes a count of 8-bit lanes as a signed byte: no more than there are.
        const auto in = hn::FirstN(bytes, std::min(count - first, hn::Lanes(bytes)));
        const auto values = hn::LoadU(bytes, status + first);
        for (std::size_t kind = 0; kind < tally.rays.size(); ++kind) {
            const auto same = hn::Eq(values, hn::Set(bytes, static_cast<std::uint8_t>(kind)));
            tally.rays[kind] += static_cast<std::uint32_t>(hn::CountTrue(bytes, hn::And(in, same)));
        }
    }
    if (tally[Status::hit] == count) {
        const D d;
        V widest = hn::Zero(d);
        for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
            const V width =
                hn::Sub(hn::LoadU(d, &isolations.t_hi[k]), hn::LoadU(d, &isolations.t_lo[k]));
            widest = hn::Max(widest, hn::IfThenElseZero(hn::FirstN(d, count - k), width));
        }
        tally.widest = hn::GetLane(hn::MaxOfLanes(d, widest));
    } else {
        for (std::size_t k = 0; k < count; ++k) {
            if (!possibly_hit(isolations.status[k])) continue;
            double& widest =
                isolations.status[k] == Status::unresolved ? tally.widest_unresolved : tally.widest;
            widest = std::max(widest, isolations.t_hi[k] - isolations.t_lo[k]);
        }
    }
    return tally;
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(tally_of_target);

BundleTally tally_of(const BundleIsolations& isolations, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(tally_of_target)(isolations, count);
}

}  // namespace ivory
#endif
