// Arithmetic of the reference: binary floating point of 256 bits or, where a referee asks for them,
// more (GNU MPFR), and closed intervals of it whose ends are rounded outward by MPFR's own directed
// rounding. Shares nothing with core.
#pragma once

#include <mpfr.h>

#include <compare>
#include <string>
#include <utility>

namespace ivory::reference {

// Bits of every number that this thread makes, 256 or more: doubles convert exactly, the product of
// two doubles is exact.
inline constexpr long least_bits = 256;
inline thread_local long working_bits = least_bits;

// More of them while it lives.
class WithBits {
  public:
    explicit WithBits(long bits) : before_(working_bits) { working_bits = bits; }
    ~WithBits() { working_bits = before_; }
    WithBits(const WithBits&) = delete;
    WithBits& operator=(const WithBits&) = delete;

  private:
    long before_;
};

// So many of the working bits as `bits` are of 256.
[[nodiscard]] inline long share_of_bits(long bits) { return working_bits * bits / least_bits; }

// One number. A moved-from Real can only be assigned to or destroyed.
class Real {
  public:
    Real() : Real(0.0) {}
    Real(double x) {  // exact
        mpfr_init2(value_, working_bits);
        mpfr_set_d(value_, x, MPFR_RNDN);
    }
    Real(const Real& other) {  // exact, with the other's bits
        mpfr_init2(value_, mpfr_get_prec(other.value_));
        mpfr_set(value_, other.value_, MPFR_RNDN);
    }
    Real(Real&& other) noexcept {
        value_[0] = other.value_[0];
        other.value_[0]._mpfr_d = nullptr;
    }
    Real& operator=(Real other) noexcept {
        std::swap(value_[0], other.value_[0]);
        return *this;
    }
    ~Real() {
        if (value_[0]._mpfr_d != nullptr) mpfr_clear(value_);
    }

    // MPFR's functions take these two.
    [[nodiscard]] mpfr_ptr raw() { return value_; }
    [[nodiscard]] mpfr_srcptr raw() const { return value_; }

    [[nodiscard]] double to_double(mpfr_rnd_t rounding = MPFR_RNDN) const {
        return mpfr_get_d(value_, rounding);
    }
    [[nodiscard]] bool is_zero() const { return mpfr_zero_p(value_) != 0; }
    [[nodiscard]] bool is_nan() const { return mpfr_nan_p(value_) != 0; }

    friend bool operator==(const Real& a, const Real& b) {
        return mpfr_equal_p(a.value_, b.value_) != 0;
    }
    friend std::partial_ordering operator<=>(const Real& a, const Real& b) {
        if (mpfr_unordered_p(a.value_, b.value_) != 0) return std::partial_ordering::unordered;
        const int sign = mpfr_cmp(a.value_, b.value_);
        return sign < 0   ? std::partial_ordering::less
               : sign > 0 ? std::partial_ordering::greater
                          : std::partial_ordering::equivalent;
    }

  private:
    mpfr_t value_;
};

// The functions of MPFR as functions of values: rounded(mpfr_add, MPFR_RNDD, a, b).
template <class Function, class... Operands>
[[nodiscard]] Real rounded(Function function, mpfr_rnd_t rounding, const Operands&... operands) {
    Real result;
    function(result.raw(), operands.raw()..., rounding);
    return result;
}

// x 2^exponent: exact, MPFR's range of exponents cannot be left by what a test does.
[[nodiscard]] inline Real scaled(const Real& x, long exponent) {
    Real result;
    mpfr_mul_2si(result.raw(), x.raw(), exponent, MPFR_RNDN);
    return result;
}

// About 40 digits, for messages.
[[nodiscard]] inline std::string to_string(const Real& x) {
    char* text = nullptr;
    mpfr_asprintf(&text, "%.40Rg", x.raw());
    const std::string result = text;
    mpfr_free_str(text);
    return result;
}

// A closed interval [lo, hi], lo <= hi, infinite ends allowed. Every operation encloses the set of
// exact results; what cannot be enclosed (division by an interval that holds 0) is all numbers.
struct RealInterval {
    Real lo, hi;

    RealInterval() = default;
    RealInterval(double x) : lo(x), hi(x) {}
    RealInterval(Real x) : lo(x), hi(std::move(x)) {}
    RealInterval(Real low, Real high) : lo(std::move(low)), hi(std::move(high)) {
        if (!(lo <= hi)) {  // NaN: infinity - infinity, 0 infinity
            mpfr_set_inf(lo.raw(), -1);
            mpfr_set_inf(hi.raw(), 1);
        }
    }

    // x 2^exponent
    [[nodiscard]] static RealInterval of(double x, long exponent) {
        return RealInterval(scaled(Real(x), exponent));
    }
    [[nodiscard]] static RealInterval entire() {
        return RealInterval(Real(-__builtin_huge_val()), Real(__builtin_huge_val()));
    }
    [[nodiscard]] bool is_point() const { return lo == hi; }
    [[nodiscard]] Real width() const { return rounded(mpfr_sub, MPFR_RNDU, hi, lo); }
};

[[nodiscard]] inline RealInterval operator-(const RealInterval& x) {
    return {rounded(mpfr_neg, MPFR_RNDD, x.hi), rounded(mpfr_neg, MPFR_RNDU, x.lo)};
}

[[nodiscard]] inline RealInterval operator+(const RealInterval& x, const RealInterval& y) {
    return {rounded(mpfr_add, MPFR_RNDD, x.lo, y.lo), rounded(mpfr_add, MPFR_RNDU, x.hi, y.hi)};
}

[[nodiscard]] inline RealInterval operator-(const RealInterval& x, const RealInterval& y) {
    return {rounded(mpfr_sub, MPFR_RNDD, x.lo, y.hi), rounded(mpfr_sub, MPFR_RNDU, x.hi, y.lo)};
}

// The least and the greatest of the four products of ends; two suffice where no sign is open.
[[nodiscard]] inline RealInterval operator*(const RealInterval& x, const RealInterval& y) {
    if (mpfr_sgn(x.lo.raw()) >= 0 && mpfr_sgn(y.lo.raw()) >= 0) {
        return {rounded(mpfr_mul, MPFR_RNDD, x.lo, y.lo), rounded(mpfr_mul, MPFR_RNDU, x.hi, y.hi)};
    }
    const auto corner = [&](mpfr_rnd_t rounding, auto&& pick) {
        const Real ll = rounded(mpfr_mul, rounding, x.lo, y.lo);
        const Real lh = rounded(mpfr_mul, rounding, x.lo, y.hi);
        const Real hl = rounded(mpfr_mul, rounding, x.hi, y.lo);
        const Real hh = rounded(mpfr_mul, rounding, x.hi, y.hi);
        if (ll.is_nan() || lh.is_nan() || hl.is_nan() || hh.is_nan()) {
            return Real(__builtin_nan(""));
        }
        return rounded(pick, rounding, rounded(pick, rounding, ll, lh),
                       rounded(pick, rounding, hl, hh));
    };
    return {corner(MPFR_RNDD, mpfr_min), corner(MPFR_RNDU, mpfr_max)};
}

[[nodiscard]] inline RealInterval operator/(const RealInterval& x, const RealInterval& y) {
    if (mpfr_sgn(y.lo.raw()) <= 0 && mpfr_sgn(y.hi.raw()) >= 0) return RealInterval::entire();
    const Real one(1.0);
    return x * RealInterval(rounded(mpfr_div, MPFR_RNDD, one, y.hi),
                            rounded(mpfr_div, MPFR_RNDU, one, y.lo));
}

[[nodiscard]] inline RealInterval sqr(const RealInterval& x) {
    const bool lo_is_farther = mpfr_cmpabs(x.lo.raw(), x.hi.raw()) > 0;
    const Real& far = lo_is_farther ? x.lo : x.hi;
    const Real& near = lo_is_farther ? x.hi : x.lo;
    const bool holds_zero = mpfr_sgn(x.lo.raw()) <= 0 && mpfr_sgn(x.hi.raw()) >= 0;
    return {holds_zero ? Real(0.0) : rounded(mpfr_sqr, MPFR_RNDD, near),
            rounded(mpfr_sqr, MPFR_RNDU, far)};
}

// Of the part of x that is not negative; 0 where there is none.
[[nodiscard]] inline RealInterval sqrt(const RealInterval& x) {
    const auto root = [](const Real& end, mpfr_rnd_t rounding) {
        return mpfr_sgn(end.raw()) <= 0 ? Real(0.0) : rounded(mpfr_sqrt, rounding, end);
    };
    return {root(x.lo, MPFR_RNDD), root(x.hi, MPFR_RNDU)};
}

[[nodiscard]] inline RealInterval exp(const RealInterval& x) {
    return {rounded(mpfr_exp, MPFR_RNDD, x.lo), rounded(mpfr_exp, MPFR_RNDU, x.hi)};
}

// The rest is the same for RealInterval and OutwardDouble (outward_double.h), so that along_ray.h
// can be written once.

[[nodiscard]] inline RealInterval from_to(const RealInterval& x, const RealInterval& y) {
    return {x.lo, y.hi};
}

[[nodiscard]] inline RealInterval hull(const RealInterval& x, const RealInterval& y) {
    return {x.lo < y.lo ? x.lo : y.lo, x.hi < y.hi ? y.hi : x.hi};
}

// The common part; x and y are known to share a point.
[[nodiscard]] inline RealInterval common(const RealInterval& x, const RealInterval& y) {
    return {x.lo < y.lo ? y.lo : x.lo, x.hi < y.hi ? x.hi : y.hi};
}

[[nodiscard]] inline bool certainly_positive(const RealInterval& x) {
    return mpfr_sgn(x.lo.raw()) > 0;
}
[[nodiscard]] inline bool certainly_negative(const RealInterval& x) {
    return mpfr_sgn(x.hi.raw()) < 0;
}

}  // namespace ivory::reference
