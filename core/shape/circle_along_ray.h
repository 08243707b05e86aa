// s(t) of a circle or a disc along a ray, enclosed.
#pragma once

#include "core/interval/interval.h"
#include "core/interval/moving_square.h"
#include "core/shape/square_range.h"

namespace ivory {

// A circle of radius r about the axis n: with v the vector from the centre, h = n.v (linear in t)
// and rho = |v - h n|, s = (rho - r)^2 + h^2. (The expanded form |v|^2 + r^2 - 2 r rho cancels near
// the circle.) rho'' = gamma rho_0^2 / rho^3 >= 0, where rho_0 is the least rho on the line; so
// rho' rises, and s'' = 2 |d|^2 - 2 r rho''. Where rho can be 0, s' jumps downward and s'' is
// unbounded below.
//
// Filled, a disc: s = max(rho - r, 0)^2 + h^2, which is convex, with s'' = 2 h'^2 where rho < r and
// 2 h'^2 <= s'' <= 2 |d|^2 beyond. s' does not jump.
struct CircleAlongRay {
    bool filled = false;
    MovingSquare across;            // rho^2
    Interval<double> least_across;  // rho_0^2, enclosed
    double height = 0,
           rise = 0;          // h(t) = height + (t - across.reference) rise, within across' errors
    Interval<double> radius;  // r / w
    Interval<double> curvature;  // 2 |d|^2 / w^2

    struct At {
        SquareAt square;  // of rho^2
        Interval<double> rho, drho, h, s, ds;
    };
    using Over = SquareRange;

    [[nodiscard]] At at(double t) const;
    // Ranges over [t0, t1], t0 < t1, from the values at its ends.
    [[nodiscard]] Over over(double t0, double t1, const At& at0, const At& at1) const;
    // {t: |h(t)| <= most}, enclosed from outside.
    [[nodiscard]] Interval<double> within_height(double most) const;

  private:
    [[nodiscard]] Interval<double> off_rim(const Interval<double>& rho) const;
    [[nodiscard]] Interval<double> rho_bend(const Interval<double>& rho) const;
    [[nodiscard]] Over over_filled(double t0, double t1, const At& at0, const At& at1) const;
};

}  // namespace ivory
