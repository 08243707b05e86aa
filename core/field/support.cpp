#include "core/field/support.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/field/bundle_steps.h"
#include "core/math/direction.h"

namespace ivory {

ElementList all_elements(const Field& field) {
    ElementList list;
    list.elements.resize(field.size());
    std::iota(list.elements.begin(), list.elements.end(), 0u);
    list.certainly_empty = field.box.empty();
    return list;
}

// Two unit vectors an angle a <= 30 degrees apart have ends 2 sin(a / 2) apart, at most 1.036 sin
// a. The axis' own rounding to length 1 is far below the rest of the margin.
double spread_of(const Cone& cone) { return cone.sine <= 0.45 ? 1.04 * cone.sine + 0x1p-48 : 1; }

// What the rays are parametrized by does not matter to distances; beyond its far end an element
// only gets farther away.
ElementList reaching_elements(const Field& field, const ElementList& parent, const Cone& cone,
                              const Interval<double>& part) {
    const Vec3d& o = cone.apex;
    const bool bounded = field.compact && spread_of(cone) <= 0.5 &&
                         std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < 1e30;
    if (parent.certainly_empty || parent.elements.empty() || !bounded) return parent;

    thread_local ActiveElements candidates, kept;
    candidates.take(field, parent.elements);
    double far = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        far += std::max(std::abs(field.skeletons.lo[k] - o[k]),
                        std::abs(field.skeletons.hi[k] - o[k]));
    }
    const Stretch rays{o, unit(cone.axis), spread_of(cone), part.lo,
                       std::max(part.lo, std::min(part.hi, far * (1 + 0x1p-46)))};
    // Each element is dropped once, whatever the number of lists between: all together stay below
    // 2^-52 T.
    const double share = field.threshold * 0x1p-52 / (1 + static_cast<double>(field.size()));
    const PeakSums peaks = bundle_steps().bound(field, rays, 1, share, candidates, kept);

    ElementList list;
    const double sums = 1 + static_cast<double>(candidates.size() + 64) * 0x1p-52;
    list.rest = parent.rest + Interval<double>(-peaks.rest_below * sums, peaks.rest_above * sums);
    const double slack =
        static_cast<double>(candidates.size() + 4) * 0x1p-52 * (peaks.magnitude + field.threshold);
    list.certainly_empty = peaks.above + list.rest.hi + slack < field.threshold;
    if (list.certainly_empty) return list;
    list.elements.assign(kept.element.begin(),
                         kept.element.begin() + static_cast<std::ptrdiff_t>(kept.size()));
    return list;
}

}  // namespace ivory
