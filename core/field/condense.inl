// Gaussians into one polynomial (core/field/condensed.h).
#if defined(IVORY_CORE_FIELD_CONDENSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_CONDENSE_INL
#undef IVORY_CORE_FIELD_CONDENSE_INL
#else
#define IVORY_CORE_FIELD_CONDENSE_INL
#endif

#include <algorithm>
#include <cmath>

#include "core/field/condensed.h"
#include "core/field/places.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// Sums over the elements, in units. With s the lower bound of q^2 on the window and k the upper one of exp(-q^2):
//     |F| w^0 <= |b| k;  |F'| w <= 2 |b| k (sqrt s + 0.43), since y exp(-y^2) <= 0.43 for y = q - sqrt s;
//     |F''| w^2 <= |b| k (4 s + 3.5), since 4 y exp(-y) <= 1.48 for y = q^2 - s.
struct SmoothSums {
    double root = 0, root_per_width = 0;    // of |b| sqrt k, and over w
    double peak = 0;                        // of |b| k
    double slope = 0, slope_per_width = 0;  // of |b| k (sqrt s + 0.43)
    double bend = 0;                        // of |b| k (4 s + 3.5)
    // Of what c and x are off by, in widths, times the bounds of |F'| w / 2 and |F''| w.
    double displaced = 0, displaced_slope = 0;
    double most_displaced = 0;  // widths
    double per_narrowest = 0;   // the greatest 1 / w
};

// Where the window lies: c - M = place - from.
struct Box {
    Vec3<float> from;
    Vec3d axis;
    double aside = 0, along = 0;  // |(u, v)| and |w| in the window, at most
    double spread = 0;            // |d - axis|
    double reach = 0;             // |x - M|
    double place_error = 0;

    [[nodiscard]] double radius() const { return std::hypot(aside, along) * (1 + 0x1p-30); }
};

// x is off by 7 u of its size for its own sums, as in entries.inl, and 10 u for the frame's rounding and that of
// its products; c - M by what its place is off by, 4 u |c - M|, the frame's 10 u and 3 u for 1 / w.
HWY_INLINE SmoothSums smooth_sums(const LocalElements& near, std::size_t first, std::size_t end,
                                  const Box& box) {
    const F d;
    const V<F> zero = hn::Zero(d);
    const V<F> common = constant(d, (20 * 0x1p-24 * box.reach + box.place_error) * (1 + 0x1p-20));
    V<F> root = zero, root_per_width = zero, peak = zero, slope = zero, slope_per_width = zero,
         bend = zero, displaced = zero, displaced_slope = zero, most_displaced = zero,
         narrowest = zero;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const M<F> valid = hn::FirstN(d, end - i);
        const auto column = [&](const std::vector<float>& values) HWY_ATTR {
            return hn::IfThenElseZero(valid, hn::LoadU(d, &values[i]));
        };
        const V<F> inverse = hn::Sqrt(column(near.inverse_square)),
                   strength = hn::Abs(column(near.strength)), least = column(near.least),
                   most = column(near.peak);
        const Vec3v<F> c{hn::Sub(column(near.x), hn::Set(d, box.from.x)),
                         hn::Sub(column(near.y), hn::Set(d, box.from.y)),
                         hn::Sub(column(near.z), hn::Set(d, box.from.z))};
        const V<F> off =
            hn::Mul(hn::MulAdd(length_of(d, c), constant(d, 20 * 0x1.01p-24), common), inverse);
        const V<F> of_root = hn::Mul(strength, hn::Sqrt(most)), of_peak = hn::Mul(strength, most);
        const V<F> of_slope = hn::Mul(of_peak, hn::Add(hn::Sqrt(least), constant(d, 0.43)));
        const V<F> of_bend = hn::Mul(of_peak, hn::MulAdd(constant(d, 4), least, constant(d, 3.5)));
        root = hn::Add(root, of_root);
        root_per_width = hn::MulAdd(of_root, inverse, root_per_width);
        peak = hn::Add(peak, of_peak);
        slope = hn::Add(slope, of_slope);
        slope_per_width = hn::MulAdd(of_slope, inverse, slope_per_width);
        bend = hn::Add(bend, of_bend);
        displaced = hn::MulAdd(of_slope, off, displaced);
        displaced_slope = hn::MulAdd(hn::Mul(of_bend, inverse), off, displaced_slope);
        narrowest = hn::Max(narrowest, inverse);
        most_displaced = hn::Max(most_displaced, hn::IfThenElseZero(valid, off));
    }
    const double sums = 1 + static_cast<double>(end - first + 64) * 0x1p-22;
    return {sum_of(root) * sums,
            sum_of(root_per_width) * sums,
            sum_of(peak) * sums,
            sum_of(slope) * sums,
            sum_of(slope_per_width) * sums,
            sum_of(bend) * sums,
            sum_of(displaced) * sums,
            sum_of(displaced_slope) * sums,
            double{hn::GetLane(hn::MaxOfLanes(d, most_displaced))},
            double{hn::GetLane(hn::MaxOfLanes(d, narrowest))} * (1 + 0x1p-20)};
}

// The Taylor coefficients of some vectors of elements along one axis: g_k / w^k of condensed.h.
constexpr std::size_t condensed_block = 4;
struct AlongAxis {
    V<F> g[Condensed::greatest_degree + 1][condensed_block];
};

HWY_INLINE void expand(std::size_t degree, const V<F> (&x)[condensed_block],
                       const V<F> (&inverse)[condensed_block], AlongAxis& axis) {
    const F d;
    for (std::size_t b = 0; b < condensed_block; ++b) {
        const V<F> twice = hn::Mul(hn::Add(x[b], x[b]), inverse[b]);
        const V<F> twice_square = hn::Mul(hn::Add(inverse[b], inverse[b]), inverse[b]);
        V<F> before = hn::Zero(d), here = hn::Set(d, 1.0F);
        axis.g[0][b] = here;
        for (std::size_t k = 0; k < degree; ++k) {
            const V<F> next = hn::Mul(hn::MulSub(twice, here, hn::Mul(twice_square, before)),
                                      constant(d, 1 / static_cast<double>(k + 1)));
            before = here;
            here = next;
            axis.g[k + 1][b] = here;
        }
    }
}

// The polynomial's coefficients; in how many roundings a summand takes part.
HWY_NOINLINE std::size_t sum_up(const LocalElements& near, std::size_t first, std::size_t end,
                                const Box& box, Condensed& condensed) {
    const F d;
    const std::size_t N = hn::Lanes(d), degree = condensed.degree;
    const std::size_t count = (degree + 1) * (degree + 2) * (degree + 3) / 6;
    constexpr std::size_t blocks_at_once = 4;
    alignas(64) float sums[Condensed::room * (HWY_MAX_BYTES / sizeof(float))];
    std::array<double, Condensed::room> total{};
    std::fill_n(sums, count * N, 0.0F);
    const auto add_to_total = [&]() HWY_ATTR {
        for (std::size_t k = 0; k < count; ++k) {
            total[k] += double{hn::GetLane(hn::SumOfLanes(d, hn::Load(d, sums + k * N)))};
            hn::Store(hn::Zero(d), d, sums + k * N);
        }
    };
    const auto& frame = condensed.frame;
    std::size_t blocks = 0;
    for (std::size_t i = first; i < end; i += condensed_block * N, ++blocks) {
        V<F> inverse[condensed_block], x[3][condensed_block], weight[condensed_block];
        for (std::size_t b = 0; b < condensed_block; ++b) {
            const std::size_t at = std::min(i + b * N, end - 1);  // beyond the end: counted as 0
            const std::size_t left = end - std::min(i + b * N, end);
            inverse[b] = hn::Sqrt(hn::LoadU(d, &near.inverse_square[at]));
            const V<F> cx = hn::Sub(hn::LoadU(d, &near.x[at]), hn::Set(d, box.from.x)),
                       cy = hn::Sub(hn::LoadU(d, &near.y[at]), hn::Set(d, box.from.y)),
                       cz = hn::Sub(hn::LoadU(d, &near.z[at]), hn::Set(d, box.from.z));
            V<F> square = hn::Zero(d);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const Vec3<float>& to = frame[axis];
                const V<F> along =
                    hn::MulAdd(cx, hn::Set(d, to.x),
                               hn::MulAdd(cy, hn::Set(d, to.y), hn::Mul(cz, hn::Set(d, to.z))));
                x[axis][b] = hn::Mul(along, inverse[b]);
                square = hn::MulAdd(x[axis][b], x[axis][b], square);
            }
            const V<F> peak = exp2_minus(d, hn::Mul(square, constant(d, 0x1.71547652b82fep+0)));
            weight[b] = hn::IfThenElseZero(hn::FirstN(d, left),
                                           hn::Mul(hn::LoadU(d, &near.strength[at]), peak));
            // What stands beyond the last element may be no number.
            for (std::size_t axis = 0; axis < 3; ++axis) {
                x[axis][b] = hn::IfThenElseZero(hn::FirstN(d, left), x[axis][b]);
            }
            inverse[b] = hn::IfThenElseZero(hn::FirstN(d, left), inverse[b]);
        }
        AlongAxis u, v, w;
        expand(degree, x[0], inverse, u);
        expand(degree, x[1], inverse, v);
        expand(degree, x[2], inverse, w);
        float* sum = sums;
        for (std::size_t j = 0; j <= degree; ++j) {
            V<F> first_two[condensed_block], of_next[condensed_block];
            for (V<F>& factor : of_next) factor = hn::Zero(d);
            for (std::size_t b = 0; b < condensed_block; ++b)
                u.g[j][b] = hn::Mul(u.g[j][b], weight[b]);
            // Two rows at a time, so that what stands along w is loaded once for both.
            for (std::size_t k = 0; k + j <= degree; k += 2) {
                const std::size_t row = degree - j - k + 1;
                float* const next_row = sum + row * N;
                const bool has_next = k + 1 + j <= degree;
                for (std::size_t b = 0; b < condensed_block; ++b) {
                    first_two[b] = hn::Mul(u.g[j][b], v.g[k][b]);
                    if (has_next) of_next[b] = hn::Mul(u.g[j][b], v.g[k + 1][b]);
                }
                const std::size_t in_both = has_next ? row - 1 : 0;
                for (std::size_t l = 0; l < in_both; ++l) {
                    V<F> here = hn::Load(d, sum + l * N), next = hn::Load(d, next_row + l * N);
                    for (std::size_t b = 0; b < condensed_block; ++b) {
                        const V<F> along = w.g[l][b];
                        here = hn::MulAdd(first_two[b], along, here);
                        next = hn::MulAdd(of_next[b], along, next);
                    }
                    hn::Store(here, d, sum + l * N);
                    hn::Store(next, d, next_row + l * N);
                }
                for (std::size_t l = in_both; l < row; ++l) {
                    V<F> here = hn::Load(d, sum + l * N);
                    for (std::size_t b = 0; b < condensed_block; ++b) {
                        here = hn::MulAdd(first_two[b], w.g[l][b], here);
                    }
                    hn::Store(here, d, sum + l * N);
                }
                sum = next_row + in_both * N;
            }
        }
        if ((blocks + 1) % blocks_at_once == 0) add_to_total();
    }
    add_to_total();
    for (std::size_t k = 0; k < count; ++k) {
        condensed.coefficient[k] = static_cast<float>(total[k]);
    }
    return blocks_at_once * condensed_block + 4;  // the lanes' sum
}

// Sums of |coefficient| a^(i+j) b^k over all terms, a and b how far the window goes, and of that times powers
// of k and of i + j.
struct TermSums {
    double all = 0, k = 0, ij = 0, kk = 0, kij = 0, ijij = 0;  // kk: of k (k - 1), ijij likewise
};

HWY_INLINE TermSums term_sums(const Condensed& condensed, const Box& box) {
    const std::size_t degree = condensed.degree;
    double aside[Condensed::greatest_degree + 1], along[Condensed::greatest_degree + 1];
    aside[0] = along[0] = 1;
    for (std::size_t k = 1; k <= degree; ++k) {
        aside[k] = aside[k - 1] * box.aside;
        along[k] = along[k - 1] * box.along;
    }
    // Of each i + j and k first.
    double by[Condensed::greatest_degree + 1][Condensed::greatest_degree + 1] = {};
    const float* c = condensed.coefficient.data();
    for (std::size_t i = 0; i <= degree; ++i) {
        for (std::size_t j = 0; i + j <= degree; ++j) {
            for (std::size_t k = 0; i + j + k <= degree; ++k)
                by[i + j][k] += std::fabs(double{*c++});
        }
    }
    TermSums sums;
    for (std::size_t m = 0; m <= degree; ++m) {
        for (std::size_t k = 0; m + k <= degree; ++k) {
            const double term = by[m][k] * aside[m] * along[k];
            const auto of_m = static_cast<double>(m), of_k = static_cast<double>(k);
            sums.all += term;
            sums.k += of_k * term;
            sums.ij += of_m * term;
            sums.kk += of_k * (of_k - 1) * term;
            sums.kij += of_k * of_m * term;
            sums.ijij += of_m * (of_m - 1) * term;
        }
    }
    return sums;
}

// Two directions across a third, orthonormal but for 2^-50.
HWY_INLINE void frame_about(const Vec3d& axis, std::array<Vec3<float>, 3>& frame) {
    const double x = std::abs(axis.x), y = std::abs(axis.y), z = std::abs(axis.z);
    const Vec3d least = x <= y && x <= z ? Vec3d{1, 0, 0}
                        : y <= z         ? Vec3d{0, 1, 0}
                                         : Vec3d{0, 0, 1};
    const Vec3d across = cross(axis, least);
    const Vec3d u = (1 / std::sqrt(dot(across, across))) * across;
    const Vec3d v = cross(axis, u);
    const auto narrow = [](const Vec3d& d) {
        return Vec3<float>{static_cast<float>(d.x), static_cast<float>(d.y),
                           static_cast<float>(d.z)};
    };
    frame = {narrow(u), narrow(v), narrow(axis)};
}

// `middle` is the window's, relative to the elements' place, as in enter_from_local.
Condensing condense(const LocalElements& near, const LocalStretch& stretch, double middle,
                    double threshold, bool may_part, Closeness closeness, Condensed& condensed) {
    static constexpr double cramer = 1.0865 * 1.02, u = 0x1p-24;
    // What the remainder may be, of T: little beside what far elements are left out for in a walk.
    static constexpr double remainder_share = 0x1p-17, rough_share = 0x1p-6;
    constexpr std::size_t least_degree = 3;
    const auto [first, end] = near.first.of(group_of(Shape::point, KernelKind::blinn));

    Box box;
    const auto place = [&](double base, double axis) {
        return static_cast<float>(base + middle * axis);
    };
    box.from = {place(stretch.base.x, stretch.axis.x), place(stretch.base.y, stretch.axis.y),
                place(stretch.base.z, stretch.axis.z)};
    box.axis = stretch.axis;
    const double size = std::sqrt(double{box.from.x} * double{box.from.x} +
                                  double{box.from.y} * double{box.from.y} +
                                  double{box.from.z} * double{box.from.z});
    const double last = (stretch.t_offset + stretch.end) * more;
    const double half = 0.5 * (stretch.end - stretch.begin);
    // A ray's point at t is origin + t axis + (o - origin) + t (d - axis), of which |(o - origin) . axis| is at
    // most spread radius, |(d - axis) . axis| = |d - axis|^2 / 2 but for 2^-49.
    constexpr double roomy = 1 + 0x1p-10;
    const double aside = stretch.radius + last * stretch.spread;
    box.reach = half * roomy + aside * roomy;
    box.along = (half + stretch.spread * aside) * roomy + 0x1p-20 * box.reach;
    box.aside = std::max(aside * roomy, 0x1p-10 * box.reach);
    box.spread = stretch.spread;
    box.place_error = 0x1p-23 * double{near.magnitude} + 0x1.1p-23 * size + last * 0x1p-50;

    const SmoothSums sums = smooth_sums(near, first, end, box);
    constexpr double root2 = 1.4142135623730951 * (1 + 0x1p-50);
    const double rho = box.radius(), r = root2 * rho * sums.per_narrowest;
    // Not so: not a number either.
    if (!(sums.root < 1e30 && sums.per_narrowest < 1e12 && sums.most_displaced < 1e-3 &&
          rho > 1e-12)) {
        return Condensing::unfit;
    }
    const double limit = remainder_share * threshold;
    const auto remainder = [&](double of_r, std::size_t degree) {
        double power = of_r, factorial = 1;
        for (std::size_t k = 2; k <= degree + 1; ++k) {
            power *= of_r;
            factorial *= static_cast<double>(k);
        }
        return cramer * sums.root * power / std::sqrt(factorial) * (1 + 0x1p-40);
    };
    if (r > Condensed::widest || remainder(r, Condensed::greatest_degree) > limit) {
        const double of_rays = root2 * box.aside * sums.per_narrowest * 1.25;
        return may_part || (of_rays < Condensed::widest &&
                            remainder(of_rays, Condensed::greatest_degree) < limit)
                   ? Condensing::too_large
                   : Condensing::unfit;
    }
    std::size_t degree = least_degree;
    const double wanted = closeness == Closeness::close ? limit : rough_share * threshold;
    while (degree < Condensed::greatest_degree && remainder(r, degree) > wanted) ++degree;
    condensed.degree = degree;
    condensed.elements = end - first;
    frame_about(box.axis, condensed.frame);
    const double summands = static_cast<double>(sum_up(near, first, end, box, condensed));
    const TermSums terms = term_sums(condensed, box);

    // The bounds of condensed.h; 1.02, as in `cramer`, for what is displaced being nearer than the peak says.
    const auto n = static_cast<double>(degree);
    const double R = remainder(r, degree);
    // Terms of degree m are off by 6 m u and by what is common to all; the sum of m times the majorant's terms is
    // at most |a| times that of its derivatives.
    const double common = u * (28 + summands), grown = std::exp(r * r) * 1.02;
    const double A = r / root2, sharp = sums.per_narrowest;
    const double derived = 2 * (sums.slope + 2 * A * sums.peak),
                 derived_per_width = 2 * (sums.slope_per_width + 2 * A * sums.peak * sharp);
    // The exponent |X|^2 at the middle is off by 5 u of it, with |X|^2 <= (q + A)^2 <= 2 (q^2 + A^2); times what
    // derivatives add, (q + A)^2 2 (q + 2 A) exp(-q^2 / 2) < 13 and (q + A)^2 (4 (q + 2 A)^2 + 2) exp(-q^2 / 2) < 90,
    // A <= 0.89.
    const double exponent = 5 * u * grown;
    const double off = grown * (common * sums.peak + 6 * u * A * derived) +
                       exponent * 2 * (0.25 * sums.bend + A * A * sums.peak) +
                       1.02 * (2 * sums.displaced + u * sums.bend) + R + 1e-30;
    // And of m times its derivatives: 2 (q + 2 A) (y + 1) + 2 A, y = 2 A (q + 2 A), times it, and
    // (q + 2 A)^2 <= 2 (q^2 + 4 A^2).
    const double weighted =
        derived_per_width +
        (8 * A * (0.25 * sums.bend + 4 * A * A * sums.peak) + 2 * A * sums.peak) * sharp;
    const double slope_off = grown * (common * derived_per_width + 6 * u * weighted) +
                             13 * exponent * sums.root_per_width +
                             1.02 * (sums.displaced_slope + 30 * u * sums.root_per_width) +
                             R * (n + 1) / rho + 1e-30;
    // By Cramer's bound; (2 q + 4 A)^2 exp(-q^2 / 2) + 2 < 24.
    const double bend_off =
        (24 * grown * (common + 6 * u * n) + 90 * exponent + 7.6 * sums.most_displaced + 40 * u) *
            sums.root_per_width * sharp * 1.02 +
        R * (n + 1) * n / (rho * rho) + 1e-30;
    // Evaluated by Horner's scheme, each term is multiplied and added to at most n + 3 times, and of the slope
    // multiplied once more by a component and added to twice.
    const double per_aside = 1 / box.aside, per_along = 1 / box.along, s = box.spread;
    condensed.error = (off + (2 * n + 14) * u * (terms.all + threshold)) * 1.01;
    condensed.slope_error =
        (slope_off + (2 * n + 16) * u * (terms.k * per_along + s * terms.ij * per_aside)) * 1.01;
    condensed.gradient_error =
        1.8 * (slope_off + (2 * n + 16) * u * (terms.k * per_along + terms.ij * per_aside));
    const double middle_value = condensed.coefficient[0];
    condensed.most = middle_value + ((terms.all - std::abs(middle_value)) + off) * (1 + 0x1p-30);
    // d^2 P = d_w^2 P_ww + 2 d_w (d_u P_uw + d_v P_vw) + ...; 0.99 < d_w < 1 + 2^-48.
    const double ww = 2 * double{condensed.coefficient[2]};
    const double others = (terms.kk * per_along * per_along - std::abs(ww) +
                           2 * s * terms.kij * per_along * per_aside +
                           s * s * terms.ijij * per_aside * per_aside + std::abs(ww) * s * s) *
                              (1 + 0x1p-20) +
                          bend_off;
    condensed.rise = std::max(ww, 0.0) + others;
    condensed.fall = std::max(-ww, 0.0) + others;
    const double all = condensed.error + condensed.slope_error + condensed.rise + condensed.fall;
    return all < 1e30 ? Condensing::condensed : Condensing::unfit;
}

// The sums of (1) and (2) of condensed.h for one variable. What is given as roundings of everything, beside 6 k for
// the k-th term and one for each summand, is for the exponent, 8 u |X|^2, and for the foot, 5 u |c - M|:
// with A < 1.42, (q + A)^2 exp(-q^2 / 2) < 3.6 and (q + A) 2 q exp(-q^2 / 2) < 4 they make less than 50 u |b| sqrt k.
bool condense_ray(const Field& field, const LocalElements& near, const Vec3d& origin,
                  const Vec3d& direction, double begin, double end, double scale, double threshold,
                  CondensedRay& condensed) {
    static constexpr double cramer = 1.0865, u = 0x1p-53, greatest_remainder = 0x1p-38;
    const D d;
    const I di;
    const hn::Rebind<float, D> narrow;
    const hn::Rebind<std::int32_t, D> narrow_index;
    const auto [first, last] = near.first.of(group_of(Shape::point, KernelKind::blinn));
    const double middle = 0.5 * (begin + end);
    const double half = (0.5 * (end - begin) + 0x1p-50 * end) * (1 + 0x1p-20);

    V<D> roots = hn::Zero(d), narrowest = hn::Zero(d);
    const auto index_at = [&](std::size_t i) HWY_ATTR {
        return hn::PromoteTo(di, hn::LoadU(narrow_index, &near.element[i]));
    };
    // What stands beyond the last element may be of another field.
    constexpr std::size_t N_at_most = hn::MaxLanes(D());
    std::int32_t last_ones[N_at_most] = {};
    const auto elements_at = [&](std::size_t i) HWY_ATTR {
        if (i + hn::Lanes(d) <= last) return index_at(i);
        std::fill_n(last_ones, N_at_most, near.element[i]);
        std::copy_n(&near.element[i], last - i, last_ones);
        return hn::PromoteTo(di, hn::LoadU(narrow_index, last_ones));
    };
    for (std::size_t i = first; i < last; i += hn::Lanes(d)) {
        const M<D> valid = hn::FirstN(d, last - i);
        const hn::Vec<I> index = elements_at(i);
        const V<D> peak = hn::PromoteTo(d, hn::LoadU(narrow, &near.peak[i]));
        const V<D> strength =
            hn::Mul(hn::Abs(hn::GatherIndex(d, field.strength.data(), index)), constant(scale));
        roots = hn::Add(roots, hn::IfThenElseZero(valid, hn::Mul(strength, hn::Sqrt(peak))));
        narrowest = hn::Max(narrowest, hn::GatherIndex(d, field.inverse_width.data(), index));
    }
    const double root = sum_of(roots) * (1 + 0x1p-30),
                 sharp = hn::GetLane(hn::MaxOfLanes(d, narrowest)) * (1 + 0x1p-40);
    const double r = 1.4142135623730952 * half * sharp * (1 + 0x1p-40);
    if (!(root < 1e100 && r < 2 && half > 1e-100)) return false;
    std::size_t degree = 1;
    double remainder = cramer * root * (1 + 0x1p-30) * r * r / std::sqrt(2.0);
    while (remainder > greatest_remainder * threshold && degree < CondensedRay::greatest_degree) {
        ++degree;
        remainder *= r / std::sqrt(static_cast<double>(degree + 1));
    }
    if (remainder > greatest_remainder * threshold) return false;

    condensed.degree = degree;
    alignas(64) double sums[(CondensedRay::greatest_degree + 1) * N_at_most] = {};
    for (std::size_t i = first; i < last; i += hn::Lanes(d)) {
        const M<D> valid = hn::FirstN(d, last - i);
        const hn::Vec<I> index = elements_at(i);
        const auto from = [&](double o, const std::vector<double>& c, double along) HWY_ATTR {
            return offset_lanes(o, hn::GatherIndex(d, c.data(), index), middle, along);
        };
        const Vec3v<D> away{from(origin.x, field.ax, direction.x),
                            from(origin.y, field.ay, direction.y),
                            from(origin.z, field.az, direction.z)};
        const V<D> inverse = hn::GatherIndex(d, field.inverse_width.data(), index);
        const V<D> square = hn::Mul(dot<D>(away, away), hn::Mul(inverse, inverse));
        const V<D> back = hn::MulAdd(
            away.x, constant(direction.x),
            hn::MulAdd(away.y, constant(direction.y), hn::Mul(away.z, constant(direction.z))));
        const V<D> twice = hn::Mul(hn::Mul(constant(-2), back), hn::Mul(inverse, inverse));
        const V<D> twice_square = hn::Mul(hn::Add(inverse, inverse), inverse);
        const V<D> strength =
            hn::Mul(hn::GatherIndex(d, field.strength.data(), index), constant(scale));
        V<D> before = hn::Zero(d);
        V<D> here = hn::IfThenElseZero(
            valid,
            hn::Mul(strength, exp2_minus(d, hn::Mul(square, constant(0x1.71547652b82fep+0)))));
        for (std::size_t k = 0; k <= degree; ++k) {
            double* const sum = sums + k * hn::Lanes(d);
            hn::Store(hn::Add(hn::Load(d, sum), here), d, sum);
            const V<D> next = hn::Mul(hn::MulSub(twice, here, hn::Mul(twice_square, before)),
                                      constant(1 / static_cast<double>(k + 1)));
            before = here;
            here = next;
        }
    }
    double power = 1, whole = 0, bends = 0;
    for (std::size_t k = 0; k <= degree; ++k) {
        const double c = sum_of(hn::Load(d, sums + k * hn::Lanes(d)));
        condensed.coefficient[k] = c;
        whole += std::abs(c) * power;
        if (k > 2) bends += static_cast<double>(k * (k - 1)) * std::abs(c) * power;
        power *= half;
    }
    const auto n = static_cast<double>(degree);
    const double summands = static_cast<double>((last - first) / hn::Lanes(d)) + 10;
    const double roundings = u * (8 * n + 96 + summands) * std::exp(r * r) * 1.02;
    const double off = roundings * (root + whole) + threshold * (4 * u) + 1e-280;
    // Of derivatives the terms are n / half and n^2 / half^2 times as large at most; those of condensed.h less.
    const double per_length = std::max((4 * r + 2) * sharp, n / half);
    condensed.error = (off + remainder) * (1 + 0x1p-20);
    condensed.slope_error = (off * per_length + remainder * (n + 1) / half) * (1 + 0x1p-20);
    const double others = (bends / (half * half) + off * per_length * per_length +
                           remainder * (n + 1) * n / (half * half)) *
                          (1 + 0x1p-20);
    const double bend = degree > 1 ? 2 * condensed.coefficient[2] : 0;
    condensed.rise = std::max(bend, 0.0) + others;
    condensed.fall = std::max(-bend, 0.0) + others;
    return condensed.error + condensed.slope_error + condensed.rise + condensed.fall < 1e100;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
