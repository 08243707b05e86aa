// What elements that were left out of a list can add to the field, and take away from it.
#pragma once

#include <cstddef>

#include "core/field/bundle_steps.h"

namespace ivory {

// The u below of sums in float.
inline constexpr double u_float = 0x1p-22;

struct LeftOut {
    double above = 0, below = 0;

    // With those of the `candidates` that were left out on the way: the sums of their peaks were
    // computed with a relative error of u for each.
    [[nodiscard]] LeftOut with(const PeakSums& peaks, std::size_t candidates, double u) const {
        const double sums = 1 + static_cast<double>(candidates + 64) * u;
        return {(above + peaks.left_out_above * sums) * (1 + 0x1p-50),
                (below + peaks.left_out_below * sums) * (1 + 0x1p-50)};
    }
};

// Whether the peaks, of so many elements at the most and each summed with a relative error of u, and
// the left_out cannot add up to the threshold.
[[nodiscard]] inline bool certainly_below(double threshold, const PeakSums& peaks,
                                          const LeftOut& left_out, std::size_t elements, double u) {
    const double slack = static_cast<double>(elements + 4) * u * (peaks.magnitude + threshold);
    return peaks.above + left_out.above + slack < threshold;
}

}  // namespace ivory
