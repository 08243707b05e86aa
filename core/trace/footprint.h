// Whether all rays of a pixel have the same status, told from the one in its middle: then one look says
// how the pixel looks, and where not, all of its rays are to be traced.
//
// Let p(t) be the middle ray's point, p'(t) another's, |p' - p| <= rho(t) = radius + t spread. With H
// a bound of f's second derivatives in any direction over all places of the window within the bundle,
//     |f(p') - f(p)| <= rho |grad f(p)| + H rho^2 / 2 = lateral(p),
// (between two rays that are `spread` apart the way to a skeleton is shorter than theirs by spread^2 / 4 of
// what they may be aside, which is less than `lateral` is widened by as long as spread <= 1 / 16)
// where of elements without second derivatives (kinks; joined parts) their greatest slope counts in
// place of a gradient. Where f + lateral < 0 on [0, t0] and f - lateral > 0 at t1 > t0 all of the pixel's
// rays have their first root in [t0, t1]; where f + lateral < 0 for all t all are misses. From one place to
// the next f + lateral grows by no more than f'' <= rise and the change of the gradient, at most H t, let:
// it stays below f + lateral + (f' + rho H + the slopes of what has no gradient) t + rise t^2 / 2.
#pragma once

#include "core/field/bundle_steps.h"

namespace ivory {

// How far the pixel's rays are from the middle one at most: |o' - o| <= radius, |d' - d| <= spread.
struct Footprint {
    static constexpr double widest = 1.0 / 16;  // spreads that the bounds are for

    double spread = 0, radius = 0;
};

// The same for one window.
struct FootprintBounds {
    double rho = 0;  // up to the window's end
    AcrossSums across;
};

}  // namespace ivory
