// The one place that rounds outward.
//
// Every operation is computed in the default mode, to nearest, and then stepped to a neighbour
// where the exact result may lie beyond it. The rounding mode is never switched: g++ and clang
// merge equal operations across a switch. Each *_down (*_up) returns a number <= (>=) the exact
// result and at most one neighbour away from the greatest (least) such number.
//
// Why one step is enough: rounding to nearest is monotone and leaves representable numbers alone,
// so the rounded result is one of the two numbers around the exact one, and its neighbour bounds
// it. This holds for subnormal results and for overflow too: next_down(+inf) is the largest finite
// number.
#pragma once

#include <bit>
#include <cfloat>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ > 0
#error "Ivory proves its rounding: compile it without -ffast-math, -Ofast and -ffinite-math-only."
#endif
#if FLT_EVAL_METHOD != 0
#error "Ivory proves its rounding: float and double have to be evaluated in their own precision."
#endif

namespace ivory {

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<float>::is_iec559);

template <class Real>
concept IeeeReal = std::same_as<Real, float> || std::same_as<Real, double>;

// Half a unit in the last place of 1: the relative error of one rounding of a double to nearest.
inline constexpr double unit_roundoff = 0x1p-53;

template <IeeeReal Real>
inline constexpr Real infinity = std::numeric_limits<Real>::infinity();
template <IeeeReal Real>
inline constexpr Real largest = std::numeric_limits<Real>::max();
template <IeeeReal Real>
inline constexpr Real smallest = std::numeric_limits<Real>::denorm_min();

// The least number > x; +inf and NaN stay. Numbers of one sign are ordered as their bit patterns;
// adding 0 turns -0 into +0, whose successor is the pattern 1.
template <IeeeReal Real>
[[nodiscard]] constexpr Real next_up(Real x) {
    using Bits = std::conditional_t<std::same_as<Real, float>, std::uint32_t, std::uint64_t>;
    const Bits bits = std::bit_cast<Bits>(x + Real(0));
    const bool is_negative = (bits >> (8 * sizeof(Real) - 1)) != 0;
    const Real next = std::bit_cast<Real>(is_negative ? bits - 1 : bits + 1);
    return x < infinity<Real> ? next : x;
}

// The greatest number < x; -inf and NaN stay.
template <IeeeReal Real>
[[nodiscard]] constexpr Real next_down(Real x) {
    return -next_up(-x);
}

// A double as a float, downwards. Rounding downwards twice is rounding downwards once.
[[nodiscard]] constexpr float float_down(double x) {
    const float nearest = static_cast<float>(x);
    return static_cast<double>(nearest) > x ? next_down(nearest) : nearest;
}

[[nodiscard]] constexpr float float_up(double x) { return -float_down(-x); }

// a + b, exact where a + b is representable and else the tightest bound.
//   Let s = fl(a + b). Where |a| >= |b|, fl(s - a) = s - a (Dekker 1971), so s > a + b exactly if
//   fl(s - a) > b; where |a| <= |b|, likewise with a and b exchanged. The comparison that is not
//   exact cannot mislead: if s <= a + b then s - a <= b, and rounding is monotone: fl(s - a) <= b.
//   An overflow to +inf compares greater and becomes the largest number; where a is infinite both
//   comparisons are false and s stays.
template <IeeeReal Real>
[[nodiscard]] constexpr Real add_down(Real a, Real b) {
    const Real s = a + b;
    const bool is_above = (s - a > b) | (s - b > a);
    return is_above ? next_down(s) : s;
}

template <IeeeReal Real>
[[nodiscard]] constexpr Real add_up(Real a, Real b) {
    return -add_down(-a, -b);
}

template <IeeeReal Real>
[[nodiscard]] constexpr Real sub_down(Real a, Real b) {
    return add_down(a, -b);
}

template <IeeeReal Real>
[[nodiscard]] constexpr Real sub_up(Real a, Real b) {
    return -add_down(-a, b);
}

// Multiplication, division and root of doubles would need an fma to know the sign of their error.
// It is a call without -mfma, so their results are stepped always, but for the cases that cost a
// few integer operations: an operand with one significant bit (a power of two), or operands with at
// most 26, whose product has at most 52. They keep 1 x = x, and the small integers and short
// fractions that people write. Floats are computed in double, where a product is exact, and are
// tightest.

inline constexpr std::uint64_t low_27_bits = (std::uint64_t{1} << 27) - 1;
inline constexpr std::uint64_t fraction_bits = (std::uint64_t{1} << 52) - 1;

// Finite and beyond the least normal number: a result of at most 53 significant bits that rounds to
// such a number is that number.
[[nodiscard]] constexpr bool beyond_underflow(double x) {
    const double magnitude = x < 0 ? -x : x;
    return (magnitude > DBL_MIN) & (magnitude <= DBL_MAX);
}

[[nodiscard]] constexpr bool have_26_bits(double a, double b) {
    return ((std::bit_cast<std::uint64_t>(a) | std::bit_cast<std::uint64_t>(b)) & low_27_bits) == 0;
}

[[nodiscard]] constexpr bool has_1_bit(double a) {
    return (std::bit_cast<std::uint64_t>(a) & fraction_bits) == 0;
}

// Whether m = fl(a b) is known to be a b.
[[nodiscard]] constexpr bool is_exact_product(double a, double b, double m) {
    const bool short_operands = have_26_bits(a, b);
    const bool a_is_power = has_1_bit(a);
    const bool b_is_power = has_1_bit(b);
    const bool is_normal = beyond_underflow(m);
    return (short_operands | a_is_power | b_is_power) & is_normal;
}

// a b; 0 times inf is 0, since an infinite bound is not a member. Where an operand is infinite a
// result of +inf may be lowered to the largest number, the tightest bound of a finite product.
[[nodiscard]] constexpr double mul_down(double a, double b) {
    const double m = a * b;
    if (m == 0 || m != m) return a != 0 && b != 0 && (a < 0) != (b < 0) ? -smallest<double> : 0;
    return is_exact_product(a, b, m) ? m : next_down(m);
}

[[nodiscard]] constexpr float mul_down(float a, float b) {
    if (a == 0 || b == 0) return 0;
    return float_down(static_cast<double>(a) * static_cast<double>(b));
}

template <IeeeReal Real>
[[nodiscard]] constexpr Real mul_up(Real a, Real b) {
    return -mul_down(-a, b);
}

// a / b for b != 0, not both infinite.
//   A quotient q is exact where b is a power of two, and where fl(q b) = a while q b is exact.
[[nodiscard]] constexpr double div_down(double a, double b) {
    const double q = a / b;
    if (q == 0) return a != 0 && (a < 0) != (b < 0) && b - b == 0 ? -smallest<double> : 0;
    const bool b_is_power = has_1_bit(b);
    const bool is_normal = beyond_underflow(q);
    const bool back_is_exact = is_exact_product(q, b, a);
    const bool exact = (b_is_power | (back_is_exact & (q * b == a))) & is_normal;
    return exact ? q : next_down(q);
}

// In float the quotient in double decides. Let f be a float, and a/b != f. Then a - f b is a
// multiple of the last places of a or of f b, so a/b differs from f by a relative 2^-48 at least,
// fl(a/b) lies on the same side of f, and rounding it downwards is the tightest bound.
[[nodiscard]] constexpr float div_down(float a, float b) {
    return float_down(static_cast<double>(a) / static_cast<double>(b));
}

template <IeeeReal Real>
[[nodiscard]] constexpr Real div_up(Real a, Real b) {
    return -div_down(-a, b);
}

[[nodiscard]] inline bool is_exact_root(double x, double root) {
    const bool square_is_exact = is_exact_product(root, root, x);
    return (x == 0) | (square_is_exact & (root * root == x));
}

// The root of x >= 0.
[[nodiscard]] inline double sqrt_down(double x) {
    const double root = std::sqrt(x);
    return is_exact_root(x, root) ? root : next_down(root);
}

[[nodiscard]] inline double sqrt_up(double x) {
    const double root = std::sqrt(x);
    return is_exact_root(x, root) ? root : next_up(root);
}

// As for the quotient: x - f^2 is a multiple of the last places of x or of f^2.
[[nodiscard]] inline float sqrt_down(float x) {
    return float_down(std::sqrt(static_cast<double>(x)));
}

[[nodiscard]] inline float sqrt_up(float x) { return float_up(std::sqrt(static_cast<double>(x))); }

// a b + c, rounded once, where 0 times inf is 0. c is finite or -inf.
[[nodiscard]] inline double fma_down(double a, double b, double c) {
    if (a == 0 || b == 0 || c == -infinity<double>) return c;
    const double m = a * b;
    return is_exact_product(a, b, m) ? add_down(m, c) : next_down(std::fma(a, b, c));
}

[[nodiscard]] inline float fma_down(float a, float b, float c) {
    if (a == 0 || b == 0 || c == -infinity<float>) return c;
    return float_down(
        add_down(static_cast<double>(a) * static_cast<double>(b), static_cast<double>(c)));
}

template <IeeeReal Real>
[[nodiscard]] inline Real fma_up(Real a, Real b, Real c) {
    return -fma_down(-a, b, -c);
}

// 2^n for -1022 <= n <= 1023.
[[nodiscard]] constexpr double power_of_two(int n) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52);
}

// x 2^n for 1/2 <= |x| <= 2, the tightest bound.
//   Where it cannot underflow or overflow it is exact. Else it is made in two factors, of which the
//   first is exact; scaled back, the result is exact too and shows on which side of x it lies.
[[nodiscard]] constexpr double scale_down(double x, std::int64_t n) {
    if (n >= -1021 && n <= 1022) return x * power_of_two(static_cast<int>(n));
    const int within = n < -1100 ? -1100 : n > 1100 ? 1100 : static_cast<int>(n);
    const int first = within / 2;
    const int second = within - first;
    const double scaled = x * power_of_two(first) * power_of_two(second);
    const double back = scaled * power_of_two(-second) * power_of_two(-first);
    return back > x ? next_down(scaled) : scaled;
}

[[nodiscard]] constexpr double scale_up(double x, std::int64_t n) { return -scale_down(-x, n); }

}  // namespace ivory
