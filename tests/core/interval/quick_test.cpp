// The quick operations hold every exact result of their operands' members, and nearly nothing more.
#include "core/interval/quick.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/core/interval/adversary.h"
#include "tests/reference/multiprecision.h"

namespace ivory::test {
namespace {

using reference::Real;
using reference::rounded;

// Members of an interval: its finite ends, the middle, the ones next to the ends, huge ones where
// an end is infinite.
std::array<double, 6> members(const Interval<double>& a, Adversary<double>& adversary) {
    const double lo = std::max(a.lo, -largest<double>), hi = std::min(a.hi, largest<double>);
    const double middle = midpoint(Interval<double>(lo, hi));
    const double part = adversary.uniform();
    const double between = std::min(std::max(lo * (1 - part) + hi * part, lo), hi);
    return {lo, hi, middle, between, std::min(next_up(lo), hi), std::max(next_down(hi), lo)};
}

void expect_holds(const Interval<double>& bounds, const Real& exact) {
    ASSERT_FALSE(std::isnan(bounds.lo) || std::isnan(bounds.hi)) << text(bounds);
    ASSERT_TRUE(Real(bounds.lo) <= exact && exact <= Real(bounds.hi))
        << text(bounds) << " does not hold " << to_string(exact);
}

// 4 units in the last place of each finite end, and 2^-1068 where they underflow.
void expect_tight(const Interval<double>& bounds, const Interval<double>& exact) {
    const auto near = [](double bound, double end) {
        return std::isinf(bound) ? std::abs(end) > 0.999 * largest<double>
                                 : std::abs(bound - end) <= std::abs(end) * 0x1p-50 + 0x1p-1068;
    };
    ASSERT_TRUE(near(bounds.lo, exact.lo) && near(bounds.hi, exact.hi))
        << text(bounds) << " is wider than " << text(exact);
}

// Not empty, with any ends at all.
Interval<double> operand(Adversary<double>& adversary) {
    for (;;) {
        Interval<double> a = adversary.interval();
        if (is_empty(a)) continue;
        if (a.lo == infinity<double> || a.hi == -infinity<double>) continue;  // holds no number
        return a;
    }
}

class QuickOperations : public testing::Test {
  protected:
    template <class Check>
    void for_pairs(const Check& check) {
        Adversary<double> adversary(announced_seed());
        for (int i = 0; i < 30'000; ++i) {
            const Interval<double> a = operand(adversary), b = operand(adversary);
            SCOPED_TRACE(text(a) + ' ' + text(b));
            check(a, b, adversary);
            if (testing::Test::HasFatalFailure()) return;
        }
    }
};

TEST_F(QuickOperations, SumsAndDifferencesHoldThoseOfAllMembers) {
    for_pairs([](const auto& a, const auto& b, auto& adversary) {
        const Interval<double> sum = quick::add(a, b), difference = quick::sub(a, b);
        for (const double x : members(a, adversary)) {
            for (const double y : members(b, adversary)) {
                ASSERT_NO_FATAL_FAILURE(
                    expect_holds(sum, rounded(mpfr_add, MPFR_RNDN, Real(x), Real(y))));
                ASSERT_NO_FATAL_FAILURE(
                    expect_holds(difference, rounded(mpfr_sub, MPFR_RNDN, Real(x), Real(y))));
            }
        }
        expect_tight(sum, a + b);
        expect_tight(difference, a - b);
    });
}

TEST_F(QuickOperations, ProductsHoldThoseOfAllMembers) {
    for_pairs([](const auto& a, const auto& b, auto& adversary) {
        const Interval<double> product = quick::mul(a, b);
        for (const double x : members(a, adversary)) {
            for (const double y : members(b, adversary)) {
                ASSERT_NO_FATAL_FAILURE(
                    expect_holds(product, rounded(mpfr_mul, MPFR_RNDN, Real(x), Real(y))));
            }
        }
        expect_tight(product, a * b);
    });
}

TEST_F(QuickOperations, MultiplesHoldThoseOfAllMembers) {
    for_pairs([](const auto& a, const auto& b, auto& adversary) {
        const double s = mig(b);
        if (s == infinity<double>) return;
        const Interval<double> multiple = quick::scale(s, a);
        for (const double x : members(a, adversary)) {
            ASSERT_NO_FATAL_FAILURE(
                expect_holds(multiple, rounded(mpfr_mul, MPFR_RNDN, Real(s), Real(x))));
        }
        expect_tight(multiple, s * a);
    });
}

// The quotient of 256 bits is rounded to nearest, far finer than the bounds' own steps.
TEST_F(QuickOperations, QuotientsByPositiveNumbersHoldThoseOfAllMembers) {
    for_pairs([](const auto& a, const auto& b, auto& adversary) {
        const Interval<double> divisor{mig(b), mag(b)};
        if (!(divisor.lo > 0)) return;
        const Interval<double> quotient = quick::div(a, divisor);
        for (const double x : members(a, adversary)) {
            for (const double y : members(divisor, adversary)) {
                ASSERT_NO_FATAL_FAILURE(
                    expect_holds(quotient, rounded(mpfr_div, MPFR_RNDN, Real(x), Real(y))));
            }
        }
        expect_tight(quotient, a / divisor);
    });
}

TEST_F(QuickOperations, SquaresAndRootsHoldThoseOfAllMembers) {
    for_pairs([](const auto& a, const auto& b, auto& adversary) {
        const Interval<double> square = quick::sqr(a);
        EXPECT_GE(square.lo, 0);
        for (const double x : members(a, adversary)) {
            ASSERT_NO_FATAL_FAILURE(expect_holds(square, rounded(mpfr_sqr, MPFR_RNDN, Real(x))));
        }
        expect_tight(square, sqr(a));
        if (b.hi < 0) return;
        const Interval<double> root = quick::sqrt(b);
        EXPECT_GE(root.lo, 0);
        for (const double x : members(b, adversary)) {
            if (x < 0) continue;
            ASSERT_NO_FATAL_FAILURE(expect_holds(root, rounded(mpfr_sqrt, MPFR_RNDN, Real(x))));
        }
        expect_tight(root, sqrt(b));
    });
}

TEST(Quick, SteppedNumbersLieOnTheirSideOfWhatRoundedToThem) {
    Adversary<double> adversary(announced_seed());
    for (int i = 0; i < 100'000; ++i) {
        const double x = adversary.number();
        if (std::isinf(x)) continue;
        ASSERT_LT(quick::down(x), x);
        ASSERT_GT(quick::up(x), x);
        ASSERT_LE(quick::down(x), next_down(x));
        ASSERT_GE(quick::up(x), next_up(x));
    }
}

TEST(Quick, ZeroTimesInfinityIsZero) {
    const Interval<double> zero(0.0), all = Interval<double>::entire();
    const Interval<double> half{0.0, infinity<double>};
    for (const Interval<double>& a : {all, half, -half}) {
        for (const Interval<double>& product :
             {quick::mul(zero, a), quick::mul(a, zero), quick::scale(0, a), quick::mul(-zero, a)}) {
            EXPECT_LE(product.lo, 0);
            EXPECT_GE(product.hi, 0);
            EXPECT_LE(width(product), 0x1p-1068);
        }
    }
}

TEST(Quick, InfiniteEndsStayAndTheOtherEndKeepsItsBound) {
    const Interval<double> from_two{2.0, infinity<double>}, to_two{-infinity<double>, 2.0};
    const Interval<double> three(3.0);
    const auto expect = [](const Interval<double>& bounds, double lo, double hi) {
        SCOPED_TRACE(text(bounds));
        EXPECT_FALSE(std::isnan(bounds.lo) || std::isnan(bounds.hi));
        if (std::isinf(lo)) {
            EXPECT_EQ(bounds.lo, lo);
        } else {
            EXPECT_NEAR(bounds.lo, lo, 1e-14);
        }
        if (std::isinf(hi)) {
            EXPECT_EQ(bounds.hi, hi);
        } else {
            EXPECT_NEAR(bounds.hi, hi, 1e-14);
        }
    };
    constexpr double inf = infinity<double>;
    expect(quick::add(from_two, three), 5, inf);
    expect(quick::add(from_two, to_two), -inf, inf);
    expect(quick::sub(from_two, from_two), -inf, inf);
    expect(quick::sub(three, from_two), -inf, 1);
    expect(quick::mul(from_two, -three), -inf, -6);
    expect(quick::mul(from_two, to_two), -inf, inf);
    expect(quick::div(from_two, three), 2.0 / 3, inf);
    expect(quick::div(three, from_two), 0, 1.5);
    expect(quick::div(to_two, from_two), -inf, 1);
    expect(quick::sqr(to_two), 0, inf);
    expect(quick::sqr(from_two), 4, inf);
    expect(quick::sqrt(from_two), std::sqrt(2), inf);
}

}  // namespace
}  // namespace ivory::test
