// The kernels and their derivatives against 256 bits, the seams at s = 1/9 and s = 1 above all.
#include "core/kernel/kernels.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/reference/along_ray.h"
#include "tests/reference/multiprecision.h"
#include "tests/tools/kinds.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using reference::RealInterval;
using tools::Random;

// The reference holds the exact value in [exact]; the bounds hold it too where both meet.
void expect_meets(const Interval<double>& bounds, const RealInterval& exact) {
    EXPECT_TRUE(Real(bounds.lo) <= exact.hi && exact.lo <= Real(bounds.hi))
        << '[' << bounds.lo << ", " << bounds.hi << "] misses " << to_string(exact.lo) << " .. "
        << to_string(exact.hi);
}

void expect_inside(const RealInterval& exact, const Interval<double>& bounds) {
    EXPECT_TRUE(Real(bounds.lo) <= exact.lo && exact.hi <= Real(bounds.hi))
        << '[' << bounds.lo << ", " << bounds.hi << "] does not hold " << to_string(exact.lo)
        << " .. " << to_string(exact.hi);
}

// k'' next to s on its right, by the reference's k' at s and at s + 2^-90: by the mean value theorem
// it has just that value in between. No double but the seams themselves has a seam so near.
RealInterval exact_bend(KernelKind kind, double s) {
    const RealInterval step = RealInterval::of(1, -90);
    const auto slope = [&](const RealInterval& x) { return reference::kernel_germ(kind, x).slope; };
    const RealInterval bend = (slope(RealInterval(s) + step) - slope(RealInterval(s))) / step;
    // What k'' may change by on so short a way: |k'''| <= 274.
    return bend * RealInterval(Real(1 - 0x1p-50), Real(1 + 0x1p-50)) +
           RealInterval(Real(-0x1p-80), Real(0x1p-80));
}

// Doubles on both sides of every place where a formula changes, 0, and ordinary ones.
std::vector<double> places(Random& random) {
    std::vector<double> s{0, smallest<double>, 1e-300, 1e-20, 599.9, 600, 600.1, 745, 1e6, 1e300};
    for (const double seam : {1.0 / 9, 1.0, 11.0 / 6, 9.0 / 4}) {
        double below = seam, above = seam;
        s.push_back(seam);
        for (int step = 0; step < 8; ++step) {
            s.push_back(below = next_down(below));
            s.push_back(above = next_up(above));
        }
        for (int power = 2; power <= 15; ++power) {
            const double off = std::pow(10, -power) * random.uniform(0.5, 2);
            s.push_back(seam * (1 - off));
            s.push_back(seam * (1 + off));
        }
    }
    for (int i = 0; i < 600; ++i) {
        s.push_back(random.uniform(0, 1.2));
        s.push_back(std::exp(random.uniform(-40, 7)));
    }
    return s;
}

class Kernel : public testing::TestWithParam<KernelKind> {};
INSTANTIATE_TEST_SUITE_P(Each, Kernel, testing::ValuesIn(tools::every_kernel), tools::name_of_kind);

TEST_P(Kernel, ValueAndSlopeAtADoubleHoldTheExactOnesWithinAFewUnits) {
    Random random(tools::announced_seed(11));
    for (const double s : places(random)) {
        SCOPED_TRACE(s);
        const auto exact = reference::kernel_germ(GetParam(), RealInterval(s));
        const Interval<double> k = kernel_at(GetParam(), s), dk = kernel_slope_at(GetParam(), s);
        expect_inside(exact.value, k);
        expect_inside(exact.slope, dk);
        EXPECT_GE(k.lo, 0);
        EXPECT_LE(k.hi, 1);
        EXPECT_LE(dk.hi, 0);
        // Nishimura's factor 1 - q cancels near the rim, where its error is q's.
        const double rim = GetParam() == KernelKind::nishimura ? 0x1p-47 : 0;
        if (s <= 600) {
            EXPECT_LE(width(k), 0x1p-46 * k.hi + rim * std::sqrt(k.hi) + 1e-29);
            EXPECT_LE(width(dk), 0x1p-46 * -dk.lo + rim);
        } else {
            EXPECT_LE(k.hi, 1e-259);
        }
    }
}

TEST_P(Kernel, RangeHoldsValueAndDerivativesOfAllMembers) {
    Random random(tools::announced_seed(12));
    const std::vector<double> ends = places(random);
    for (int i = 0; i < 1500; ++i) {
        const double a = ends[random.below(ends.size())];
        double b = random.chance(0.3) ? ends[random.below(ends.size())]
                                      : a * (1 + std::exp(random.uniform(-36, 1)));
        if (random.chance(0.05)) b = infinity<double>;
        Interval<double> s{std::min(a, b), std::max(a, b)};
        if (random.chance(0.1)) s.lo = -1e-17;  // rounding below 0
        SCOPED_TRACE(std::to_string(s.lo) + " .. " + std::to_string(s.hi));
        const KernelRange range = kernel_range(GetParam(), s);
        const Interval<double> over = kernel_over(GetParam(), s);
        EXPECT_EQ(over.lo, range.k.lo);
        EXPECT_EQ(over.hi, range.k.hi);
        const double from = std::max(s.lo, 0.0), to = std::min(s.hi, from + 3);
        for (const double x : {from, to, std::min(random.uniform(from, to), to)}) {
            if (x > s.hi) continue;
            SCOPED_TRACE(x);
            const auto exact = reference::kernel_germ(GetParam(), RealInterval(x));
            expect_inside(exact.value, range.k);
            expect_inside(exact.slope, range.dk);
            if (x != 1) expect_meets(range.ddk, exact_bend(GetParam(), x));
        }
    }
}

TEST_P(Kernel, RangeHoldsBothOneSidedSecondDerivativesAtASeam) {
    for (const double seam : {1.0 / 9, 1.0}) {
        for (const double off : {0.0, 1e-15, 1e-12, 1e-6, 1e-3}) {
            SCOPED_TRACE(std::to_string(seam) + " +- " + std::to_string(off));
            const KernelRange range =
                kernel_range(GetParam(), {seam * (1 - off), seam * (1 + off)});
            const double before = seam * (1 - off - 1e-13), after = seam * (1 + off + 1e-13);
            const auto meets = [&](const RealInterval& exact) {
                // |k'''| <= 274
                expect_meets(range.ddk, exact + RealInterval(Real(-3e-11), Real(3e-11)));
            };
            meets(exact_bend(GetParam(), before));
            meets(exact_bend(GetParam(), after));
        }
    }
}

TEST_P(Kernel, RangesOverThinIntervalsAreThin) {
    Random random(tools::announced_seed(13));
    for (int i = 0; i < 500; ++i) {
        const double s = random.uniform(0.001, 1.5), off = 1e-9;
        const bool at_seam = std::abs(9 * s - 1) < 1e-6 || std::abs(s - 1) < 1e-6;
        const KernelRange range = kernel_range(GetParam(), {s, s + off});
        SCOPED_TRACE(s);
        EXPECT_LE(width(range.k), 4 * off);    // |k'| <= 3
        EXPECT_LE(width(range.dk), 30 * off);  // |k''| <= 81/4
        if (!at_seam) {
            EXPECT_LE(width(range.ddk), 300 * off);  // |k'''| <= 274
        }
    }
}

TEST(ExpMinus, HoldsExpOfEverySWithinTheRadius) {
    Random random(tools::announced_seed(14));
    for (int i = 0; i < 4000; ++i) {
        const double s = random.chance(0.1) ? 0 : std::exp(random.uniform(-40, 6.7));
        const double radius =
            random.chance(0.2) ? 0 : std::exp(random.uniform(-40, random.chance(0.1) ? 4 : -1.4));
        SCOPED_TRACE(std::to_string(s) + " +- " + std::to_string(radius));
        const Interval<double> e = exp_minus(s, radius);
        const RealInterval around = RealInterval(s) + RealInterval(Real(-radius), Real(radius));
        const Real least = around.lo < Real(0.0) ? Real(0.0) : around.lo;
        const RealInterval high = exp(-RealInterval(least)), low = exp(-RealInterval(around.hi));
        expect_inside(high, e);
        expect_inside(low, e);
        EXPECT_GE(e.lo, 0);
        EXPECT_LE(e.hi, 1);
        if (s <= 600 && radius <= 0.25) {
            EXPECT_LE(width(e), std::exp(-s) * (2.3 * radius + 0x1p-48) * 1.001);
        }
    }
}

}  // namespace
}  // namespace ivory
