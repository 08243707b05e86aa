// Intervals: the cases of IEEE 1788 as tables, and every operation against MPFR.
#include "core/interval/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/core/interval/adversary.h"
#include "tests/core/interval/tightest.h"

namespace ivory::test {
namespace {

template <class Real>
struct Values {
    using I = Interval<Real>;
    static constexpr Real inf = infinity<Real>;
    static constexpr Real max = largest<Real>;
    static constexpr Real tiny = smallest<Real>;
    static constexpr I empty = I::empty_set();
    static constexpr I entire = I::entire();
    // What the doubles may lose: one number an end.
    static constexpr int steps = std::same_as<Real, float> ? 0 : 1;
};

template <class Real>
class IntervalOf : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(IntervalOf, Reals);

template <class Real>
void expect_all(const std::vector<std::pair<Interval<Real>, Interval<Real>>>& table) {
    for (std::size_t row = 0; row < table.size(); ++row) {
        EXPECT_EQ(table[row].first, table[row].second)
            << "row " << row << ": " << text(table[row].first) << " for "
            << text(table[row].second);
    }
}

TYPED_TEST(IntervalOf, TheDefaultIsEmpty) {
    using I = Interval<TypeParam>;
    static_assert(is_empty(I()));
    EXPECT_EQ(I(), I::empty_set());
    EXPECT_TRUE(is_empty(I(std::numeric_limits<TypeParam>::quiet_NaN())));
    EXPECT_FALSE(is_empty(I::entire()));
    EXPECT_FALSE(is_empty(I(0)));
    EXPECT_FALSE(contains(I(), TypeParam(0)));
    EXPECT_TRUE(contains(I(1, 2), TypeParam(2)));
    EXPECT_FALSE(contains(I(1, 2), next_up(TypeParam(2))));
    EXPECT_TRUE(is_subset(I(), I(1)));
    EXPECT_TRUE(is_subset(I(1, 2), I(1, 3)));
    EXPECT_FALSE(is_subset(I(0, 2), I(1, 3)));
    EXPECT_FALSE(is_subset(I(1), I()));
}

TYPED_TEST(IntervalOf, ReciprocalsAndQuotients) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    const auto inf = F::inf;
    expect_all<TypeParam>({
        {recip(I(0, 1)), I(1, inf)},
        {recip(I(-1, 0)), I(-inf, -1)},
        {recip(I(-1, 1)), F::entire},
        {recip(I(0)), F::empty},
        {recip(I(2, inf)), I(0, TypeParam(0.5))},
        {recip(F::entire), F::entire},
        {recip(I(TypeParam(-0.0), 1)), I(1, inf)},
        {recip(I(-1, TypeParam(-0.0))), I(-inf, -1)},
        {I(1, 2) / I(0), F::empty},
        {F::entire / I(0), F::empty},
        {I(0) / I(0), F::empty},
        {I(0) / I(-1, 1), I(0)},
        {I(0) / F::entire, I(0)},
        {I(0) / I(0, inf), I(0)},
        {I(1, 2) / I(-1, 1), F::entire},
        {I(0, 1) / I(-1, 1), F::entire},
        {I(0, 1) / I(0, 1), I(0, inf)},
        {I(-1, 0) / I(0, 1), I(-inf, 0)},
        {I(-1, 1) / I(0, 1), F::entire},
        {I(1, 2) / I(0, 4), I(TypeParam(0.25), inf)},
        {I(1, 2) / I(-4, 0), I(-inf, TypeParam(-0.25))},
        {I(-2, -1) / I(0, 4), I(-inf, TypeParam(-0.25))},
        {I(-2, -1) / I(-4, 0), I(TypeParam(0.25), inf)},
        {I(1, inf) / I(2, inf), I(0, inf)},
        {I(-inf, -1) / I(2, inf), I(-inf, 0)},
        {F::entire / I(2, 4), F::entire},
        {I(6, 12) / I(2, 3), I(2, 6)},
        {I(-6, 12) / I(2, 3), I(-3, 6)},
        {I(1) / I(F::tiny), I(F::max, inf)},
        {F::empty / I(1, 2), F::empty},
        {I(1, 2) / F::empty, F::empty},
    });
}

TYPED_TEST(IntervalOf, SumsAndProducts) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    const auto inf = F::inf;
    const auto max = F::max;
    const auto tiny = F::tiny;
    expect_all<TypeParam>({
        {I(1, 2) + I(3, 4), I(4, 6)},
        {I(1, 2) - I(3, 4), I(-3, -1)},
        {I(max) + I(max), I(max, inf)},
        {I(-max) - I(max), I(-inf, -max)},
        {I(1, inf) + I(-inf, 1), F::entire},
        {F::entire + F::empty, F::empty},
        {F::empty - F::entire, F::empty},
        {-I(1, 2), I(-2, -1)},
        {-F::empty, F::empty},
        {-I(1, inf), I(-inf, -1)},
        {I(0) * F::entire, I(0)},
        {I(0) * I(1, inf), I(0)},
        {I(0, 1) * F::entire, F::entire},
        {I(0, 1) * I(2, inf), I(0, inf)},
        {I(-1, 0) * I(2, inf), I(-inf, 0)},
        {I(1, 2) * I(-inf, -3), I(-inf, -3)},
        {I(-2, 3) * I(-5, 7), I(-15, 21)},
        {I(max) * I(2), I(max, inf)},
        {I(max) * I(-2), I(-inf, -max)},
        {I(tiny) * I(tiny), I(0, tiny)},
        {I(tiny) * I(-tiny), I(-tiny, 0)},
        {I(-tiny, tiny) * I(tiny), I(-tiny, tiny)},
        {I(0, tiny) * I(0, tiny), I(0, tiny)},
        {F::empty * F::entire, F::empty},
        {I(0) * F::empty, F::empty},
        {TypeParam(2) * I(1, 3), I(2, 6)},
        {I(1, 3) * TypeParam(-2), I(-6, -2)},
        {TypeParam(0) * F::entire, I(0)},
        {TypeParam(0) * F::empty, F::empty},
        {TypeParam(-1) * I(1, inf), I(-inf, -1)},
        {fma(I(2, 3), I(4, 5), I(1)), I(9, 16)},
        {fma(I(0), F::entire, I(1, 2)), I(1, 2)},
        {fma(I(1, inf), I(1, inf), I(-inf, 0)), F::entire},
        {fma(I(-inf, -1), I(2), I(0, 1)), I(-inf, -1)},
        {fma(I(max), I(2), I(0)), I(max, inf)},
        {fma(I(1), I(1), F::empty), F::empty},
    });
}

TYPED_TEST(IntervalOf, SquaresAndRoots) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    const auto inf = F::inf;
    expect_all<TypeParam>({
        {sqr(I(-3, 2)), I(0, 9)},
        {sqr(I(-3, -2)), I(4, 9)},
        {sqr(I(F::max)), I(F::max, inf)},
        {sqr(I(F::tiny)), I(0, F::tiny)},
        {sqr(F::entire), I(0, inf)},
        {sqr(I(-inf, -2)), I(4, inf)},
        {sqr(F::empty), F::empty},
        {sqrt(I(4, 9)), I(2, 3)},
        {sqrt(I(-4, 9)), I(0, 3)},
        {sqrt(I(-4, -1)), F::empty},
        {sqrt(I(-4, 0)), I(0)},
        {sqrt(I(0, inf)), I(0, inf)},
        {sqrt(F::entire), I(0, inf)},
        {sqrt(F::empty), F::empty},
    });
}

TYPED_TEST(IntervalOf, SetsAndOrder) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    const auto inf = F::inf;
    expect_all<TypeParam>({
        {hull(I(1, 2), I(4, 5)), I(1, 5)},
        {hull(F::empty, I(4, 5)), I(4, 5)},
        {hull(F::empty, F::empty), F::empty},
        {intersection(I(1, 3), I(2, 5)), I(2, 3)},
        {intersection(I(1, 2), I(2, 5)), I(2)},
        {intersection(I(1, 2), I(3, 5)), F::empty},
        {intersection(F::entire, I(3, 5)), I(3, 5)},
        {intersection(F::empty, F::entire), F::empty},
        {min(I(1, 4), I(2, 3)), I(1, 3)},
        {max(I(1, 4), I(2, 3)), I(2, 4)},
        {min(I(1, inf), I(-inf, 3)), I(-inf, 3)},
        {max(F::empty, I(1)), F::empty},
        {min(I(1), F::empty), F::empty},
        {abs(I(-3, 2)), I(0, 3)},
        {abs(I(-3, -2)), I(2, 3)},
        {abs(F::entire), I(0, inf)},
        {abs(F::empty), F::empty},
    });
    EXPECT_TRUE(certainly_less(I(1, 2), I(3, 4)));
    EXPECT_FALSE(certainly_less(I(1, 3), I(3, 4)));
    EXPECT_TRUE(certainly_positive(I(F::tiny, 1)));
    EXPECT_FALSE(certainly_positive(I(0, 1)));
    EXPECT_TRUE(certainly_negative(I(-1, -F::tiny)));
    EXPECT_FALSE(certainly_negative(I(-1, 0)));
    EXPECT_TRUE(possibly_zero(I(0, 1)));
    EXPECT_FALSE(possibly_zero(I(1, 2)));
    EXPECT_FALSE(possibly_zero(F::empty));
}

TYPED_TEST(IntervalOf, NumbersAboutAnInterval) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    const auto inf = F::inf;
    const auto max = F::max;
    const auto tiny = F::tiny;
    EXPECT_EQ(midpoint(F::entire), 0);
    EXPECT_EQ(midpoint(I(1, inf)), max);
    EXPECT_EQ(midpoint(I(-inf, 1)), -max);
    EXPECT_EQ(midpoint(I(1, 2)), TypeParam(1.5));
    EXPECT_EQ(midpoint(I(-max, max)), 0);
    EXPECT_EQ(midpoint(I(max)), max);
    EXPECT_EQ(midpoint(I(next_down(max), max)), next_down(max));  // a tie, to even
    EXPECT_EQ(midpoint(I(tiny)), tiny);
    EXPECT_EQ(midpoint(I(0, tiny)), 0);  // a tie, to even
    EXPECT_EQ(midpoint(I(tiny, 3 * tiny)), 2 * tiny);
    EXPECT_EQ(radius(I(1, 2)), TypeParam(0.5));
    EXPECT_EQ(radius(I(1, inf)), inf);
    EXPECT_EQ(radius(F::entire), inf);
    EXPECT_EQ(radius(I(0, tiny)), tiny);
    EXPECT_EQ(radius(I(3)), 0);
    EXPECT_EQ(radius(I(-max, max)), max);
    EXPECT_EQ(width(I(1, 2)), 1);
    EXPECT_EQ(width(I(-max, max)), inf);
    EXPECT_EQ(width(I(-tiny, 1)), next_up(TypeParam(1)));
    EXPECT_EQ(width(I(1, inf)), inf);
    EXPECT_EQ(mag(I(-3, 2)), 3);
    EXPECT_EQ(mag(I(-inf, 2)), inf);
    EXPECT_EQ(mig(I(-3, 2)), 0);
    EXPECT_EQ(mig(I(-3, -2)), 2);
    EXPECT_EQ(mig(I(2, inf)), 2);
    for (const TypeParam x :
         {midpoint(F::empty), radius(F::empty), width(F::empty), mag(F::empty), mig(F::empty)}) {
        EXPECT_TRUE(std::isnan(x));
    }
}

TYPED_TEST(IntervalOf, EveryOperationEnclosesAndIsTight) {
    using F = Values<TypeParam>;
    using I = Interval<TypeParam>;
    Adversary<TypeParam> adversary(announced_seed());
    for (int i = 0; i < 60'000; ++i) {
        const I a = adversary.interval();
        const I b = adversary.interval();
        const I c = adversary.interval();
        const auto check = [&](const char* op, const I& bounds, const I& tightest, int steps) {
            ASSERT_TRUE(encloses_within(bounds, tightest, steps))
                << op << ' ' << text(a) << ' ' << text(b) << ' ' << text(c) << " gives "
                << text(bounds) << " for " << text(tightest);
            ASSERT_EQ(is_empty(bounds), bounds == I::empty_set());
        };
        check("+", a + b, tightest_sum(a, b), 0);
        check("-", a - b, tightest_sum(a, -b), 0);
        check("*", a * b, tightest_product(a, b), F::steps);
        check("/", a / b, tightest_quotient(a, b), F::steps);
        check("recip", recip(a), tightest_quotient(I(1), a), F::steps);
        check("sqr", sqr(a), tightest_square(a), F::steps);
        check("sqrt", sqrt(a), tightest_root(a), F::steps);
        check("fma", fma(a, b, c), tightest_fma(a, b, c), F::steps);
        if (std::isfinite(b.lo)) {
            check("s *", b.lo * a, tightest_product(I(b.lo), a), F::steps);
        }
        if (testing::Test::HasFatalFailure()) return;
    }
}

TYPED_TEST(IntervalOf, MidpointRadiusAndWidthAreRoundedAsPromised) {
    using Real = TypeParam;
    using I = Interval<TypeParam>;
    Adversary<Real> adversary(announced_seed());
    for (int i = 0; i < 60'000; ++i) {
        const I a = adversary.interval();
        if (is_empty(a) || std::isinf(a.lo) || std::isinf(a.hi)) continue;
        SCOPED_TRACE(text(a));
        const Real m = midpoint(a);
        const Real r = radius(a);
        const reference::Real lo(a.lo), hi(a.hi), middle(m);
        // The distances of doubles may need more than 256 bits; rounding twice upwards is once.
        const auto up = [](const reference::Real& x, const reference::Real& y) {
            return rounded_to<Real>(reference::rounded(mpfr_sub, MPFR_RNDU, x, y), MPFR_RNDU);
        };
        ASSERT_EQ(width(a), up(hi, lo));
        ASSERT_EQ(r, std::max(up(middle, lo), up(hi, middle)));
        ASSERT_TRUE(contains(a, m));
        // No neighbour of m is nearer to the middle: |2 m' - (lo + hi)| >= |2 m - (lo + hi)|.
        mpfr_t sum, distance, other;
        mpfr_inits2(2200, sum, distance, other, static_cast<mpfr_ptr>(nullptr));
        mpfr_add(sum, lo.raw(), hi.raw(), MPFR_RNDN);
        const auto distance_of = [&](mpfr_ptr result, Real x) {
            mpfr_set_d(result, static_cast<double>(x), MPFR_RNDN);
            mpfr_mul_2si(result, result, 1, MPFR_RNDN);
            mpfr_sub(result, result, sum, MPFR_RNDN);
        };
        distance_of(distance, m);
        for (const Real neighbour : {next_down(m), next_up(m)}) {
            distance_of(other, neighbour);
            EXPECT_LE(mpfr_cmpabs(distance, other), 0);
        }
        mpfr_clears(sum, distance, other, static_cast<mpfr_ptr>(nullptr));
        if (testing::Test::HasFailure()) return;
    }
}

TYPED_TEST(IntervalOf, AssigningOperatorsAreTheOperators) {
    using I = Interval<TypeParam>;
    I a(1, 2);
    EXPECT_EQ(a += I(3, 4), I(4, 6));
    EXPECT_EQ(a -= I(1), I(3, 5));
    EXPECT_EQ(a *= I(2), I(6, 10));
    EXPECT_EQ(a /= I(2), I(3, 5));
}

}  // namespace
}  // namespace ivory::test
