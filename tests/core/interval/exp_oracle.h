// One argument of exp against MPFR: the enclosure and exp_nearest, in float and double.
#pragma once

#include <mpfr.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "core/interval/exp.h"
#include "tests/core/interval/adversary.h"

namespace ivory::test {

struct ExpFindings {
    std::int64_t checked = 0;
    std::int64_t tightest = 0;  // of two ends each
    std::int64_t faults = 0;
    std::string first_fault;
    // Greatest relative error of exp_nearest in its range, in units of epsilon.
    double worst_nearest = 0;

    ExpFindings& operator+=(const ExpFindings& other) {
        checked += other.checked;
        tightest += other.tightest;
        if (faults == 0) first_fault = other.first_fault;
        faults += other.faults;
        worst_nearest = std::max(worst_nearest, other.worst_nearest);
        return *this;
    }
};

// Not to be shared by threads.
class ExpOracle {
  public:
    ExpOracle() {
        mpfr_init2(argument_, 53);
        mpfr_init2(value_, 110);
        mpfr_init2(reciprocal_, 110);
    }
    ~ExpOracle() {
        mpfr_clear(argument_);
        mpfr_clear(value_);
        mpfr_clear(reciprocal_);
    }
    ExpOracle(const ExpOracle&) = delete;
    ExpOracle& operator=(const ExpOracle&) = delete;

    // x and -x, x finite. e^-x is 1 / e^x to 2^-108, half the work of another exp.
    template <IeeeReal Real>
    void check(Real x, ExpFindings& findings) {
        mpfr_set_d(argument_, static_cast<double>(x), MPFR_RNDN);
        mpfr_exp(value_, argument_, MPFR_RNDD);
        mpfr_set(reciprocal_, value_, MPFR_RNDN);
        if (x != 0) mpfr_nextabove(reciprocal_);
        mpfr_ui_div(reciprocal_, 1, reciprocal_, MPFR_RNDD);
        check(x, value_, findings);
        check(-x, reciprocal_, findings);
    }

  private:
    // value is e^x, rounded downwards. Downwards twice is downwards once, and e^x is no number of
    // Real but for x = 0.
    template <IeeeReal Real>
    static void check(Real x, mpfr_ptr value, ExpFindings& findings) {
        Real down;
        if constexpr (std::same_as<Real, float>) {
            down = mpfr_get_flt(value, MPFR_RNDD);
        } else {
            down = mpfr_get_d(value, MPFR_RNDD);
        }
        const Interval<Real> tightest(down, x == 0 ? down : next_up(down));
        const Interval<Real> bounds = exp(Interval<Real>(x));
        ++findings.checked;
        findings.tightest += (bounds.lo == tightest.lo) + (bounds.hi == tightest.hi);
        if (!encloses_within(bounds, tightest, 1)) {
            report(findings,
                   text(Interval<Real>(x)) + " gives " + text(bounds) + " for " + text(tightest));
        }
        if (x >= ExpConstants<Real>::least && x <= ExpConstants<Real>::greatest) {
            check_nearest(x, value, tightest, findings);
        }
    }

    // The value is taken apart into its leading bits and the rest, so that nothing cancels: the
    // error found is good to a relative 2^-30.
    template <IeeeReal Real>
    static void check_nearest(Real x, mpfr_ptr value, const Interval<Real>& tightest,
                              ExpFindings& findings) {
        const Real nearest = exp_nearest(x);
        mpfr_sub_d(value, value, static_cast<double>(tightest.lo), MPFR_RNDN);
        const double rest = mpfr_get_d(value, MPFR_RNDN);
        const double off = static_cast<double>(nearest) - static_cast<double>(tightest.lo) - rest;
        const double relative = std::abs(off) / static_cast<double>(tightest.lo);
        const double in_epsilon = relative / std::numeric_limits<Real>::epsilon();
        findings.worst_nearest = std::max(findings.worst_nearest, in_epsilon);
        if (!(relative <= exp_relative_error<Real>)) {
            report(findings, "exp_nearest at " + text(Interval<Real>(x)) + " is off by " +
                                 std::to_string(in_epsilon) + " epsilon");
        }
    }

    static void report(ExpFindings& findings, const std::string& fault) {
        if (findings.faults++ == 0) findings.first_fault = fault;
    }

    mpfr_t argument_;
    mpfr_t value_;
    mpfr_t reciprocal_;
};

}  // namespace ivory::test
