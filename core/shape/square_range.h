// What s, s' and s'' can be over [t0, t1] of a ray.
#pragma once

#include "core/interval/interval.h"
#include "core/interval/quick.h"

namespace ivory {

struct SquareRange {
    Interval<double> s, ds, dds;
};

// Narrows ranges of s and s' by what they are at both ends: s' moves away from either by no more than
// s'' lets it, s by no more than s', and where s' keeps its sign s lies between the ends. A bound of
// s'' that is infinite below says nothing.
inline void narrow_by_ends(SquareRange& range, const Interval<double>& elapsed,
                           const Interval<double>& s0, const Interval<double>& ds0,
                           const Interval<double>& s1, const Interval<double>& ds1) {
    if (range.dds.lo > -infinity<double>) {
        const Interval<double> gain = quick::mul(range.dds, elapsed);
        range.ds =
            intersection(range.ds, intersection(quick::add(ds0, gain), quick::sub(ds1, gain)));
    }
    if (range.ds.lo >= 0) {
        range.s = intersection(range.s, Interval<double>(s0.lo, s1.hi));
    } else if (range.ds.hi <= 0) {
        range.s = intersection(range.s, Interval<double>(s1.lo, s0.hi));
    } else {
        const Interval<double> gain = quick::mul(range.ds, elapsed);
        range.s = intersection(range.s, intersection(quick::add(s0, gain), quick::sub(s1, gain)));
    }
}

}  // namespace ivory
