// The square of a vector that moves linearly, v(t) = v_r + (t - t_r) e, enclosed at a t or over
// [t0, t1]. The doubles v_r and e carry errors of at most eta = |dv_r| and nu = |de|, which are
// bounded once; every enclosure is then the plain double result with a proven radius around it (no
// directed rounding in the inner loop).
//
// Lemma. With tau = t - t_r, rho >= |v_r|, kappa >= |e|, R = rho + kappa |tau|,
// err = eta + nu |tau| and u = 2^-53, the doubles
//     s  = alpha + tau (beta + (beta + gamma tau)),
//     s' = 2 (beta + gamma tau)
// from alpha = v_r.v_r, beta = v_r.e, gamma = e.e differ from |v|^2 and its derivative by at most
//     |ds|  <= (2 R + err) err + 16 u R^2,
//     |ds'| <= 2 (err kappa + (R + err) nu) + 24 u R kappa.
// Proof: | |v + dv|^2 - |v|^2 | <= (2 |v| + |dv|) |dv| with |v| <= R, |dv| <= err; likewise for
// 2 v.e. The dot products carry 3 u each, the polynomial 5 u more, tau one u (which moves v by
// u kappa |tau|): at most 8 u of R^2 + 2 u R^2 for s, 12 u R kappa for s'. The constants leave room
// for the roundings of the radius itself. Products that underflow are covered by the absolute term
// of s_radius: kappa and rho are kept within 1e+-75 by `usable`.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/interval/interval.h"

namespace ivory {

// s and s' at one t with their radii of error.
struct SquareAt {
    double s, s_radius;
    double ds, ds_radius;

    [[nodiscard]] Interval<double> value() const {
        return {std::max(s - s_radius, 0.0), s + s_radius};
    }
    [[nodiscard]] Interval<double> slope() const { return {ds - ds_radius, ds + ds_radius}; }
};

// |v(t)|^2 for a vector that moves linearly; the notation of the lemma above.
struct MovingSquare {
    double reference = 0;                   // t_r
    double alpha = 0, beta = 0, gamma = 0;  // v_r.v_r, v_r.e, e.e
    double rho = 0, kappa = 0;              // >= |v_r|, >= |e|
    double eta = 0, nu = 0;                 // error of v_r and of e
    double least = 0;                       // a lower bound of |v|^2 over the span it was made for
    double vertex = 0;                      // and over the whole line

    [[nodiscard]] SquareAt at(double t) const {
        const double tau = t - reference;
        const double reach = std::abs(tau);
        const double error = eta + nu * reach;
        const double radius = rho + kappa * reach;
        const double half_slope = beta + gamma * tau;
        return {alpha + tau * (beta + half_slope),
                (2.001 * radius + 1.001 * error) * error + 16.1 * unit_roundoff * radius * radius +
                    1e-290,
                2 * half_slope,
                2.001 * (error * kappa + (radius + error) * nu) +
                    24.1 * unit_roundoff * radius * kappa + 1e-290};
    }

    // (|v|^2)'' = 2 |e|^2, constant.
    [[nodiscard]] Interval<double> curvature() const {
        const double radius =
            (4.001 * kappa + 2.001 * nu) * nu + 16 * unit_roundoff * gamma + 1e-290;
        return {std::max(2 * gamma - radius, 0.0), 2 * gamma + radius};
    }

    // The range of |v|^2 over [t0, t1] from its values there: it is convex, so its maximum is at an
    // end, and its minimum too unless the slope changes sign in between.
    [[nodiscard]] Interval<double> over(const SquareAt& at0, const SquareAt& at1) const {
        const double hi = std::max(at0.s + at0.s_radius, at1.s + at1.s_radius);
        const bool dips = at0.ds - at0.ds_radius < 0 && at1.ds + at1.ds_radius > 0;
        const double lo = dips ? least : std::min(at0.s - at0.s_radius, at1.s - at1.s_radius);
        return {std::max(lo, 0.0), hi};
    }
};

}  // namespace ivory
