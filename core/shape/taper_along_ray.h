// s(t) of a segment whose width tapers along a ray, enclosed.
#pragma once

#include "core/interval/interval.h"
#include "core/math/vec3.h"
#include "core/shape/square_range.h"

namespace ivory {

// A segment whose width tapers (core/shape/taper.h), in intervals throughout.
struct TaperAlongRay {
    using Vector = Vec3<Interval<double>>;

    // The foot: where it may be.
    struct Foot {
        bool at_a = false, at_b = false;
        Interval<double> between = Interval<double>::empty_set();  // of u
    };
    struct At {
        Vector from_a;                   // a -> p(t)
        Interval<double> wanted, rises;  // of (1): alpha w_a + A d, |M|^2 w_a + alpha d
        Interval<double> s, ds;
    };
    using Over = SquareRange;

    // False: numbers too large or too small.
    [[nodiscard]] bool see(const Vec3d& from, const Vec3d& along, const Vec3d& end_a,
                           const Vec3d& end_b, double at_a, double at_b,
                           const Interval<double>& span);
    [[nodiscard]] At at(double t) const;
    // Ranges over [t0, t1], t0 < t1, from the values at its ends.
    [[nodiscard]] Over over(double t0, double t1, const At& at0, const At& at1) const;

  private:
    [[nodiscard]] Foot foot(const Interval<double>& wanted, const Interval<double>& rises) const;
    [[nodiscard]] Interval<double> slope(const Foot& foot, const Interval<double>& along) const;

    Vec3d origin, direction, a;
    Vector m;                                 // b - a
    Interval<double> width_a, width_b, more;  // more: width_b - width_a
    double least_width = 1;
    Interval<double> speed_square, along, length_square;  // |d|^2, M.d, |M|^2
};

}  // namespace ivory
