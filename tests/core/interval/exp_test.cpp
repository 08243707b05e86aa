// exp against MPFR: 10^7 doubles, a sample of the floats (tests/tools/exp_exhaustive has them all).
#include "core/interval/exp.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "tests/core/interval/adversary.h"
#include "tests/core/interval/exp_oracle.h"
#include "tests/core/interval/tightest.h"

namespace ivory::test {
namespace {

template <class Real>
class Exp : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Exp, Reals);

TYPED_TEST(Exp, CasesOfTheDomain) {
    using Real = TypeParam;
    using I = Interval<Real>;
    constexpr Real inf = infinity<Real>;
    EXPECT_EQ(exp(I(0)), I(1));
    EXPECT_EQ(exp(I(Real(-0.0))), I(1));
    EXPECT_EQ(exp(I::empty_set()), I::empty_set());
    EXPECT_EQ(exp(I::entire()), I(0, inf));
    EXPECT_EQ(exp(I(-inf, 0)), I(0, 1));
    EXPECT_EQ(exp(I(0, inf)), I(1, inf));
    EXPECT_EQ(exp(I(1000)), I(largest<Real>, inf));
    EXPECT_EQ(exp(I(largest<Real>)), I(largest<Real>, inf));
    EXPECT_EQ(exp(I(-1000)), I(0, smallest<Real>));
    EXPECT_EQ(exp(I(-largest<Real>)), I(0, smallest<Real>));
    EXPECT_EQ(exp(I(-inf, -1000)), I(0, smallest<Real>));
    EXPECT_EQ(exp(I(Real(0x1p-70))), I(1, next_up(Real(1))));
    EXPECT_EQ(exp(I(Real(-0x1p-70))), I(next_down(Real(1)), 1));
}

TYPED_TEST(Exp, IntervalsAreEnclosedByTheirEnds) {
    using Real = TypeParam;
    Adversary<Real> adversary(announced_seed());
    for (int i = 0; i < 20'000; ++i) {
        const Interval<Real> a = adversary.interval();
        ASSERT_TRUE(encloses_within(exp(a), tightest_exp(a), 1)) << text(a) << ' ' << text(exp(a));
    }
}

TYPED_TEST(Exp, NearestIsExactAtZeroAndFlatOutsideItsRange) {
    using Real = TypeParam;
    constexpr Real least = ExpConstants<Real>::least;
    constexpr Real greatest = ExpConstants<Real>::greatest;
    EXPECT_EQ(exp_nearest(Real(0)), 1);
    EXPECT_EQ(exp_nearest(Real(-0.0)), 1);
    EXPECT_EQ(exp_nearest(next_down(least)), 0);
    EXPECT_EQ(exp_nearest(-infinity<Real>), 0);
    EXPECT_GT(exp_nearest(least), 0);
    EXPECT_EQ(exp_nearest(infinity<Real>), exp_nearest(greatest));
    EXPECT_LT(exp_nearest(greatest), infinity<Real>);
    static_assert(exp_nearest(Real(0)) == 1);
}

// (2), (3) and (4) of the proof in exp.h, as powers of two.
template <class Real>
struct Claims;
template <>
struct Claims<double> {
    static constexpr double unit_of_l1 = 0x1p-42;
    static constexpr double ln2_rest = 0x1p-102;
    static constexpr double l2 = 0x1p-44;
    static constexpr double log2_of_series = -59.9;
};
template <>
struct Claims<float> {
    static constexpr double unit_of_l1 = 0x1p-17;
    static constexpr double ln2_rest = 0x1p-44;
    static constexpr double l2 = 0x1p-19;
    static constexpr double log2_of_series = -30.7;
};

TYPED_TEST(Exp, ConstantsAreAsTheProofHasThem) {
    using C = ExpConstants<TypeParam>;
    using Claim = Claims<TypeParam>;
    using reference::RealInterval;
    const double l1 = C::ln2_high;
    const double l2 = C::ln2_low;
    EXPECT_EQ(l1 / Claim::unit_of_l1, std::floor(l1 / Claim::unit_of_l1));
    EXPECT_LT(l2, Claim::l2);
    reference::Real ln2;
    mpfr_const_log2(ln2.raw(), MPFR_RNDN);
    const RealInterval rest = RealInterval(ln2) - RealInterval(l1) - RealInterval(l2);
    EXPECT_LT(std::abs(rest.lo.to_double()), Claim::ln2_rest);
    const double inverse = C::inverse_of_ln2;
    EXPECT_LE(std::abs((RealInterval(inverse) * RealInterval(ln2)).lo.to_double() - 1),
              std::numeric_limits<TypeParam>::epsilon() / 2);
}

TYPED_TEST(Exp, SeriesIsWithinItsBound) {
    using reference::RealInterval;
    constexpr double h = 0.3466;
    const double bound = std::exp2(Claims<TypeParam>::log2_of_series);
    for (int i = -2000; i <= 2000; ++i) {
        const double r = h * i / 2000;
        const RealInterval x(r);
        const RealInterval tail = exp_tail<TypeParam, RealInterval>(x, x * x);
        const RealInterval series = RealInterval(1.0) + x + RealInterval(0.5) * (x * x) + tail;
        const double off = std::abs((series - reference::exp(x)).lo.to_double());
        ASSERT_LE(off, std::pow(std::abs(r / h), 3) * bound + 0x1p-200) << r;
    }
}

// (7) and (8) of the proof in exp.h.
TYPED_TEST(Exp, SeriesOfPowersOfTwoIsWithinItsBound) {
    using reference::RealInterval;
    reference::Real ln2;
    mpfr_const_log2(ln2.raw(), MPFR_RNDN);
    const double bound = std::same_as<TypeParam, double> ? std::exp2(-54.4) : 0x1p-26;
    for (int i = -2000; i <= 2000; ++i) {
        const double r = 0.5 * i / 2000;
        const RealInterval x(r);
        const RealInterval series = exp2_series<TypeParam, RealInterval>(x);
        const RealInterval exact = reference::exp(RealInterval(-r) * RealInterval(ln2));
        const double off = std::abs((series - exact).lo.to_double());
        ASSERT_LE(off, std::abs(r) * bound + 0x1p-200) << r;
    }
}

TYPED_TEST(Exp, PowersOfTwoAreWithinTheirBound) {
    using Real = TypeParam;
    Adversary<Real> adversary(announced_seed());
    constexpr Real greatest = Exp2Constants<Real>::greatest;
    EXPECT_EQ(exp2_minus(Real(0)), 1);
    EXPECT_EQ(exp2_minus(greatest), std::ldexp(Real(1), -static_cast<int>(greatest)));
    EXPECT_EQ(exp2_minus(infinity<Real>), exp2_minus(greatest));
    static_assert(exp2_minus(Real(3)) == Real(0.125));
    mpfr_t exact, off;
    mpfr_init2(exact, 120);
    mpfr_init2(off, 120);
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        // anywhere; near the halves, where the reduction turns over; tiny
        const double u = adversary.uniform();
        const auto halves = static_cast<Real>(0.5 * static_cast<double>(adversary.below(240)));
        const std::uint64_t kind = adversary.below(4);
        const Real x =
            kind == 0   ? static_cast<Real>(u) * greatest
            : kind == 1 ? static_cast<Real>(u)
            : kind == 2 ? std::abs(halves + static_cast<Real>(0x1p-20 * (u - 0.5)))
                        : static_cast<Real>(std::ldexp(u, -static_cast<int>(adversary.below(100))));
        mpfr_set_d(exact, -static_cast<double>(x), MPFR_RNDN);
        mpfr_exp2(exact, exact, MPFR_RNDN);
        mpfr_set_d(off, static_cast<double>(exp2_minus(x)), MPFR_RNDN);
        mpfr_sub(off, off, exact, MPFR_RNDN);
        mpfr_div(off, off, exact, MPFR_RNDN);
        const double relative = std::abs(mpfr_get_d(off, MPFR_RNDN));
        ASSERT_LE(relative, exp_relative_error<Real>) << x;
        worst = std::max(worst, relative / std::numeric_limits<Real>::epsilon());
    }
    mpfr_clear(exact);
    mpfr_clear(off);
    std::cout << "off by " << worst << " epsilon at most\n";
}

// Uniform, near multiples of ln 2 / 2 where the reduction turns over, near overflow and underflow,
// tiny, short, and with any bits.
double adversarial_argument(Adversary<double>& adversary) {
    const double sign = adversary.below(2) == 0 ? 1 : -1;
    const double u = adversary.uniform();
    switch (adversary.below(8)) {
        case 0:
            return sign * 1.5 * u;
        case 1: {
            const double halves = static_cast<double>(adversary.below(2200)) - 1100;
            const double turn = halves * (std::log(2.0) / 2);
            const auto off = static_cast<double>(adversary.below(33)) - 16;
            return turn + off * (next_up(std::abs(turn)) - std::abs(turn));
        }
        case 2:
            return 709.782712893384 + sign * u * 1e-12;
        case 3:
            return -745.2 + 38 * u;
        case 4:
            return sign * std::ldexp(1 + u, -static_cast<int>(adversary.below(120)));
        case 5:
            return sign * static_cast<double>(adversary.below(800 * 16)) / 16;
        case 6: {
            const double x = adversary.number();
            return std::isfinite(x) ? x : smallest<double>;
        }
        default:
            return -745 + 1455 * u;
    }
}

TEST(ExpOfDouble, TenMillionArguments) {
    constexpr std::int64_t pairs = 5'000'000;  // x and -x
    const std::uint64_t seed = announced_seed();
    const unsigned workers = std::max(1U, std::thread::hardware_concurrency());
    std::vector<ExpFindings> findings(workers);
    std::vector<std::thread> threads;
    for (unsigned worker = 0; worker < workers; ++worker) {
        threads.emplace_back([&, worker] {
            ExpOracle oracle;
            Adversary<double> adversary(seed + worker);
            for (std::int64_t i = worker; i < pairs; i += workers) {
                oracle.check(adversarial_argument(adversary), findings[worker]);
            }
            mpfr_free_cache();
        });
    }
    for (std::thread& thread : threads) thread.join();
    ExpFindings all;
    for (const ExpFindings& found : findings) all += found;
    EXPECT_EQ(all.faults, 0) << all.first_fault;
    EXPECT_GE(all.checked, 10'000'000);
    std::cout << all.checked << " arguments, " << all.tightest
              << " tightest ends, exp_nearest off by " << all.worst_nearest << " epsilon at most\n";
}

TEST(ExpOfFloat, ASampleOfTheFloats) {
    ExpOracle oracle;
    ExpFindings all;
    Adversary<float> adversary(announced_seed());
    for (int i = 0; i < 500'000; ++i) {
        // Uniform in the bits from 2^-25 to 104.
        const std::uint64_t first = std::bit_cast<std::uint32_t>(0x1p-25f);
        const std::uint64_t last = std::bit_cast<std::uint32_t>(104.0f);
        const auto bits = static_cast<std::uint32_t>(first + adversary.below(last - first + 1));
        oracle.check(std::bit_cast<float>(bits), all);
    }
    for (int i = 0; i < 100'000; ++i) {
        const float x = adversary.number();
        if (std::isfinite(x)) oracle.check(x, all);
    }
    EXPECT_EQ(all.faults, 0) << all.first_fault;
    std::cout << all.checked << " arguments, " << all.tightest
              << " tightest ends, exp_nearest off by " << all.worst_nearest << " epsilon at most\n";
}

}  // namespace
}  // namespace ivory::test
