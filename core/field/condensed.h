// Many smooth elements as one polynomial. Where widths are large against spacings, as in density maps, thousands
// of elements matter at every point, but on a window much smaller than they are wide their sum is one smooth
// function: its Taylor polynomial about the window's middle, of total degree n, takes their place. (Fast Gauss
// transform, Greengard and Strain 1991; their printed bound of what is cut off is not used. The bounds here are
// the following.)
//
// For one Gaussian F = b exp(-|x - c|^2 / w^2), x within rho of the middle M, d the least distance of c from the
// segment between M and x:
//
//  1. Remainder. Along any line F is a one-dimensional Gaussian times exp(-h^2 / w^2), h the line's distance
//     from c, so that its m-th derivative by arc length is b (-1/w)^m H_m(xi) exp(-xi^2 - h^2 / w^2), and with
//     Cramer's |H_m(xi)| <= 1.0865 2^(m/2) sqrt(m!) exp(xi^2 / 2)
//         |D^m F| <= 1.0865 |b| (sqrt 2 / w)^m sqrt(m!) exp(-d^2 / (2 w^2)).
//     As a symmetric multilinear form is nowhere greater than on equal arguments (Banach 1938), this holds for
//     derivatives in different directions too. Hence with r = sqrt 2 rho / w and
//         R = 1.0865 sum |b| exp(-d^2 / (2 w^2)) r^(n+1) / sqrt((n+1)!)
//     |f - P| <= R, |f' - P'| <= R (n + 1) / rho, |f'' - P''| <= R (n + 1) n / rho^2.
//
//  2. Rounding. exp(-(X - tau)^2) = exp(-X^2) sum g_k tau^k with g_0 = 1, g_1 = 2 X,
//     (k + 1) g_(k+1) = 2 X g_k - 2 g_(k-1). Taken with |X| and plus the same recurrence gives G_k >= |g_k|, the
//     coefficients of exp(2 |X| tau + tau^2), and the computed g_k is off by 6 k u G_k: each step's five
//     roundings are relative to what G's step adds up. The products over the axes, multiplied by exp(-|X|^2), and
//     summed over all terms at |tau_j| <= a_j come to at most
//         exp(-|X|^2) prod exp(2 |X_j| a_j + a_j^2) = exp(2 |a|^2 - sum (|X_j| - a_j)^2)
//                                                  <= exp(r^2) exp(-d^2 / w^2),
//     since |a| = rho / w. The like for derivatives, with q = d / w, |X| <= q + |a|: the sum of |d/dtau| is at most
//     2 (|X| + |a|) times that.
//
// So all that is asked of an element is its strength, its width, and how near it may be (SmoothSums in condense.inl).
#pragma once

#include <array>
#include <cstddef>

#include "core/math/vec3.h"

namespace ivory {

// P of the elements of a list, in units (Field::unit) and of strengths times Field::scale, in coordinates
// u, v, w about the window's middle, w along the axis of the bundle's part.
struct Condensed {
    static constexpr std::size_t greatest_degree = 14;
    static constexpr std::size_t room =
        (greatest_degree + 1) * (greatest_degree + 2) * (greatest_degree + 3) / 6;
    // sqrt 2 rho / w of the narrowest element, at most.
    static constexpr double widest = 1.25;

    std::size_t degree = 0;
    std::size_t elements = 0;
    std::array<Vec3<float>, 3> frame;     // u, v, w; to nearest
    std::array<float, room> coefficient;  // of u^i v^j w^k in ascending order of i, then j, then k

    // Of what is computed in float from it at a ray's point in the window: |f - P|, |f' - P'| and |grad f - grad P|.
    double error = 0, slope_error = 0, gradient_error = 0;
    // Upper bounds on the window, for all rays of the part: of f, and of f'' and -f'', of the elements'
    // exact sum.
    double most = 0, rise = 0, fall = 0;
};

// The same along one ray alone, in double: a polynomial in t - (the window's middle), in scene units.
struct CondensedRay {
    static constexpr std::size_t greatest_degree = 24;

    std::size_t degree = 0;
    std::array<double, greatest_degree + 1> coefficient;
    double error = 0, slope_error = 0;  // of what is computed from it in double
    double rise = 0, fall = 0;
};

// How close a polynomial has to be: most windows hold no root, for which little will do.
enum class Closeness { rough, close };

enum class Condensing {
    condensed,
    too_large,  // the window, for its elements; smaller ones may do
    unfit,      // rays too far apart, or numbers that float does not hold
};

}  // namespace ivory
