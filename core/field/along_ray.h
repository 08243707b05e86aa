// s(t) = q^2 = (d(p(t)) / w)^2 of one skeleton along a ray p(t) = o + t d, enclosed at a t or over
// [t0, t1].
//
// Everything is built from one vector that moves linearly, v(t) = v_r + (t - t_r) e, in units of
// the element's width: from a point to p(t); or the part of it perpendicular to an axis, from a
// segment's line or a circle's axis. Its square is a parabola in t. The doubles v_r and e carry
// errors of at most eta = |dv_r| and nu = |de|, which are bounded once per ray and element; every
// enclosure is then the plain double result with a proven radius around it (no directed rounding in
// the inner loop).
//
// Lemma. With tau = t - t_r, rho >= |v_r|, kappa >= |e|, R = rho + kappa |tau|, err = eta + nu
// |tau| and u = 2^-53, the doubles s = alpha + tau (beta + (beta + gamma tau)), s' = 2 (beta +
// gamma tau) from alpha = v_r.v_r, beta = v_r.e, gamma = e.e differ from |v|^2 and its derivative
// by at most
//     |ds|  <= (2 R + err) err + 16 u R^2,
//     |ds'| <= 2 (err kappa + (R + err) nu) + 24 u R kappa.
// Proof: | |v + dv|^2 - |v|^2 | <= (2 |v| + |dv|) |dv| with |v| <= R, |dv| <= err; likewise for 2
// v.e. The dot products carry 3 u each, the polynomial 5 u more, tau one u (which moves v by u
// kappa |tau|): at most 8 u of R^2 + 2 u R^2 for s, 12 u R kappa for s'. The constants leave room
// for the roundings of the radius itself. Products that underflow are covered by the absolute term
// of s_radius: kappa and rho are kept within 1e+-75 by `usable`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/field/field.h"
#include "core/field/kernel.h"
#include "core/interval/interval.h"
#include "core/math/vec3.h"

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

// A segment's three cases along a ray (or a point's only one): while t lies in `where`, s may be
// this square; outside of it, it certainly is another piece's.
struct Piece {
    MovingSquare square;
    Interval<double> where;
};

// A circle of radius r about the axis n: with v the vector from the centre, h = n.v (linear in t)
// and rho = |v - h n|, s = (rho - r)^2 + h^2. (The expanded form |v|^2 + r^2 - 2 r rho cancels near
// the circle.) rho'' = gamma rho_0^2 / rho^3 >= 0, where rho_0 is the least rho on the line; so
// rho' rises, and s'' = 2 |d|^2 - 2 r rho''. Where rho can be 0, s' jumps downward and s'' is
// unbounded below.
struct CircleAlongRay {
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
    struct Over {
        Interval<double> s, ds, dds;
    };

    [[nodiscard]] At at(double t) const;
    // Ranges over [t0, t1], t0 < t1, from the values at its ends.
    [[nodiscard]] Over over(double t0, double t1, const At& at0, const At& at1) const;
};

// One element seen from one ray, for t in a span.
struct ElementAlongRay {
    enum class Form : unsigned char {
        squares,   // pieces[0 .. piece_count): s is the square of the piece that t lies in
        circle,    // circle
        unbounded  // numbers too large or too small for the lemma: 0 <= k <= 1 is all that is known
    };
    Form form = Form::unbounded;
    KernelKind kernel = KernelKind::blinn;
    unsigned char piece_count = 0;
    double strength = 1;
    double least = 0;  // a lower bound of s over the span
    double peak = 1;   // an upper bound of k over the span
    // s >= cut certainly holds on the span outside of this; empty: nowhere on the span is s <= cut.
    Interval<double> active = Interval<double>::entire();
    Interval<double> beyond{0.0, 0.0};  // of strength k(s) there
    std::array<Piece, 3> pieces;
    CircleAlongRay circle;
};

// Element i of the field along origin + t direction, t in the finite `span`; the largest component
// of `direction` has to lie in [1, 2). `cut` bounds `active`: a value of s beyond which k counts as
// nothing.
void along_ray(const Field& field, std::size_t i, const Vec3d& origin, const Vec3d& direction,
               const Interval<double>& span, double cut, ElementAlongRay& result);

}  // namespace ivory
