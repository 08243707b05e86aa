// What the contract promises of an answer, checked against the reference.
#pragma once

#include <limits>

#include "tests/reference/claim.h"
#include "tests/reference/from_core.h"
#include "tests/reference/reference.h"

namespace ivory::reference {

enum class Fault {
    none,
    malformed,      // not 0 <= t_lo <= t_hi, or one that is infinite; an unresolved t_hi may be
    wrong_hit,      // no root in [t_lo, t_hi], or one before
    wrong_miss,     // there is a root
    wrong_bracket,  // unresolved, and the first root is elsewhere
    too_wide,       // a hit with t_hi - t_lo > max(E w / |d|, 16 ulp(t_hi))
    false_claim,    // claimed_hit where there is no root, claimed_miss where there is one
};

[[nodiscard]] const char* word(Fault fault);

// Of the status and the bracket alone. Without a fault, and not undecided: proved to be right.
struct Ruling {
    Fault fault = Fault::none;
    bool undecided = false;  // the field's bits do not suffice to judge this answer
    ReferenceAnswer reference;
};
[[nodiscard]] Ruling rule(const ReferenceField& field, const Ray& ray, double tolerance,
                          const Claim& claim);

struct Verdict : Ruling {
    static constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

    double normal_error = nothing;  // |n - exact n| at m; NaN where not to be judged
    double color_error = nothing;   // greatest of the three differences at m; likewise
    double root_error = nothing;    // |m - root| |d|, a length, where both know a root
    double bracket = nothing;       // (t_hi - t_lo) |d| / w, w as for the tolerance; or infinity
};

// Normal and colour are judged for whatever has a finite bracket, at m = (t_lo + t_hi) / 2 exactly. The
// normal is not judged where the gradient is near zero or undefined: |grad f| below 1e-4 of the sum
// of |grad F_i|, or below 1e-6 T / w, or within 1e-6 w of where an element that adds to it has a kink. The
// colour is judged where the positive F_i sum to T / 2 or more.
[[nodiscard]] Verdict check(const ReferenceField& field, const Ray& ray, double tolerance,
                            const Claim& claim);
[[nodiscard]] Verdict check(const ReferenceField& field, const Ray& ray, double tolerance,
                            const Answer& answer);  // core's: from_core.cpp

// For the thresholds T (1 +- m), m = 1e-11 max(1, L / w) but at most 1e-3, the reference gives the same outcome, hit or
// miss, and first roots within E w / |d|. L is the largest absolute coordinate of origin - skeleton
// point (the first, or the center) of the element that is nearest, by distance, to the hit, or for a
// ray without one to the ray; w is the width of that element. `known` is first_root(field, ray).
[[nodiscard]] bool decidable(const ReferenceField& field, const Ray& ray, double tolerance,
                             const ReferenceAnswer& known);

}  // namespace ivory::reference
