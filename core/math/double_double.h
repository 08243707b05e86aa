// Numbers of twice the precision, as unevaluated sums of two doubles (Dekker 1971, Knuth's TwoSum): for
// what is computed once and must not cancel. Sums, products and quotients err by less than 2^-100 of
// themselves, square roots by less than 2^-98, where nothing over- or underflows: whoever calls scales
// his numbers to be near 1.
#pragma once

#include <cmath>

#include "core/math/vec3.h"

namespace ivory {

struct DoubleDouble {
    double hi = 0, lo = 0;

    constexpr DoubleDouble() = default;
    constexpr DoubleDouble(double x) : hi(x) {}
    constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}

    [[nodiscard]] constexpr double rounded() const { return hi + lo; }
};

namespace double_double_detail {

// x + y without error.
constexpr DoubleDouble two_sum(double x, double y) {
    const double sum = x + y;
    const double of_y = sum - x;
    return {sum, (x - (sum - of_y)) + (y - of_y)};
}
// Likewise, where |x| >= |y|.
constexpr DoubleDouble quick_two_sum(double x, double y) {
    const double sum = x + y;
    return {sum, y - (sum - x)};
}

}  // namespace double_double_detail

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    using namespace double_double_detail;
    const DoubleDouble high = two_sum(a.hi, b.hi), low = two_sum(a.lo, b.lo);
    const DoubleDouble sum = quick_two_sum(high.hi, high.lo + low.hi);
    return quick_two_sum(sum.hi, sum.lo + low.lo);
}
inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const double product = a.hi * b.hi;
    const double low = std::fma(a.hi, b.hi, -product) + (a.hi * b.lo + a.lo * b.hi);
    return double_double_detail::quick_two_sum(product, low);
}

inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.hi / b.hi;
    const DoubleDouble left = a - b * DoubleDouble(first);
    const double second = left.hi / b.hi;
    const DoubleDouble last = left - b * DoubleDouble(second);
    return double_double_detail::quick_two_sum(first, second) + DoubleDouble(last.hi / b.hi);
}

// a >= 0.
inline DoubleDouble sqrt(const DoubleDouble& a) {
    if (!(a.hi > 0)) return {};
    const double root = std::sqrt(a.hi);
    const DoubleDouble left = a - DoubleDouble(root) * DoubleDouble(root);
    return double_double_detail::quick_two_sum(root, left.rounded() / (2 * root));
}

using Vec3dd = Vec3<DoubleDouble>;

// b - a without error, but where it underflows.
inline Vec3dd difference(const Vec3d& b, const Vec3d& a) {
    using double_double_detail::two_sum;
    return {two_sum(b.x, -a.x), two_sum(b.y, -a.y), two_sum(b.z, -a.z)};
}
inline Vec3d rounded(const Vec3dd& v) { return {v.x.rounded(), v.y.rounded(), v.z.rounded()}; }
inline DoubleDouble length(const Vec3dd& v) { return sqrt(dot(v, v)); }

}  // namespace ivory
