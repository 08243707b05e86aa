// Numbers and intervals that are hard on an arithmetic, and the seed that makes them again.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <random>
#include <string>

#include "core/interval/interval.h"

namespace ivory::test {

// Of IVORY_SEED, or a new one; printed, so that a failure can be repeated.
inline std::uint64_t announced_seed() {
    const char* given = std::getenv("IVORY_SEED");
    const std::uint64_t seed =
        given != nullptr ? std::strtoull(given, nullptr, 0) : std::random_device{}();
    std::cout << "IVORY_SEED=" << seed << '\n';
    return seed;
}

template <IeeeReal Real>
class Adversary {
  public:
    explicit Adversary(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t below(std::uint64_t count) { return engine_() % count; }

    // Finite, or infinite now and then.
    Real number() {
        using Limits = std::numeric_limits<Real>;
        static constexpr std::array<Real, 12> special{
            0,           Real(-0.0),        smallest<Real>, Limits::min(), largest<Real>,  1,
            Real(1) / 3, Limits::epsilon(), infinity<Real>, Real(0x1p100), Real(0x1p-100), 3};
        Real x = 0;
        switch (below(10)) {
            case 0:
                x = any_bits();
                break;
            case 1:
                x = special[below(special.size())];
                break;
            case 2:
                x = next_up(special[below(special.size())]);
                break;
            case 3:
                x = next_down(special[below(special.size())]);
                break;
            case 4:
                x = static_cast<Real>(below(64)) / 8;
                break;
            case 5:
                x = any_bits() * Limits::min();
                break;  // many subnormal, many 0
            case 6:
                x = largest<Real> * uniform();
                break;
            case 7:
                x = std::ldexp(Real(1), static_cast<int>(below(80)) - 40);
                break;
            case 8:
                x = with_few_bits();
                break;
            default:
                x = 4 * uniform();
                break;
        }
        return below(2) == 0 ? x : -x;
    }

    Interval<Real> interval() {
        Real x = number();
        Real y = number();
        switch (below(12)) {
            case 0:
                return below(8) == 0 ? Interval<Real>::empty_set() : Interval<Real>::entire();
            case 1:
                y = next_up(x);
                break;
            case 2:
                y = x;
                break;
            case 3:
                y = -x;
                break;
            case 4:
                y = 0;
                break;
            case 5:
                y = infinity<Real>;
                break;
            case 6:
                y = -infinity<Real>;
                break;
            default:
                break;
        }
        if (std::isinf(x) && std::isinf(y)) y = 1;
        return {std::min(x, y), std::max(x, y)};
    }

    // In [1, 2), the low bits cleared, so that products and quotients are exact or nearly so.
    Real with_few_bits() {
        constexpr int digits = std::numeric_limits<Real>::digits;
        const Real unit = std::ldexp(Real(1), static_cast<int>(below(digits)) - digits + 1);
        return 1 + unit * std::floor(uniform() / unit);
    }

    Real uniform() { return static_cast<Real>(static_cast<double>(engine_() >> 11) * 0x1p-53); }

  private:
    Real any_bits() {
        using Bits = std::conditional_t<std::same_as<Real, float>, std::uint32_t, std::uint64_t>;
        const Real x = std::bit_cast<Real>(static_cast<Bits>(engine_()));
        return std::isnan(x) ? Real(1.5) : x;
    }

    std::mt19937_64 engine_;
};

template <IeeeReal Real>
std::string text(const Interval<Real>& a) {
    std::array<char, 96> line{};
    std::snprintf(line.data(), line.size(), "[%a, %a]", static_cast<double>(a.lo),
                  static_cast<double>(a.hi));
    return line.data();
}

// Whether `bounds` holds the tightest enclosure and each end is at most `steps` numbers outside it.
template <IeeeReal Real>
bool encloses_within(const Interval<Real>& bounds, Interval<Real> tightest, int steps) {
    if (is_empty(tightest) || is_empty(bounds)) return is_empty(tightest) && is_empty(bounds);
    if (!is_subset(tightest, bounds)) return false;
    for (int i = 0; i < steps; ++i) {
        tightest = {next_down(tightest.lo), next_up(tightest.hi)};
    }
    return is_subset(bounds, tightest);
}

}  // namespace ivory::test
