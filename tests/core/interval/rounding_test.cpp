// The steps outward: each bound is on its side of the exact result, and the tightest or next to it.
#include "core/interval/rounding.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <cmath>
#include <limits>

#include "tests/core/interval/adversary.h"
#include "tests/core/interval/tightest.h"

namespace ivory::test {
namespace {

template <class Real>
class Rounding : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Rounding, Reals);

TYPED_TEST(Rounding, NeighboursAreTheLibrarys) {
    using Real = TypeParam;
    Adversary<Real> adversary(announced_seed());
    for (int i = 0; i < 200'000; ++i) {
        const Real x = adversary.number();
        ASSERT_EQ(next_up(x), std::nextafter(x, infinity<Real>)) << x;
        ASSERT_EQ(next_down(x), std::nextafter(x, -infinity<Real>)) << x;
    }
}

TYPED_TEST(Rounding, NeighboursAtTheEdges) {
    using Real = TypeParam;
    const Real min = std::numeric_limits<Real>::min();
    EXPECT_EQ(next_up(Real(0)), smallest<Real>);
    EXPECT_EQ(next_up(Real(-0.0)), smallest<Real>);
    EXPECT_EQ(next_down(Real(0)), -smallest<Real>);
    EXPECT_EQ(next_down(Real(-0.0)), -smallest<Real>);
    EXPECT_EQ(next_up(-smallest<Real>), 0);
    EXPECT_EQ(next_down(smallest<Real>), 0);
    EXPECT_EQ(next_down(min), min - smallest<Real>);
    EXPECT_EQ(next_up(largest<Real>), infinity<Real>);
    EXPECT_EQ(next_up(infinity<Real>), infinity<Real>);
    EXPECT_EQ(next_down(infinity<Real>), largest<Real>);
    EXPECT_EQ(next_down(-infinity<Real>), -infinity<Real>);
    EXPECT_EQ(next_up(-infinity<Real>), -largest<Real>);
    EXPECT_TRUE(std::isnan(next_up(std::numeric_limits<Real>::quiet_NaN())));
    static_assert(next_up(Real(1)) == 1 + std::numeric_limits<Real>::epsilon());
}

// The bounds `down` and `up` against the exact result of `function`; double may be a step off.
template <class Real, class Function, class... Operands>
void expect_bounds(Real down, Real up, int steps, Function function, Operands... operands) {
    const Interval<Real> tightest(
        rounded_to<Real>(reference::rounded(function, MPFR_RNDD, reference::Real(operands)...),
                         MPFR_RNDD),
        rounded_to<Real>(reference::rounded(function, MPFR_RNDU, reference::Real(operands)...),
                         MPFR_RNDU));
    ASSERT_TRUE(encloses_within({down, up}, tightest, steps))
        << text(Interval<Real>(down, up)) << " for " << text(tightest);
}

TYPED_TEST(Rounding, BoundsOfFiniteOperands) {
    using Real = TypeParam;
    constexpr int steps = std::same_as<Real, float> ? 0 : 1;
    Adversary<Real> adversary(announced_seed());
    for (int i = 0; i < 200'000; ++i) {
        const Real a = adversary.number();
        const Real b = adversary.below(4) == 0 ? next_up(-a) : adversary.number();
        const Real c = adversary.below(4) == 0 ? -(a * b) : adversary.number();
        SCOPED_TRACE(testing::Message() << std::hexfloat << a << ' ' << b << ' ' << c);
        if (!std::isfinite(a) || !std::isfinite(b)) continue;
        expect_bounds(add_down(a, b), add_up(a, b), 0, mpfr_add, a, b);
        expect_bounds(sub_down(a, b), sub_up(a, b), 0, mpfr_sub, a, b);
        expect_bounds(mul_down(a, b), mul_up(a, b), steps, mpfr_mul, a, b);
        if (b != 0) expect_bounds(div_down(a, b), div_up(a, b), steps, mpfr_div, a, b);
        if (a >= 0) expect_bounds(sqrt_down(a), sqrt_up(a), steps, mpfr_sqrt, a);
        if (std::isfinite(c)) {
            expect_bounds(fma_down(a, b, c), fma_up(a, b, c), steps, mpfr_fma, a, b, c);
        }
        if (testing::Test::HasFatalFailure()) return;
    }
}

// Beside the numbers whose quotient or root is short, where a check for exact results may be
// misled.
TYPED_TEST(Rounding, BoundsOfNearlyExactResults) {
    using Real = TypeParam;
    constexpr int steps = std::same_as<Real, float> ? 0 : 1;
    Adversary<Real> adversary(announced_seed());
    for (int i = 0; i < 50'000; ++i) {
        const Real x = adversary.with_few_bits();
        const Real y = adversary.with_few_bits();
        SCOPED_TRACE(testing::Message() << std::hexfloat << x << ' ' << y);
        expect_bounds(mul_down(x, y), mul_up(x, y), steps, mpfr_mul, x, y);
        for (const Real a : {next_down(x * y), x * y, next_up(x * y)}) {
            expect_bounds(div_down(a, y), div_up(a, y), steps, mpfr_div, a, y);
        }
        for (const Real a : {next_down(x * x), x * x, next_up(x * x)}) {
            expect_bounds(sqrt_down(a), sqrt_up(a), steps, mpfr_sqrt, a);
        }
        if (testing::Test::HasFatalFailure()) return;
    }
}

TYPED_TEST(Rounding, AFloatOfADoubleIsTheTightest) {
    Adversary<double> adversary(announced_seed());
    for (int i = 0; i < 200'000; ++i) {
        const double x = adversary.below(2) == 0
                             ? adversary.number()
                             : next_up(static_cast<double>(static_cast<float>(adversary.number())));
        const reference::Real exact(x);
        ASSERT_EQ(float_down(x), mpfr_get_flt(exact.raw(), MPFR_RNDD)) << std::hexfloat << x;
        ASSERT_EQ(float_up(x), mpfr_get_flt(exact.raw(), MPFR_RNDU)) << std::hexfloat << x;
    }
}

TYPED_TEST(Rounding, ZeroAndOneStayExact) {
    using Real = TypeParam;
    const Real third = Real(1) / 3;
    for (const Real x : {third, smallest<Real>, largest<Real>, -third}) {
        EXPECT_EQ(add_down(x, Real(0)), x);
        EXPECT_EQ(add_up(x, Real(0)), x);
        EXPECT_EQ(sub_down(x, x), 0);
        EXPECT_EQ(sub_up(x, x), 0);
        EXPECT_EQ(mul_down(x, Real(0)), 0);
        EXPECT_EQ(mul_up(Real(0), x), 0);
        EXPECT_EQ(div_down(Real(0), x), 0);
        EXPECT_EQ(div_up(Real(0), x), 0);
        EXPECT_EQ(fma_down(Real(0), third, x), x);
        EXPECT_EQ(fma_up(third, Real(0), x), x);
    }
    EXPECT_EQ(mul_down(Real(0), infinity<Real>), 0);
    EXPECT_EQ(mul_up(infinity<Real>, Real(0)), 0);
    EXPECT_EQ(sqrt_down(Real(0)), 0);
    EXPECT_EQ(sqrt_up(Real(0)), 0);
    EXPECT_EQ(sqrt_up(infinity<Real>), infinity<Real>);
    for (const Real x : {third, -third}) {
        EXPECT_EQ(mul_down(x, Real(1)), x);
        EXPECT_EQ(mul_up(Real(0.25), x), x / 4);
        EXPECT_EQ(div_down(x, Real(1)), x);
        EXPECT_EQ(div_up(x, Real(2)), x / 2);
    }
}

TYPED_TEST(Rounding, ShortNumbersStayExact) {
    using Real = TypeParam;
    for (const Real a : {Real(3), Real(-7.5), Real(1000)}) {
        for (const Real b : {Real(5), Real(0.125), Real(-96)}) {
            EXPECT_EQ(mul_down(a, b), a * b);
            EXPECT_EQ(mul_up(a, b), a * b);
            EXPECT_EQ(div_down(a * b, b), a);
            EXPECT_EQ(div_up(a * b, b), a);
            EXPECT_EQ(fma_down(a, b, Real(1)), a * b + 1);
        }
        EXPECT_EQ(sqrt_down(a * a), std::abs(a));
        EXPECT_EQ(sqrt_up(a * a), std::abs(a));
    }
}

TEST(Scaling, IsTightestWhereItOverflowsAndUnderflows) {
    Adversary<double> adversary(announced_seed());
    for (int i = 0; i < 200'000; ++i) {
        const double x = (adversary.below(2) == 0 ? 1 : -1) * (0.5 + 1.5 * adversary.uniform());
        const long n = static_cast<long>(adversary.below(2400)) - 1200;
        const reference::Real exact = reference::scaled(reference::Real(x), n);
        ASSERT_EQ(scale_down(x, n), exact.to_double(MPFR_RNDD)) << std::hexfloat << x << ' ' << n;
        ASSERT_EQ(scale_up(x, n), exact.to_double(MPFR_RNDU)) << std::hexfloat << x << ' ' << n;
    }
    EXPECT_EQ(scale_down(1, std::int64_t{1} << 40), largest<double>);
    EXPECT_EQ(scale_up(1, std::int64_t{1} << 40), infinity<double>);
    EXPECT_EQ(scale_down(1, -(std::int64_t{1} << 40)), 0);
    EXPECT_EQ(scale_up(1, -(std::int64_t{1} << 40)), smallest<double>);
}

}  // namespace
}  // namespace ivory::test
