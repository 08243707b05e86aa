// Integer powers against MPFR, small exponents and the greatest ones.
#include "core/interval/power.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/core/interval/adversary.h"
#include "tests/core/interval/tightest.h"

namespace ivory::test {
namespace {

template <class Real>
class Power : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Power, Reals);

TYPED_TEST(Power, CasesOfTheDomain) {
    using I = Interval<TypeParam>;
    constexpr TypeParam inf = infinity<TypeParam>;
    const I empty = I::empty_set();
    const I entire = I::entire();
    EXPECT_EQ(pown(entire, 0), I(1));
    EXPECT_EQ(pown(I(0), 0), I(1));
    EXPECT_EQ(pown(empty, 0), empty);
    EXPECT_EQ(pown(empty, -3), empty);
    EXPECT_EQ(pown(I(-3, 2), 1), I(-3, 2));
    EXPECT_EQ(pown(I(-3, 2), 2), I(0, 9));
    EXPECT_EQ(pown(I(-3, 2), 3), I(-27, 8));
    EXPECT_EQ(pown(I(-3, 2), 4), I(0, 81));
    EXPECT_EQ(pown(I(-3, -2), 4), I(16, 81));
    EXPECT_EQ(pown(I(-3, -2), 3), I(-27, -8));
    EXPECT_EQ(pown(entire, 3), entire);
    EXPECT_EQ(pown(entire, 4), I(0, inf));
    EXPECT_EQ(pown(I(0), -1), empty);
    EXPECT_EQ(pown(I(0), -2), empty);
    EXPECT_EQ(pown(I(0), -3), empty);
    EXPECT_EQ(pown(I(-1, 1), -3), entire);
    EXPECT_EQ(pown(I(-1, 1), -2), I(1, inf));
    EXPECT_EQ(pown(I(0, 2), -3), I(TypeParam(0.125), inf));
    EXPECT_EQ(pown(I(-2, 0), -3), I(-inf, TypeParam(-0.125)));
    EXPECT_EQ(pown(I(-2, 0), -4), I(TypeParam(0.0625), inf));
    EXPECT_EQ(pown(I(2, inf), -3), I(0, TypeParam(0.125)));
    EXPECT_EQ(pown(I(-inf, -2), -3), I(TypeParam(-0.125), 0));
    EXPECT_EQ(pown(entire, -3), entire);
    EXPECT_EQ(pown(entire, -4), I(0, inf));
    EXPECT_EQ(pown(I(2), std::numeric_limits<int>::max()), I(largest<TypeParam>, inf));
    EXPECT_EQ(pown(I(2), std::numeric_limits<int>::min()), I(0, smallest<TypeParam>));
    EXPECT_EQ(pown(I(-2), std::numeric_limits<int>::max()), I(-inf, -largest<TypeParam>));
    EXPECT_EQ(pown(I(-1), std::numeric_limits<int>::min()), I(1));
}

TYPED_TEST(Power, EnclosesAndIsTight) {
    using Real = TypeParam;
    Adversary<Real> adversary(announced_seed());
    constexpr std::array<int, 10> large{100,
                                        -101,
                                        1000,
                                        -1023,
                                        65536,
                                        -99999,
                                        123456789,
                                        -987654321,
                                        std::numeric_limits<int>::max(),
                                        std::numeric_limits<int>::min()};
    for (int i = 0; i < 60'000; ++i) {
        Interval<Real> a = adversary.interval();
        int n = static_cast<int>(adversary.below(41)) - 20;
        if (adversary.below(3) == 0) {
            // Near 1, where large powers stay finite.
            n = large[adversary.below(large.size())];
            const Real spread = static_cast<Real>(100 / std::abs(static_cast<double>(n)));
            const Real lo = 1 + spread * (adversary.uniform() - Real(0.5));
            a = {lo, lo + spread * adversary.uniform()};
            if (adversary.below(2) == 0) a = -a;
        }
        const Interval<Real> bounds = pown(a, n);
        ASSERT_TRUE(encloses_within(bounds, tightest_power(a, n), 1))
            << text(a) << " to the " << n << " gives " << text(bounds) << " for "
            << text(tightest_power(a, n));
    }
}

}  // namespace
}  // namespace ivory::test
