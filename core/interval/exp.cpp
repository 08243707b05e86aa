// Bounds of e^x for doubles: the value of exp.h carried on with the errors of its last sums.
//
// With c the rounding error of r, (3) of exp.h, and now v = r^2/2 + (r^3 Q(r) + (c + c r)):
//     t = fl(r + v),  s = fl(1 + t),  and exactly  r + v = t + e2,  1 + t = s + e1
// (Dekker 1971, as |r| >= |v| and 1 > |t|). So e^r is s + e1 + e2, but for
//     1.5 u r^2    of v without c, (5) of exp.h,
//     0.07 u r^2   of the sum that c has joined,
//     0.18 u r^2   of e^c = 1 + c, where c r^2/2 and less is left out, |c| <= u |r|,
//     2^-82        of rounding c, c r and e1 + e2, and of (3).
// Hence |e^r - (s + w)| < error := 2 u r^2 + 2^-80 with w = fl(e1 + e2), and 2 u r^2 < 0.2404 u.
//
// One step from s is enough:
//     s in [1/2, 1):  |e1| <= u/2, |e2| <= u/4 as |t| < 1/2, so |w| + error < u, which is the
//                     distance to both neighbours.
//     s in [1, 2):    |e1| <= u, so |w| + error < 1.5 u, less than the 2 u upwards and, but for
//                     s = 1, downwards.
//     s = 1, w < 0:   |t| <= u/2, so |w| + error < u/2 + 2^-79, less than the u downwards.
#include "core/interval/exp.h"

namespace ivory {

namespace {

// e^x = 2^exponent (s + w +- error).
struct ExpParts {
    double s;
    double w;
    double error;
    int exponent;
};

// |x| <= 760.
ExpParts exp_parts(double x) {
    using C = ExpConstants<double>;
    const double k = (x * C::inverse_of_ln2 + C::rounder) - C::rounder;
    const double high = x - k * C::ln2_high;
    const double low = k * C::ln2_low;
    const double r = high - low;
    const double c = (high - r) - low;
    const double r2 = r * r;
    const double v = 0.5 * r2 + (exp_tail<double>(r, r2) + (c + c * r));
    const double t = r + v;
    const double s = 1 + t;
    const double e1 = t - (s - 1);
    const double e2 = v - (t - r);
    return {s, e1 + e2, x == 0 ? 0 : 0x1p-52 * r2 + 0x1p-80, static_cast<int>(k)};
}

// e^-750 is below half the smallest number and e^750 beyond the largest.
double within_reach(double x) { return x < -750 ? -750 : x > 750 ? 750 : x; }

double exp_down(double x) {
    const ExpParts e = exp_parts(within_reach(x));
    return scale_down(e.w < e.error ? next_down(e.s) : e.s, e.exponent);
}

double exp_up(double x) {
    const ExpParts e = exp_parts(within_reach(x));
    return scale_up(e.w > -e.error ? next_up(e.s) : e.s, e.exponent);
}

}  // namespace

template <>
Interval<double> exp(const Interval<double>& a) {
    if (is_empty(a)) return {};
    return {exp_down(a.lo), a.hi == infinity<double> ? a.hi : exp_up(a.hi)};
}

// The bounds in double, rounded outward once more, are as good as tightest in float.
template <>
Interval<float> exp(const Interval<float>& a) {
    if (is_empty(a)) return {};
    const Interval<double> wide = exp(Interval<double>(a.lo, a.hi));
    return {float_down(wide.lo), float_up(wide.hi)};
}

}  // namespace ivory
