// Where a kernel has a value.
#pragma once

#include "tests/reference/along_ray.h"
#include "tests/reference/multiprecision.h"

namespace ivory::reference {

// The q at which one element of strength 1 is at T, by halving: kernels fall.
inline RealInterval level(KernelKind kind, double threshold) {
    const Real exact(threshold);
    const auto value = [&](const Real& s) { return kernel_germ(kind, RealInterval(s)).value; };
    Real lo(0.0), hi(1.0);
    while (value(hi).hi >= exact) hi = scaled(hi, 1);
    for (int n = 0; n < 200; ++n) {
        const Real middle = scaled(rounded(mpfr_add, MPFR_RNDN, lo, hi), -1);
        const RealInterval there = value(middle);
        if (there.lo > exact) {
            lo = middle;
        } else if (there.hi < exact) {
            hi = middle;
        } else {  // at T within the last bits
            lo = rounded(mpfr_sub, MPFR_RNDD, middle, scaled(middle, -180));
            hi = rounded(mpfr_add, MPFR_RNDU, middle, scaled(middle, -180));
            break;
        }
    }
    return sqrt(RealInterval(lo, hi));
}

}  // namespace ivory::reference
